//! The cameras of a take.

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
    #[must_use]
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// Number of cameras, at least one.
    #[must_use]
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
