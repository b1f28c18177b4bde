//! What the user did in a tile.

use glam::DVec2;

use crate::context::pane::Pane;
use crate::context::view_settings::ViewSettings;
use crate::drawing::{Comparison, JointId, ViewMode};
use crate::widgets::Framing;

/// What the user did in a tile. The app applies it after the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TileEvent {
    /// Pressed somewhere: the tile becomes the active one.
    Activate,
    /// The pointer is on another pixel than before, or has left the picture.
    Hover(Option<[usize; 2]>),
    /// Pressed a joint.
    SelectJoint(JointId),
    /// Pressed a limb's body.
    SelectLimb(usize),
    /// Began to drag. Pressing a modifier on the way begins anew, from the pose that is reached.
    DragStart(Drag),
    /// Dragged on. Everything counts from the pose at the start.
    Drag(Drag),
    /// Let go.
    DragEnd,
    /// Pressed Esc: all is as it was when the button went down.
    DragCancelled,
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
    /// Set the camera's weight in the fit.
    SetWeight(f64),
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
    /// Asked for silhouettes.
    Segment,
}

/// How a drag moves the body, counted from the pose at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drag {
    /// A joint follows the pointer parallel to the image; the chain follows it.
    Joint {
        /// The joint.
        joint: JointId,
        /// Where the picture is to show it.
        target_px: DVec2,
    },
    /// A joint moves along its sight ray. The root takes the whole body with it.
    Depth {
        /// The joint.
        joint: JointId,
        /// Its depth is the one at the start times this.
        ratio: f64,
    },
    /// A limb turns about itself.
    Twist {
        /// The limb that owns the rotation.
        limb: usize,
        /// Radians, right-handed about the limb from its first joint to its second.
        angle_rad: f64,
    },
    /// A limb turns about its first joint, in the plane of the image.
    Turn {
        /// The limb that owns the rotation.
        limb: usize,
        /// Its first joint in the picture: the axis is that pixel's ray.
        pivot_px: DVec2,
        /// Radians, right-handed about that ray away from the camera: clockwise as seen.
        angle_rad: f64,
    },
    /// A limb becomes longer or shorter by its end.
    Length {
        /// The limb.
        limb: usize,
        /// Where it was taken hold of.
        from_px: DVec2,
        /// Where the pointer is.
        to_px: DVec2,
    },
    /// A limb becomes thicker or thinner by its outline.
    Radius {
        /// The limb.
        limb: usize,
        /// Where it was taken hold of.
        from_px: DVec2,
        /// Where the pointer is.
        to_px: DVec2,
    },
    /// The whole body moves parallel to the image.
    Body {
        /// Where it was taken hold of.
        from_px: DVec2,
        /// Where that point is to be.
        to_px: DVec2,
        /// The depth of that point, metres.
        depth_m: f64,
    },
}
