//! The cameras' views: a tile for each, with its picture and all that is drawn over it.
//!
//! | file | holds |
//! |---|---|
//! | `preferences` | `CameraViewPreferences`: what all views share, kept from start to start |
//! | `tile_view` | [`TileView`]: which view mode or modes a tile shows, and which part of the picture |
//! | `update` | commands, and what the user did in a tile |
//! | `pane` | what a tile is given of the document and the session |
//! | `alone` | the picture without header and gutter, for exports |
//! | `linked` | how linked views go along with a zoom or pan |
//! | `tile` | a tile: header, picture, gutter |
//! | `event` | [`TileEvent`]: what the user did in a tile |
//! | `pointer` | press, travel, modifiers, Esc: the pointer's way to those events |
//! | `header`, `tile_menu` | badge, name, view mode, link, expand, more |
//! | `full_pictures` | footage at its full size, where it is worked on at a part of it |
//! | `picture_view` | texture, outline, limbs, joints, sight ray |
//! | `comparison` | wipe and blink between two modes |
//! | `held` | what held limbs that silhouettes did not |
//! | `keypoints` | where another tool saw joints |
//! | `observed` | a body that sways, ellipses of joints |
//! | `ghosts` | bodies in the place of the posed one |
//! | `gutter` | overlap, use in the fit, what a drag does |
//! | `legend`, `legend_block` | the strip under the picture; how to read one mode in it |
//! | `hover_card` | the numbers of the pixel under the pointer |

mod alone;
mod comparison;
pub(crate) mod event;
mod full_pictures;
mod ghosts;
mod gutter;
mod header;
pub(crate) mod held;
mod hover_card;
mod keypoints;
mod legend;
mod legend_block;
mod linked;
pub(crate) mod observed;
mod pane;
mod picture_view;
mod pointer;
pub(crate) mod preferences;
#[cfg(test)]
mod tests;
pub(crate) mod tile;
mod tile_menu;
pub(crate) mod tile_view;
mod update;

use std::collections::BTreeMap;

pub use event::TileEvent;
pub use observed::ObservedMarks;
pub(crate) use pane::Place;
pub(crate) use preferences::CameraViewPreferences;
pub use tile::{CameraTileInput, TileResponse, camera_tile};
pub use tile_view::TileView;

use backlit_tracking::body::Model;
use backlit_ui::drawing::{Comparison, ViewMode};
use backlit_ui::widgets::{Framing, ViewTransform};

use crate::context::picture_alone::PictureAlone;
use crate::context::preferences::Layout;
use crate::session::prediction::Derivatives;
use crate::session::selection::Selection;

/// The feature.
#[derive(Debug, Clone, Default)]
pub(crate) struct CameraViews {
    /// What all views share, kept from start to start.
    pub(crate) preferences: CameraViewPreferences,
    tiles: Tiles,
    full: full_pictures::FullPictures,
    /// How each camera's picture lay on the screen when it was last shown.
    shown: BTreeMap<usize, ViewTransform>,
    /// One camera's picture and nothing else, for an export.
    picture_alone: Option<PictureAlone>,
    /// Height of the legend under that picture in the last frame of the window.
    legend_height: f32,
}

/// What the tiles show: by layout, then by camera.
#[derive(Debug, Clone, Default)]
struct Tiles {
    pose: Vec<TileView>,
    debug: Vec<TileView>,
}

impl Tiles {
    /// The debug layout begins with the residual, and the report's overlay wiped against the footage, by turns.
    fn new(cameras: usize) -> Self {
        let residual = TileView { mode: ViewMode::Residual, ..TileView::default() };
        let report = TileView {
            mode: ViewMode::ReportOverlay,
            other: ViewMode::Footage,
            comparison: Some(Comparison::Wipe),
            wipe_at: 0.6,
            ..TileView::default()
        };
        let debug = (0..cameras).map(|camera| if camera % 2 == 0 { residual } else { report }).collect();
        Self { pose: vec![TileView::default(); cameras], debug }
    }

    fn of(&self, layout: Layout) -> &[TileView] {
        match layout {
            Layout::Debug => &self.debug,
            Layout::Pose | Layout::Demonstrate => &self.pose,
        }
    }

    fn of_mut(&mut self, layout: Layout) -> &mut [TileView] {
        match layout {
            Layout::Debug => &mut self.debug,
            Layout::Pose | Layout::Demonstrate => &mut self.pose,
        }
    }
}

impl CameraViews {
    /// What the tiles of a layout show, by camera.
    pub(crate) fn tiles(&self, layout: Layout) -> &[TileView] {
        self.tiles.of(layout)
    }

    /// Shows a mode alone in all views of a layout.
    pub(crate) fn show_mode(&mut self, layout: Layout, mode: ViewMode) {
        for tile in self.tiles.of_mut(layout) {
            (tile.mode, tile.comparison) = (mode, None);
        }
    }

    /// Shows one camera's picture and nothing else, as it is framed or whole.
    pub(crate) fn show_alone(&mut self, picture: PictureAlone, layout: Layout, is_whole: bool) {
        self.picture_alone = Some(picture);
        if is_whole && let Some(tile) = self.tiles.of_mut(layout).get_mut(picture.camera) {
            tile.framing = Framing::Whole;
        }
    }

    /// Whether one camera's picture is all that is shown.
    pub(crate) fn is_picture_alone(&self) -> bool {
        self.picture_alone.is_some()
    }

    /// Height of the legend under a picture that is shown alone.
    pub(crate) fn legend_height(&self) -> f32 {
        self.legend_height
    }

    /// Which derivatives the tiles show. The Jacobian's column is that of the selected limb's chosen axis.
    pub(crate) fn derivatives(&self, layout: Layout, model: &Model, selection: &Selection) -> Derivatives {
        let tiles = self.tiles(layout);
        let shows = |mode| tiles.iter().any(|tile| tile.shows(mode));
        let rotation = model.limbs()[selection.limb(model)].rotation;
        Derivatives {
            gradient: shows(ViewMode::Gradient),
            column: shows(ViewMode::JacobianColumn).then(|| self.preferences.settings.axis.column(rotation)),
        }
    }
}
