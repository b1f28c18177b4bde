//! The built-in take's cameras: four around the room, two of them with a lens that bends.

use std::sync::Arc;

use backlit_tracking::camera::{Camera, CameraError, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::DVec3;

/// Pixels across of the built-in take.
pub const WIDTH: u64 = 192;
/// Pixels down of the built-in take.
pub const HEIGHT: u64 = 256;

/// Four portrait cameras about 3.2 m from the middle of the movement.
#[must_use]
pub fn cameras() -> Rig {
    let none = Distortion::None;
    let barrel = Distortion::OpenCv { k1: -0.11, k2: 0.03, p1: 0.0006, p2: -0.0004, k3: 0.0 };
    let pincushion = Distortion::OpenCv { k1: 0.06, k2: -0.02, p1: -0.0003, p2: 0.0005, k3: 0.0 };
    let places = [
        // Azimuth from straight ahead to the subject's right (degrees), distance, height, focal length, lens.
        (22.0, 3.2, 1.45, 304.0, none),
        (112.0, 3.25, 1.95, 308.0, barrel),
        (204.0, 3.15, 1.25, 300.0, none),
        (286.0, 3.2, 1.7, 304.0, pincushion),
    ];
    let mut cameras = Vec::new();
    for (index, (azimuth, distance, height, focal, lens)) in places.into_iter().enumerate() {
        let (sin, cos) = f64::to_radians(azimuth).sin_cos();
        let target = DVec3::new(0.0, 0.12, 1.1);
        let centre = DVec3::new(sin * distance, 0.12 + cos * distance, height);
        let place = CameraFromWorld::looking_at(centre, target, DVec3::Z);
        let intrinsics = Intrinsics {
            fx: focal,
            fy: focal + 0.6,
            cx: WIDTH as f64 * 0.5 - 0.5 + 1.7 - index as f64,
            cy: HEIGHT as f64 * 0.5 - 0.5 - 2.1 + 1.3 * index as f64,
        };
        let name = format!("cam{}", index + 1);
        // The numbers stand above, and tests run over them.
        cameras.push(Camera::new(&name, [WIDTH, HEIGHT], intrinsics, lens, place).expect("a valid camera"));
    }
    Rig::new(cameras).expect("the names differ")
}

/// The same four without their lenses, in pictures of this many pixels.
///
/// # Errors
/// A size that no camera can have.
pub fn pinholes(size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, CameraError> {
    let pinhole = |camera: &Camera| camera.without_distortion().resized(size_px[0], size_px[1]);
    cameras().cameras().iter().map(|camera| pinhole(camera).map(Arc::new)).collect()
}

/// A camera at the first place that looks at the second, its picture's middle on the axis.
///
/// # Errors
/// Numbers that no camera can have.
pub fn pinhole(
    name: &str,
    size_px: [u64; 2],
    focal_px: f64,
    [centre, target]: [DVec3; 2],
    up: DVec3,
) -> Result<Arc<Camera>, CameraError> {
    let [cx, cy] = size_px.map(|side| 0.5 * (side as f64 - 1.0));
    let place = CameraFromWorld::looking_at(centre, target, up);
    let intrinsics = Intrinsics { fx: focal_px, fy: focal_px, cx, cy };
    Ok(Arc::new(Camera::new(name, size_px, intrinsics, Distortion::None, place)?))
}
