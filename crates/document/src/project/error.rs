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
    #[error("{}: {error}", path.display())]
    Json { path: PathBuf, error: serde_json::Error },
    #[error("{}: `format` is \"{found}\"; expected \"{FORMAT}\"", path.display())]
    Format { path: PathBuf, found: String },
    #[error(
        "{}: a newer Backlit wrote this project (\"{found}\"; this one reads \"{FORMAT}\"): open it with that one",
        path.display()
    )]
    Newer { path: PathBuf, found: String },
    #[error("{}, line {line}: the file ends too early: it was cut off", path.display())]
    Cut { path: PathBuf, line: usize },
    #[error("{}: `model`: {error}", path.display())]
    Model { path: PathBuf, error: ModelError },
    #[error("{}: `{field}`: {error}", path.display())]
    Pose { path: PathBuf, field: String, error: PoseError },
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
    #[error("{}: `plates` names the camera \"{camera}\", which the take does not have", path.display())]
    PlateCamera { path: PathBuf, camera: String },
    #[error("{}: `masks.{frame}` names the camera \"{camera}\", which the take does not have", path.display())]
    MaskCamera { path: PathBuf, frame: usize, camera: String },
    #[error("{}: `fit`: {error}", path.display())]
    Fit { path: PathBuf, error: OptionsError },
    #[error("{}: `{field}.fit`: {error}", path.display())]
    RunFit { path: PathBuf, field: String, error: OptionsError },
    #[error("{}: `measurement`, camera {index} counted from 0: {error}", path.display())]
    Measurement { path: PathBuf, index: usize, error: SegmentError },
    #[error("{}: `cameras`: the weight of {camera} is {weight}; expected a number, 0 or above", path.display())]
    Weight { path: PathBuf, camera: String, weight: f64 },
}
