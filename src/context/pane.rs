//! Panes: what can stand in a tile of the centre.
//!
//! Another kind of pane is one variant of [`Pane`] with its row in `Pane::KINDS`, and a feature that fills it. Menus, saving,
//! dragging, closing and the full window follow from those. A feature fills the `Ui` that it gets. Its first
//! [`size::TILE_HEADER`] points are the header by which the tile is dragged: the dock puts its own buttons at the right end
//! of it, so a pane leaves `HEADER_BUTTONS` points free there.
//!
//! [`size::TILE_HEADER`]: backlit_ui::style::theme::size::TILE_HEADER

use backlit_ui::style::theme::size;
use egui_tiles::TileId;
use serde::{Deserialize, Serialize};

use crate::context::preferences::Layout;

/// Room that is left free at the right end of a pane's header, in points.
pub(crate) const HEADER_BUTTONS: f32 = 2.0 * size::BUTTON + 4.0;

/// What stands in a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pane {
    /// A camera's view, counted from zero.
    Camera(usize),
    /// Body and cameras in three dimensions.
    Scene,
    /// The convergence plot with its runs and steps.
    Convergence,
    /// The basin of the frame: success over angle, or a map.
    Basin,
    /// What the tracked motion is called: the plane of motions.
    Motions,
    /// Ways to begin, one beside another, step by step.
    Beginnings,
    /// Silhouettes: how they come about, the worst of them, and what steers them.
    Silhouettes,
    /// The poses beside references, and runs of the fit beside each other.
    Compare,
}

/// Where a pane comes in that has no place yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum PaneSide {
    /// A column at the right of everything.
    Right,
    /// A row below everything.
    Below,
}

impl Pane {
    /// The panes that are no cameras: title, where they come in, the layout that begins with them, and what they show.
    #[rustfmt::skip]
    pub(crate) const KINDS: [(Self, &'static str, PaneSide, Option<Layout>, &'static str); 7] = [
        (Self::Scene, "Scene", PaneSide::Right, Some(Layout::Debug), "Body, cameras and their pictures in three dimensions"),
        (Self::Convergence, "Convergence", PaneSide::Below, Some(Layout::Debug), "The runs of the fit, step by step"),
        (Self::Basin, "Basin", PaneSide::Right, None, "How far off a start may be and still find the right pose"),
        (Self::Motions, "Motions", PaneSide::Right, None, "What the tracked motion is called, and why: a curve among kinds of motion"),
        (Self::Beginnings, "Ways to begin", PaneSide::Right, None, "Particles, ramp, templates and search, step by step"),
        (Self::Silhouettes, "Silhouettes", PaneSide::Right, None, "How a silhouette comes about, which are worst, and brushes to mend them"),
        (Self::Compare, "Compare", PaneSide::Below, None, "Joints and angles beside recordings of other tools or other tracks, and runs of the fit as a table"),
    ];

    /// All panes of a take with this number of cameras.
    pub(crate) fn all(cameras: usize) -> impl Iterator<Item = Self> {
        (0..cameras).map(Self::Camera).chain(Self::KINDS.iter().map(|kind| kind.0))
    }

    fn row(self) -> Option<usize> {
        Self::KINDS.iter().position(|kind| kind.0 == self)
    }

    pub(crate) fn title(self) -> String {
        match (self, self.row()) {
            (Self::Camera(index), _) => format!("Camera {}", index + 1),
            (_, row) => row.map_or_else(String::new, |row| Self::KINDS[row].1.to_owned()),
        }
    }

    pub(crate) fn explanation(self) -> &'static str {
        self.row().map_or("The camera’s picture, silhouette and fit", |row| Self::KINDS[row].4)
    }

    /// The scope of its widgets: of the pane, not of its place, so that a pane that is moved keeps its state and its
    /// textures.
    pub(crate) fn scope(self) -> egui::Id {
        egui::Id::unique(("pane", self))
    }

    pub(crate) fn side(self) -> PaneSide {
        self.row().map_or(PaneSide::Right, |row| Self::KINDS[row].2)
    }

    /// Whether a layout has it as long as the user has not closed it.
    pub(crate) fn is_open_at_first(self, layout: Layout) -> bool {
        self.row().is_none_or(|row| Self::KINDS[row].3 == Some(layout))
    }

    /// Names its tile: the same in every arrangement, so that a pane that is moved stays the same for egui.
    pub(crate) fn tile_id(self) -> TileId {
        const CAMERAS_FROM: u64 = 2000;
        const KINDS_FROM: u64 = 1000;
        TileId::from_u64(match self {
            Self::Camera(index) => CAMERAS_FROM + index as u64,
            _ => KINDS_FROM + self.row().unwrap_or(0) as u64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pane_has_its_row_and_a_tile_of_its_own() {
        let panes: Vec<Pane> = Pane::all(9).collect();
        // The last variant of the enumeration.
        assert!(panes.contains(&Pane::Motions));
        assert!(panes.contains(&Pane::Beginnings));
        for (index, pane) in panes.iter().enumerate() {
            assert!(!pane.title().is_empty() && !pane.explanation().ends_with('.'), "{pane:?}");
            assert!(panes[..index].iter().all(|other| other.tile_id() != pane.tile_id()), "{pane:?}");
        }
    }
}
