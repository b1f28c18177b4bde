//! A take: one recording with everything that belongs to it, as `take.toml` says it (see `docs/formats.md`).

mod footage;
mod keypoints;
mod masks;
mod measurement;
mod offsets;
mod paths;
mod pictures;
mod reader;
pub mod reference;
mod spec;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
pub mod take;

use thiserror::Error;

use crate::FileError;

pub use footage::{
    BackgroundSource, CameraFootage, MAX_BACKGROUND_FRAMES, MAX_FRAMES, PlateKnowledge,
    USUAL_BACKGROUND_FRAMES,
};
pub use measurement::measurement_lines;
pub use offsets::{OffsetShift, shift_offsets};
pub(crate) use paths::split_number;
pub use paths::{FramePattern, Outside, PatternError};
pub use reference::{Joint, Reference};
pub use spec::{BodySizes, FORMAT};
pub use take::{FILE_NAME, Take};

/// Why a take, or a picture of it, cannot be had.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum TakeError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("camera \"{camera}\", frame {frame}: {error}")]
    Frame { camera: String, frame: usize, error: FileError },
    #[error("camera \"{camera}\", mask of frame {frame}: {error}")]
    Mask { camera: String, frame: usize, error: FileError },
    #[error("camera \"{camera}\", background: {error}")]
    Background { camera: String, error: FileError },
    #[error(
        "camera \"{camera}\" has {found} frames, camera \"{other}\" {expected}; the first that is missing is {file}"
    )]
    FrameCount { camera: String, found: usize, other: String, expected: usize, file: String },
    #[error(
        "no frame is in all cameras: camera \"{camera}\" ends before frame {ends} of the take, camera \"{other}\" begins \
         with {begins}"
    )]
    NoCommonFrame { camera: String, ends: i64, other: String, begins: i64 },
    #[error("there is no frame {frame}; the take has {count}, counted from 0")]
    NoFrame { frame: usize, count: usize },
    #[error("there is no camera {camera}; the take has {count}, counted from 0")]
    NoCamera { camera: usize, count: usize },
}
