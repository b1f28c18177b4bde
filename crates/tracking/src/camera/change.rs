//! How a camera differs from what its calibration says.

use glam::{DMat3, DVec2, DVec3};

use super::{Camera, CameraError, CameraFromWorld, Distortion, Intrinsics};
use crate::geometry::rotation::exp;

/// By how much a camera differs from a calibration. The lens stays as it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CameraChange {
    /// Turn about the camera's centre, in the camera's axes: axis times radians.
    pub turn: DVec3,
    /// Move of the centre, world metres.
    pub shift: DVec3,
    /// Logarithm of the focal lengths' ratio.
    pub zoom: f64,
    /// Move of the principal point, pixels.
    pub principal_px: DVec2,
}

impl Camera {
    /// The camera with its numbers changed.
    ///
    /// # Errors
    /// The numbers make no camera.
    pub fn changed(&self, change: &CameraChange) -> Result<Self, CameraError> {
        let (k, zoom) = (self.intrinsics(), change.zoom.exp());
        let [cx, cy] = [k.cx + change.principal_px.x, k.cy + change.principal_px.y];
        let pinhole = Intrinsics { fx: k.fx * zoom, fy: k.fy * zoom, cx, cy };
        let rotation = DMat3::from_quat(exp(change.turn)) * self.camera_from_world().rotation;
        let translation = -(rotation * (self.centre() + change.shift));
        self.with_numbers(pinhole, *self.distortion(), CameraFromWorld { rotation, translation })
    }

    /// A camera with this one's name and picture size, and another pinhole, lens and place.
    ///
    /// # Errors
    /// The numbers make no camera.
    pub fn with_numbers(
        &self,
        pinhole: Intrinsics,
        lens: Distortion,
        place: CameraFromWorld,
    ) -> Result<Self, CameraError> {
        Self::new(self.name(), [self.width() as u64, self.height() as u64], pinhole, lens, place)
    }
}
