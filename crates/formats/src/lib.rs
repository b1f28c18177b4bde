//! Files in and out: all that Backlit reads and writes. Formats are described in `docs/formats.md`.
//!
//! Every reader takes bytes from anyone: it never panics, bounds sizes and allocations, and its errors name the
//! file, the line or the field, and what was expected. Every file is written [atomically](atomic).
//!
//! | file | holds |
//! |---|---|
//! | [`take`] | a take: footage, cameras, body, start pose, reference |
//! | [`footage`] | a take's rectified pictures and silhouettes |
//! | [`synchronise`] | offsets of a take's cameras, found from its silhouettes |
//! | [`model_file`] | body models |
//! | [`pose_file`] | poses |
//! | [`bvh`] | motion of a skeleton, and a person's joints in it |
//! | [`prior_file`] | what motion files say of poses and steps |
//! | [`mod@import`] | a take made of footage and a calibration |
//! | [`plate`] | a camera's view without the subject, learnt from footage |
//! | [`keypoints`], [`trc`] | what other tools found in the same footage |
//! | [`starts_file`] | starts of fits of known truth |
//! | [`calibration`] | cameras, in several formats |
//! | [`export`] | tracks as tables and JSON |
//! | [`mesh`] | closed triangle meshes: OBJ, PLY, STL, glTF |
//! | [`sphere_tree_file`] | sphere trees of meshes |
//! | [`motion`] | motion for animation and biomechanics |
//! | [`masks`] | silhouettes that were made elsewhere |
//! | [`images`], [`npy`] | pictures and arrays |
//! | [`video`] | videos, any frame of them |
//! | [`files`] | the disk, or files held in memory |
//! | [`atomic`] | whole files or none |
//! | [`error`] | what is wrong with a file, and where |
//! | [`mod@text`], [`json_text`] | what of a file may be shown; JSON with errors that name the field |

pub mod atomic;
mod base64;
pub mod bvh;
pub mod calibration;
pub mod error;
pub mod export;
pub mod files;
pub mod footage;
pub mod images;
pub mod import;
pub mod json_text;
pub mod keypoints;
pub mod masks;
pub mod mesh;
pub mod model_file;
pub mod motion;
pub mod npy;
mod plain_words;
pub mod plate;
pub mod pose_file;
pub mod prior_file;
pub mod sphere_tree_file;
pub mod starts_file;
pub mod synchronise;
pub mod take;
pub mod text;
mod toml_text;
pub mod trc;
pub mod video;

pub use error::{FileError, FileProblem, TextFormat, reason};
pub use files::{DiskFiles, FileParts, MAX_TEXT_BYTES, MemoryFiles, TakeFiles};
pub use footage::{Footage, FootageError};
pub use take::{Take, TakeError};
