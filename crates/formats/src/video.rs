//! Videos: any frame of a file, exactly, as RGB.
//!
//! MP4 and MOV files with H.264 or Motion JPEG and AVI files with Motion JPEG are read here, in Rust; anything else, and
//! H.264 of which many pictures are to be decoded, by the programs `ffmpeg` and `ffprobe`, where they are installed. Frames
//! are counted in the order in which they are shown, each has its own time, and the picture is turned as the file says.
//! What is cut or damaged gives the frames that are there, and a [note](Video::notes).

mod avi;
mod boxes;
mod cache;
mod coded;
mod decoder;
mod ffmpeg;
mod h264;
mod index;
mod jpeg;
mod mp4;
mod orientation;
mod probe;
mod samples;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod video;
mod yuv;

pub use cache::FrameCache;
pub use video::Video;

use backlit_tracking::camera::MAX_PIXELS;
use image::RgbImage;
use thiserror::Error;

use crate::reason;

/// Most frames of a video: hours at any rate.
pub const MAX_VIDEO_FRAMES: usize = 1_000_000;

/// The frame that a decoder is asked for.
#[derive(Debug, Clone, Copy)]
struct FrameRequest {
    frame: usize,
    /// 1 for the full size.
    divisor: usize,
    /// Frames from here on that are decoded on the way are kept too.
    keep_from: usize,
}

/// Takes frames that were decoded on the way.
type Sink<'a> = dyn FnMut(usize, RgbImage) + 'a;

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
