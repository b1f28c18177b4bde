//! A take in one step: what lies in a folder, which camera it belongs to, and the take file that says so.
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
pub use scan::Sequence;
pub use survey::{ImportCamera, ImportError, ImportOptions, ImportSurvey, survey};
pub use write::{Background, ImportStep, WriteOptions, write};
