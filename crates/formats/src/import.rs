//! A take in one step: what lies in a folder, which camera it belongs to, and the take file that says so.
//!
//! | file | holds |
//! |---|---|
//! | `scan` | videos, numbered pictures, calibrations, keypoints and tables in folders |
//! | `matching` | which file belongs to which camera, by names and numbers |
//! | `masks` | silhouettes that were made elsewhere |
//! | `pictures` | a camera's footage: a video or numbered pictures, and how they were made |
//! | `project` | the tools whose projects are recognised |
//! | `survey` | all of it together: what is there, what is missing |
//! | `plates` | backgrounds learnt from the footage, the size to work at |
//! | `keypoints` | a calibration that is off, mended by keypoints; a pose to begin with |
//! | `write` | the take |
//!
//! Nothing is copied: a take names the footage where it lies.

mod keypoints;
mod masks;
mod matching;
mod pictures;
mod plates;
mod project;
mod scan;
mod survey;
mod write;

pub use masks::ImportMasks;
pub use matching::MatchedBy;
pub use pictures::{PictureSize, Pictures};
pub use project::Project;
pub use survey::{ImportCamera, ImportError, ImportOptions, ImportSurvey, survey};
pub use write::{Background, ImportStep, WriteOptions, write};
