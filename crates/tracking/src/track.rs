//! Following frames: each fit starts where the motion so far leads.
//!
//! | file | holds |
//! |---|---|
//! | `tracker` | [`Tracker`]: frame after frame |
//! | `estimate` | [`FrameEstimate`]: what it found in one; [`Track`] of all |
//! | `motion` | [`Motion`]: how motion is carried from frame to frame: not at all, by velocity, by a Kalman filter |
//! | `lost` | [`Lost`]: noticing that a track was lost |
//! | `smoothing` | [`smoothed`]: what later frames say of earlier ones |
//! | [`join`](mod@join) | two tracks of the same frames, one forwards and one backwards, made one |

mod estimate;
pub mod join;
mod lost;
mod motion;
mod smoothing;
mod tracker;

pub use estimate::{FrameEstimate, Track};
pub use lost::{LOST_ABOVE_RMS_RATIO, LOST_BELOW_IOU, Lost};
pub use motion::{FrameBelief, KalmanOptions, Motion, Predicted};
pub use smoothing::smoothed;
pub use tracker::{SEARCH_BELOW_IOU, Tracker, WhenToSearch};
