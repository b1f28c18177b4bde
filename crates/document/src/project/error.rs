//! What can be wrong with a project.

use std::path::PathBuf;

use backlit_formats::FileError;
use backlit_tracking::body::{ModelError, PoseError};
use backlit_tracking::fit::OptionsError;
use backlit_tracking::segment::SegmentError;
use thiserror::Error;

use super::FORMAT;

/// Why a project cannot be read or written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ProjectError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: {source}", path.display())]
    Json { path: PathBuf, source: serde_json::Error },
    #[error("{}: `format` is \"{found}\"; expected \"{FORMAT}\"", path.display())]
    Format { path: PathBuf, found: String },
    #[error(
        "{}: a newer Backlit wrote this project (\"{found}\"; this one reads \"{FORMAT}\"): open it with that one",
        path.display()
    )]
    Newer { path: PathBuf, found: String },
    #[error("{}, line {line}: the file ends too early: it was cut off", path.display())]
    Cut { path: PathBuf, line: usize },
    #[error("{}: `model`: {source}", path.display())]
    Model { path: PathBuf, source: ModelError },
    #[error("{}: `{field}`: {source}", path.display())]
    Pose { path: PathBuf, field: String, source: PoseError },
    #[error("{}: `{field}` names the limb \"{limb}\", which the model does not have", path.display())]
    Limb { path: PathBuf, field: String, limb: String },
    #[error(
        "{}: `{field}` names the limb \"{limb}\", which has no rotation of its own: it turns with the limb before it",
        path.display()
    )]
    Rigid { path: PathBuf, field: String, limb: String },
    #[error("{}: `{field}` is {value}; expected {expected}", path.display())]
    Number { path: PathBuf, field: String, value: f64, expected: &'static str },
    #[error("{}: `measurement` has {count} entries; expected one for each of the {cameras} cameras", path.display())]
    Measurements { path: PathBuf, count: usize, cameras: usize },
    #[error("{}: `masks.{frame}` names the camera \"{camera}\", which the take does not have", path.display())]
    MaskCamera { path: PathBuf, frame: usize, camera: String },
    #[error("{}: `fit`: {source}", path.display())]
    Fit { path: PathBuf, source: OptionsError },
    #[error("{}: `{field}.fit`: {source}", path.display())]
    RunFit { path: PathBuf, field: String, source: OptionsError },
    #[error("{}: `measurement`, camera {index} counted from 0: {source}", path.display())]
    Measurement { path: PathBuf, index: usize, source: SegmentError },
    #[error("{}: `cameras`: the weight of {camera} is {weight}; expected a number, 0 or above", path.display())]
    Weight { path: PathBuf, camera: String, weight: f64 },
}
