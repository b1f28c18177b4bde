//! Videos: any frame of a file, exactly, as RGB.
//!
//! MP4 and MOV files with H.264 or Motion JPEG and AVI files with Motion JPEG are read here, in Rust; anything
//! else by the programs `ffmpeg` and `ffprobe`, where they are installed. Frames are counted in the order in which they
//! are shown, each has its own time, and the picture is turned as the file says. What is cut or damaged gives the frames
//! that are there, and a [note](Video::notes).
//!
//! | file | holds |
//! |---|---|
//! | `boxes`, `mp4`, `tables`, `fragments`, `edits` | the index of MP4 and MOV |
//! | `avi` | the index of AVI |
//! | `index` | an index: samples, frames, times |
//! | `h264`, `jpeg`, `coded` | decoding by the index |
//! | `probe`, `ffmpeg` | decoding by the programs |
//! | `yuv`, `orientation` | planes to pictures |
//! | `cache` | frames that are kept |
//! | `problem` | what is wrong |

mod avi;
mod boxes;
mod cache;
mod coded;
mod edits;
mod ffmpeg;
mod fragments;
mod h264;
mod index;
mod jpeg;
mod mp4;
mod orientation;
mod probe;
mod problem;
mod tables;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod video;
mod yuv;

pub use cache::{DEFAULT_CACHE_MB, FrameCache};
pub use problem::VideoProblem;
pub use video::Video;

use image::RgbImage;

/// Most frames of a video: hours at any rate.
pub const MAX_VIDEO_FRAMES: usize = 1_000_000;

/// What is asked of a source.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    frame: usize,
    /// 1 for the full size.
    divisor: usize,
    /// Frames from here on that are decoded on the way are wanted too.
    keep_from: usize,
}

/// Takes frames that were decoded on the way.
type Sink<'a> = dyn FnMut(usize, RgbImage) + 'a;
