//! Calibrated cameras, in OpenCV's conventions.
//!
//! Axes x right, y down, z forward. Pixel centres lie at integer coordinates. A transform is named
//! `a_from_b`: `point_in_camera = camera_from_world · point_in_world`. Metres and pixels.

#[doc(inline)]
pub use crate::synchronise;

mod adjust;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod camera;
mod change;
mod distortion;
mod rectify;
mod rig;

pub use adjust::{Adjusted, Sighting, adjust};
pub use camera::{
    Camera, CameraError, CameraFromWorld, FARTHEST, Intrinsics, LARGEST_NUMBER, MAX_PIXELS, MAX_SIDE,
};
pub use change::CameraChange;
pub use distortion::Distortion;
pub use rectify::Rectification;
pub use rig::{Rig, RigError, up_of};
