//! Files in and out: all that Backlit reads and writes. Formats are described in `docs/formats.md`.
//!
//! Every reader takes bytes from anyone: it never panics, bounds sizes and allocations, and its errors name the
//! file, the line or the field, and what was expected. Every file is written [atomically](atomic).

pub mod atomic;
mod base64;
pub mod bvh;
pub mod calibration;
#[cfg(test)]
mod damaged;
pub mod error;
pub mod export;
pub mod files;
pub mod footage;
pub mod images;
pub mod import;
mod joint_names;
pub mod json_text;
pub mod keypoints;
pub mod masks;
pub mod memory;
pub mod mesh;
pub mod model_file;
pub mod motion;
pub mod npy;
pub mod placement_file;
mod plain_words;
pub mod plate;
pub mod pose_file;
pub mod prior_file;
pub mod recording;
pub mod sphere_tree_file;
pub mod starts_file;
pub mod synchronise;
pub mod take;
pub mod text;
mod toml_text;
pub mod trc;
pub mod video;

pub use error::{FileError, FileProblem, Result, TextFormat, reason};
pub use files::{DiskFiles, FileParts, MAX_TEXT_BYTES, MemoryFiles, TakeFiles};
pub use footage::{Footage, FootageError};
pub use take::{Take, TakeError};
