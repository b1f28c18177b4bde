//! One limb before a camera that sees it from the side: the report's Fig. 5.1.

use std::sync::Arc;

use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::camera::{Camera, CameraError};
use glam::{DQuat, DVec3};

use super::studio::pinhole;

/// How far along its axis the limb starts from the truth, metres.
pub const OFFSET_M: f64 = 0.1;

/// The limb's true pose: across the picture, its middle at the origin.
#[must_use]
pub fn truth() -> Pose {
    let model = builtin::single_limb();
    let limb = &model.limbs()[0];
    let across = DQuat::from_rotation_arc(limb.direction, DVec3::X);
    Pose { root: DVec3::NEG_X * (0.5 * limb.length), rotations: vec![across] }
}

/// Where the fit starts: `offset_m` along the axis.
#[must_use]
pub fn start(offset_m: f64) -> Pose {
    let mut pose = truth();
    pose.root += DVec3::X * offset_m;
    pose
}

/// A camera that sees the limb from the side; the limb takes half of the picture's width.
///
/// # Errors
/// A distance or a size that no camera can have.
pub fn camera(distance_m: f64, size_px: [u64; 2]) -> Result<Arc<Camera>, CameraError> {
    let length = builtin::single_limb().limbs()[0].length;
    let focal = 0.5 * size_px[0] as f64 * distance_m / length;
    pinhole("side", size_px, focal, [DVec3::Z * distance_m, DVec3::ZERO], DVec3::Y)
}
