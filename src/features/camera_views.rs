//! The cameras' views: a tile for each, with its picture and all that is drawn over it.

use std::collections::BTreeMap;

use backlit_document::history::Gesture;
use backlit_tracking::body::Model;
use backlit_ui::drawing::{DragEvent, JointId, ModeComparison, ViewMode, ViewedPicture};
use backlit_ui::widgets::{Framing, ViewTransform};
pub use overlays::Ellipses;
pub(crate) use pane::TilePlace;
pub use tile::{BodyMarks, SteeredSilhouette, TileInput, TileResponse, camera_tile};

use crate::context::Context;
use crate::context::marks::PictureAlone;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::view_settings::ViewSettings;
use crate::session::prediction::Derivatives;
use crate::session::selection::Selection;

mod comparison;
mod full_pictures;
mod gutter;
mod hand;
mod header;
mod hover_card;
mod legend;
mod legend_block;
mod overlays;
mod pane;
mod picture_view;
mod pointer;
#[cfg(test)]
mod tests;
pub(crate) mod tile;
mod update;

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
            comparison: Some(ModeComparison::Wipe),
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

    /// What the views show, by camera: a prediction makes these pictures beside it.
    pub(crate) fn pictures(&self, context: &Context<'_>) -> Vec<Vec<ViewedPicture>> {
        let (layout, frame) = (context.preferences.layout, context.selection.frame);
        let of_tile = |(camera, tile): (usize, &TileView)| {
            let has_full = self.full.of(camera, frame).is_some();
            let view = |mode: ViewMode| {
                let is_over_footage = has_full && matches!(mode, ViewMode::Footage | ViewMode::Tinted);
                ViewedPicture { mode, is_over_footage }
            };
            let other = tile.comparison.map(|_| tile.other);
            [Some(tile.mode), other].into_iter().flatten().map(view).collect()
        };
        let cameras = context.session.camera_count();
        self.tiles(layout).iter().take(cameras).enumerate().map(of_tile).collect()
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

/// What is chosen for all views.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct CameraViewPreferences {
    /// Whether zoom and pan go together in all views.
    pub(crate) linked_zoom: bool,
    /// What is drawn in them, and what is dragged.
    pub(crate) settings: ViewSettings,
}

/// What a tile shows and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileView {
    /// What the picture shows.
    pub mode: ViewMode,
    /// What it is compared with.
    pub other: ViewMode,
    /// How the two are compared; `None` shows [`mode`](Self::mode) alone.
    pub comparison: Option<ModeComparison>,
    /// Where the wipe's handle is: 0 at the left edge of the picture, 1 at the right.
    pub wipe_at: f32,
    /// Which part of the picture.
    pub framing: Framing,
}

impl Default for TileView {
    fn default() -> Self {
        Self {
            mode: ViewMode::Tinted,
            other: ViewMode::Footage,
            comparison: None,
            wipe_at: 0.5,
            framing: Framing::default(),
        }
    }
}

impl TileView {
    /// Whether a mode is seen, alone or in a comparison.
    pub(crate) fn shows(&self, mode: ViewMode) -> bool {
        self.mode == mode || (self.comparison.is_some() && self.other == mode)
    }

    /// Shows a mode. In a comparison the modes trade places rather than be the same.
    pub(crate) fn set_mode(&mut self, mode: ViewMode) {
        if self.comparison.is_some() && mode == self.other {
            self.other = self.mode;
        }
        self.mode = mode;
    }

    /// Compares with a mode, in the way of now or else by a wipe.
    pub(crate) fn compare_with(&mut self, other: ViewMode) {
        if other == self.mode {
            self.mode = self.other;
        }
        self.other = other;
        self.comparison = self.comparison.or(Some(ModeComparison::Wipe));
        self.keep_apart();
    }

    /// Begins or ends a comparison.
    pub(crate) fn toggle(&mut self, comparison: ModeComparison) {
        self.comparison = (self.comparison != Some(comparison)).then_some(comparison);
        self.keep_apart();
    }

    /// Two modes that are the same compare nothing.
    fn keep_apart(&mut self) {
        if self.other == self.mode {
            self.other = if self.mode == ViewMode::Footage { ViewMode::Tinted } else { ViewMode::Footage };
        }
    }
}

/// What the user did in a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TileEvent {
    /// Pressed somewhere: the tile becomes the active one.
    Activate,
    /// Pressed a joint.
    SelectJoint(JointId),
    /// Pressed a limb's body.
    SelectLimb(usize),
    /// Dragged what was pressed.
    Drag(DragEvent),
    /// Chose what the picture shows: a mode, a comparison, where its wipe is. How it is framed stays.
    SetView(TileView),
    /// Changed what all views share.
    SetSettings(ViewSettings),
    /// Ticked or unticked the camera's use in the fit.
    SetUsed(bool),
    /// Set the camera's weight in the fit, with the gesture of the slider.
    SetWeight(f64, Option<Gesture>),
    /// Took a pose that rivals the one on the screen, counted from the likeliest.
    TakeRival(usize),
    /// Clicked one of the people to choose from, counted from 0.
    FollowPerson(usize),
    /// Linked or unlinked zoom and pan. Linked tiles share one [`Framing`].
    SetLinked(bool),
    /// Zoomed, panned or fitted.
    SetFraming(Framing),
    /// Asked for the tile in the whole window, or back.
    ToggleExpanded,
    /// Drags the tile away by its header.
    DragTile,
    /// Asked for a pane that stands behind this one.
    Switch(Pane),
    /// Asked to close the tile.
    Close,
}
