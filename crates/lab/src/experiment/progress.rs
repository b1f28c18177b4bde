//! How far an experiment is, and why one cannot run.

use backlit_formats::FootageError;
use backlit_tracking::body::ModelError;
use backlit_tracking::camera::CameraError;
use backlit_tracking::fit::FitError;
use backlit_tracking::initialisation::InitialisationError;
use backlit_tracking::search::WithoutStartError;
use backlit_tracking::silhouette::{MaskError, MeasurementError};
use thiserror::Error;

use crate::synthetic::upper_body::CamerasError;

/// How far an experiment is: units of work done, of all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Done so far.
    pub done: usize,
    /// To do in all, at least `done`.
    pub total: usize,
}

/// Why an experiment gave no report.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ExperimentError {
    #[error("`{option}` is {value}; expected {expected}")]
    Option { option: &'static str, value: f64, expected: &'static str },
    #[error("the experiment was stopped")]
    Cancelled,
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Cameras(#[from] CamerasError),
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Mask(#[from] MaskError),
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    #[error(transparent)]
    WithoutStart(WithoutStartError),
    #[error(transparent)]
    Initialisation(InitialisationError),
    #[error("{0}")]
    Footage(String),
}

impl From<WithoutStartError> for ExperimentError {
    fn from(error: WithoutStartError) -> Self {
        match error {
            WithoutStartError::Cancelled => Self::Cancelled,
            error => Self::WithoutStart(error),
        }
    }
}

impl From<InitialisationError> for ExperimentError {
    fn from(error: InitialisationError) -> Self {
        match error {
            InitialisationError::Cancelled => Self::Cancelled,
            error => Self::Initialisation(error),
        }
    }
}

impl From<FootageError> for ExperimentError {
    fn from(error: FootageError) -> Self {
        Self::Footage(error.to_string())
    }
}
