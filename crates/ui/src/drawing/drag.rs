//! A drag in a picture.

use glam::DVec2;

use super::JointId;

/// What the pointer does with a drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DragEvent {
    /// It begins. Pressing a modifier on the way begins again, from the pose that is reached.
    Begin(Drag),
    /// It goes on. Everything counts from the pose at the start.
    Move(Drag),
    /// The button is up.
    End,
    /// Esc: all is as it was when the button went down.
    Cancel,
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
