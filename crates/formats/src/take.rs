//! A take: one recording with everything that belongs to it, as `take.toml` says it (see `docs/formats.md`).
//!
//! | file | holds |
//! |---|---|
//! | [`take`] | [`Take`]: the parsed take; pictures on demand |
//! | [`frame_pattern`] | names of numbered pictures |
//! | `pictures` | its pictures, backgrounds and masks, reduced |
//! | [`footage`] | one camera's pictures and background |
//! | `masks` | one camera's masks that were made elsewhere |
//! | `keypoints` | one camera's two-dimensional keypoints |
//! | `films` | videos: offsets, the frames that all cameras have |
//! | `outside` | what lies outside the take's folder |
//! | `offsets` | offsets written into a take file |
//! | [`mod@reference`] | keypoints to compare with |
//! | [`error`] | what is wrong, by camera and frame |

mod environment;
pub mod error;
mod films;
pub mod footage;
pub mod frame_pattern;
mod keypoints;
mod known;
mod masks;
mod measurement;
mod offsets;
mod outside;
mod pictures;
mod reader;
pub mod reference;
mod spec;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
pub mod take;

pub use error::TakeError;
pub use films::USUAL_BACKGROUND_FRAMES;
pub use footage::{BackgroundSource, CameraFootage, MAX_BACKGROUND_FRAMES, MAX_FRAMES};
pub(crate) use frame_pattern::split_number;
pub use frame_pattern::{FramePattern, PatternError};
pub use known::Known;
pub use offsets::{OffsetShift, shift_offsets};
pub use outside::Outside;
pub use reference::{Joint, Reference};
pub use spec::{BodySizes, FORMAT};
pub use take::{FILE_NAME, Take};
