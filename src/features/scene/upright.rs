//! Which way is up, and where the floor is: takes do not say.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use glam::DVec3;

/// A world axis is up when the cameras' own up is this near to it (cosine of 35°).
const NEAR_AXIS: f64 = 0.82;
/// The floor is the plane through the origin when the body's lowest point is this near to it.
const NEAR_ORIGIN: f64 = 0.25;

/// Directions of a person who stands in the world. They are unit vectors at right angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Upright {
    /// Away from the floor.
    pub(crate) up: DVec3,
    /// Along the floor: what azimuths count from.
    pub(crate) ahead: DVec3,
}

impl Upright {
    /// Cameras are held upright, on the whole: the world axis nearest to the mean of their up directions.
    pub fn of(cameras: &[Arc<Camera>]) -> Self {
        let mean: DVec3 =
            cameras.iter().map(|camera| -camera.camera_from_world().rotation.transpose().y_axis).sum();
        let mean = mean.normalize_or(DVec3::Z);
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let up = axes.into_iter().find(|axis| axis.dot(mean) > NEAR_AXIS).unwrap_or(mean);
        let along = if up.x.abs() < 0.7 { DVec3::X } else { DVec3::Y };
        Self { up, ahead: (along - up * up.dot(along)).normalize() }
    }

    /// To the left of one who looks ahead.
    pub(crate) fn left(&self) -> DVec3 {
        self.up.cross(self.ahead)
    }

    /// A direction by azimuth and elevation in radians.
    pub(crate) fn direction(&self, azimuth: f64, elevation: f64) -> DVec3 {
        let along = self.ahead * azimuth.cos() + self.left() * azimuth.sin();
        along * elevation.cos() + self.up * elevation.sin()
    }

    /// Azimuth and elevation of a direction, in radians.
    pub(crate) fn angles(&self, direction: DVec3) -> [f64; 2] {
        let azimuth = direction.dot(self.left()).atan2(direction.dot(self.ahead));
        let height = direction.normalize_or(self.ahead).dot(self.up);
        [azimuth, height.clamp(-1.0, 1.0).asin()]
    }

    /// Height of the floor: the body's lowest point in the start pose, or the origin if that is about the same.
    pub(crate) fn floor(&self, model: &Model, start: &Pose) -> f64 {
        let kinematics = Kinematics::new(model, start);
        let joints = kinematics.starts().iter().zip(kinematics.ends()).zip(model.limbs());
        let lowest = joints
            .map(|((from, to), limb)| from.dot(self.up).min(to.dot(self.up)) - limb.radius)
            .fold(f64::INFINITY, f64::min);
        if lowest.is_finite() && lowest.abs() > NEAR_ORIGIN { lowest } else { 0.0 }
    }

    /// Where the body looks, by its left and right limbs; `None` for a body without sides, or one that lies.
    pub(crate) fn facing(&self, model: &Model, kinematics: &Kinematics) -> Option<DVec3> {
        let ends = kinematics.ends();
        let across: DVec3 = model
            .limbs()
            .iter()
            .enumerate()
            .filter(|(_, limb)| limb.name.starts_with("right "))
            .map(|(index, _)| ends[model.mirrored_limb(index)] - ends[index])
            .sum();
        let ahead = across.cross(self.up);
        (ahead.length() > 0.2 * across.length()).then(|| ahead.normalize())
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};

    use super::*;

    fn around(up: DVec3) -> Vec<Arc<Camera>> {
        let (a, b) = (up.any_orthonormal_vector(), up.cross(up.any_orthonormal_vector()));
        let camera = |angle: f64| {
            let at = (a * angle.cos() + b * angle.sin()) * 4.0 + up * 2.0;
            let place = CameraFromWorld::looking_at(at, up, up);
            let intrinsics = Intrinsics { fx: 400.0, fy: 400.0, cx: 135.5, cy: 239.5 };
            Arc::new(Camera::new("c", [272, 480], intrinsics, Distortion::None, place).unwrap())
        };
        [0.0, 1.7, 3.0, 4.4].map(camera).to_vec()
    }

    #[test]
    fn up_is_found_from_the_cameras() {
        for up in [DVec3::Z, DVec3::Y, DVec3::NEG_Y, DVec3::X] {
            let upright = Upright::of(&around(up));
            assert_eq!(upright.up, up);
            assert!(upright.ahead.dot(up).abs() < 1e-12 && (upright.left().length() - 1.0).abs() < 1e-12);
            let [azimuth, elevation] = upright.angles(upright.direction(0.7, -0.4));
            assert!((azimuth - 0.7).abs() < 1e-9 && (elevation + 0.4).abs() < 1e-9);
        }
        assert_eq!(Upright::of(&[]).up, DVec3::Z);
    }

    #[test]
    fn the_body_at_rest_faces_away_from_its_back() {
        let model = builtin::full_body();
        let pose = Pose::rest(&model);
        let kinematics = Kinematics::new(&model, &pose);
        let foot = model.limb_index("right foot").unwrap();
        let toes = kinematics.ends()[foot] - kinematics.starts()[foot];
        let head =
            kinematics.ends().iter().fold(DVec3::ZERO, |top, end| if end.z > top.z { *end } else { top });
        let up = if head.z > 0.5 { DVec3::Z } else { DVec3::Y };
        let upright = Upright { up, ahead: DVec3::X };
        let facing = upright.facing(&model, &kinematics).unwrap();
        assert!(facing.dot(toes) > 0.0, "{facing} {toes}");
        assert!(upright.floor(&model, &pose) < -0.5, "the feet are below the root");
    }
}
