//! Data of experiments.
//!
//! | file | holds |
//! |---|---|
//! | [`sequence`] | a sequence, simulated or a take's, in the report's small pictures |
//! | [`starts`] | starts of known distance from their truth |
//! | [`credibility`] | whether a filter errs as it says |
//! | [`calibration_faults`] | calibrations with one known fault |
//! | [`disturbed_cameras`] | cameras that are not where their calibration says |
//! | [`disturbed_pictures`] | one camera's pictures with a patch, or under another light |
//! | [`scene`] | simulated data of a pose as a fit takes them |

pub mod calibration_faults;
pub mod credibility;
pub mod disturbed_cameras;
pub mod disturbed_pictures;
pub mod scene;
pub mod sequence;
pub mod starts;

use backlit_formats::FootageError;
use backlit_tracking::camera::CameraError;
use backlit_tracking::silhouette::{MaskError, MeasurementError};
use thiserror::Error;

pub use scene::Simulation;

use crate::synthetic::upper_body::CamerasError;

/// Why there are no data.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ExperimentError {
    #[error("`{option}` is {value}; expected {expected}")]
    Option { option: &'static str, value: f64, expected: &'static str },
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Cameras(#[from] CamerasError),
    #[error(transparent)]
    Mask(#[from] MaskError),
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    #[error("{0}")]
    Footage(String),
}

impl From<FootageError> for ExperimentError {
    fn from(error: FootageError) -> Self {
        Self::Footage(error.to_string())
    }
}
