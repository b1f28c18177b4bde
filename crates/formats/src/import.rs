//! A take in one step: what lies in a folder, which camera it belongs to, and the take file that says so.
//!
//! | file | holds |
//! |---|---|
//! | `scan` | videos, numbered pictures, calibrations, keypoints and tables in folders |
//! | `candidates` | files that may be footage, and the folder that goes with most cameras |
//! | `masks` | silhouettes that were made elsewhere |
//! | `matching` | which file belongs to which camera, by names and numbers |
//! | `picture_size` | how pictures were made from those that a calibration is for |
//! | `pictures` | a camera's footage: a video or numbered pictures |
//! | `project` | the tools whose projects are recognised |
//! | `look` | all of it together: what was found, what is missing |
//! | `plates` | backgrounds learnt from the footage, the size to work at |
//! | `rig` | a calibration that is off, mended by keypoints |
//! | `start` | a pose to begin with, from keypoints |
//! | `write` | the take |
//!
//! Nothing is copied: a take names the footage where it lies.

mod candidates;
mod look;
mod masks;
mod matching;
mod picture_size;
mod pictures;
mod plates;
mod project;
mod rig;
mod scan;
mod start;
mod write;

pub use look::{Found, FoundCamera, ImportError, ImportOptions, look};
pub use masks::FoundMasks;
pub use matching::MatchedBy;
pub use picture_size::PictureSize;
pub use pictures::Pictures;
pub use project::Project;
pub use write::{Background, ImportStep, WriteOptions, write};
