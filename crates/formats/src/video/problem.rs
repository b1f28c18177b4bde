//! What is wrong with a video.

use backlit_tracking::camera::MAX_PIXELS;
use thiserror::Error;

use crate::reason;

/// What is wrong with a video.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum VideoProblem {
    #[error(
        "is not a video that is known; expected MP4, MOV, AVI, or what ffmpeg reads: MKV, WebM, MTS, WMV, FLV"
    )]
    Unknown,
    #[error("has no index: the recording was cut off before it was finished, and no frame can be read")]
    NoIndex,
    #[error("has no video track")]
    NoVideo,
    #[error("ends before its first whole frame; its index names {whole} frames")]
    NoFrames { whole: usize },
    #[error("has more than {limit} frames; expected fewer")]
    TooManyFrames { limit: usize },
    #[error(
        "has pictures of {}×{} pixels; expected 1 to {limit} a side, and at most {} megapixels", size[0], size[1],
        MAX_PIXELS >> 20
    )]
    Size { size: [usize; 2], limit: usize },
    #[error("cannot be read: {}", reason(.error))]
    Read { error: std::io::Error },
    #[error("frame {frame} cannot be decoded: {reason}")]
    Frame { frame: usize, reason: String },
    #[error("there is no frame {frame}; the video has {count}, counted from 0")]
    NoFrame { frame: usize, count: usize },
    #[error(
        "the video is {codec}, which needs the program {program}; install it (Debian and Ubuntu: apt install ffmpeg; \
         macOS: brew install ffmpeg; Windows: winget install ffmpeg) or convert the video to H.264"
    )]
    NeedsProgram { codec: String, program: String },
    #[error("the video is {codec}, and {program} cannot read it: {message}")]
    Program { codec: String, program: String, message: String },
}
