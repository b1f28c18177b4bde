//! What is wrong with a take, by camera and frame.

use thiserror::Error;

use crate::FileError;

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
