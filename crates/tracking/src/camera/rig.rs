//! The cameras of a take.

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SymmetricEigen};
use thiserror::Error;

use super::Camera;

/// Cameras with different names, in a fixed order.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    cameras: Vec<Camera>,
}

/// Why cameras are not a rig.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum RigError {
    #[error("there is no camera; expected at least one")]
    Empty,
    #[error("camera name \"{name}\" is used twice; expected every name once")]
    DuplicateName { name: String },
    #[error("there is no camera \"{name}\"; there are {known}")]
    Unknown { name: String, known: String },
}

impl Rig {
    /// Checks that there are cameras and that their names differ.
    ///
    /// # Errors
    /// No camera, or a name twice.
    pub fn new(cameras: Vec<Camera>) -> Result<Self, RigError> {
        if cameras.is_empty() {
            return Err(RigError::Empty);
        }
        for (index, camera) in cameras.iter().enumerate() {
            if cameras[..index].iter().any(|other| other.name() == camera.name()) {
                return Err(RigError::DuplicateName { name: camera.name().to_owned() });
            }
        }
        Ok(Self { cameras })
    }

    /// The cameras in their order.
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// Number of cameras, at least one.
    pub fn count(&self) -> usize {
        self.cameras.len()
    }

    /// Index of the camera with this name.
    ///
    /// # Errors
    /// There is none; the message lists those there are.
    pub fn index(&self, name: &str) -> Result<usize, RigError> {
        self.cameras.iter().position(|camera| camera.name() == name).ok_or_else(|| RigError::Unknown {
            name: name.to_owned(),
            known: self.cameras.iter().map(Camera::name).collect::<Vec<_>>().join(", "),
        })
    }
}

/// ε: how much the cameras' own up directions count beside their levels.
const OWN_UP: f64 = 0.005;
/// Up is a world axis where it is as near to one as this cosine (12°): most calibrations set their world on the floor.
const NEAR_AXIS: f64 = 0.978;

/// Up, a unit vector in world axes; `None` without cameras, or where they do not agree on anything.
///
/// A world axis within 12° of it is taken for it.
pub fn up_of<'a>(cameras: impl IntoIterator<Item = &'a Camera>) -> Option<DVec3> {
    let (mut level, mut mean) = (DMat3::ZERO, DVec3::ZERO);
    for camera in cameras {
        let world_from_camera = camera.camera_from_world().rotation.transpose();
        let (across, up) = (world_from_camera.x_axis, -world_from_camera.y_axis);
        level += outer(across) + OWN_UP * (DMat3::IDENTITY - outer(up));
        mean += up;
    }
    if mean.length() < 1e-3 {
        return None;
    }
    let eigen = SymmetricEigen::new(Matrix3::from_column_slice(&level.to_cols_array()));
    let least = (0..3).min_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]))?;
    let column = eigen.eigenvectors.column(least);
    let up = DVec3::new(column[0], column[1], column[2]);
    let up = (if up.dot(mean) < 0.0 { -up } else { up }).try_normalize()?;
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    Some(axes.into_iter().find(|axis| axis.dot(up) > NEAR_AXIS).unwrap_or(up))
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures;
    fn camera(at: DVec3, target: DVec3, up: DVec3) -> Camera {
        fixtures::camera([272, 480], [400.0, 400.0, 135.5, 239.5], at, target, up)
    }

    #[test]
    fn level_cameras_that_look_down_from_one_side_agree_on_up() {
        // Their mean up leans by a third of a radian.
        for up in [DVec3::Y, DVec3::NEG_Z, DVec3::new(0.4, -0.3, 0.7).normalize()] {
            let side = up.any_orthonormal_vector();
            let other = up.cross(side);
            let cameras = [-0.5_f64, 0.1, 0.6].map(|angle| {
                camera((side * angle.cos() + other * angle.sin()) * 3.0 + up * 1.2, DVec3::ZERO, up)
            });
            let found = up_of(&cameras).unwrap();
            assert!(found.dot(up) > 0.999, "{found} for {up}");
        }
    }

    #[test]
    fn one_camera_says_its_own_up_and_a_world_axis_near_it_is_up() {
        let up = DVec3::new(0.1, 0.05, 1.0).normalize();
        let one = camera(DVec3::new(4.0, 0.0, 0.2), DVec3::ZERO, up);
        assert_eq!(up_of([&one]), Some(DVec3::Z));
        let leaning = DVec3::new(0.5, 0.2, 1.0).normalize();
        let one = camera(DVec3::new(0.0, 4.0, 0.0), DVec3::ZERO, leaning);
        let own = -one.camera_from_world().rotation.transpose().y_axis;
        assert!(up_of([&one]).unwrap().dot(own) > 0.9999);
        assert_eq!(up_of([]), None);
    }
}
