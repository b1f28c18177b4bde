//! What the user did in a tile.

use backlit_document::history::Gesture;
use backlit_ui::drawing::{Comparison, DragEvent, JointId, ViewMode};
use backlit_ui::widgets::Framing;

use crate::context::pane::Pane;
use crate::context::view_settings::ViewSettings;

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
    /// Chose a view mode.
    SetMode(ViewMode),
    /// Chose the mode that it is compared with.
    CompareWith(ViewMode),
    /// Began a comparison, chose its other way, or ended it.
    SetComparison(Option<Comparison>),
    /// Changed what all views share.
    SetSettings(ViewSettings),
    /// Moved the wipe's handle: 0 at the left edge of the picture, 1 at the right.
    SetWipe(f32),
    /// Ticked or unticked the camera's use in the fit.
    SetUsed(bool),
    /// Set the camera's weight in the fit, with the gesture of the slider.
    SetWeight(f64, Option<Gesture>),
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
