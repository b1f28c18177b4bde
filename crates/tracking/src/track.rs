//! Following frames: each fit starts where the motion so far leads.
//!
//! | file | holds |
//! |---|---|
//! | `tracker` | [`Tracker`]: frame after frame |
//! | `attempt` | a fit of a frame, before it is taken for its pose |
//! | `cued` | the cues of the frame that is being tracked |
//! | `frame_masks` | what a frame's cameras saw, kept until its fit is judged |
//! | `estimate` | [`FrameEstimate`]: what it found in one; [`Track`] of all |
//! | `motion` | [`Motion`]: how motion is carried from frame to frame: not at all, by velocity, by a Kalman filter |
//! | `lost` | [`Lost`]: noticing that a track was lost |
//! | `smoothing` | [`smoothed`]: what later frames say of earlier ones; [`Smoother`]: frame after frame, some frames late, in bounded memory |
//! | `memory` | [`TrackerMemory`]: what a tracker knows after a frame, to go on from another day |
//! | `tune` | [`tune()`]: the filter's noise, from innovations |
//! | [`join`](mod@join) | two tracks of the same frames, one forwards and one backwards, made one |

#[doc(inline)]
pub use crate::{cues, filter};

mod attempt;
mod cued;
mod estimate;
mod frame_masks;
pub mod join;
mod last_frame;
mod lost;
mod memory;
mod motion;
mod smoothing;
mod tracker;
mod tune;

pub use estimate::{FrameEstimate, Track};
pub use last_frame::LastFrame;
pub use lost::{LOST_ABOVE_RMS_RATIO, LOST_BELOW_IOU, LastResort, Lost, UsualCost};
pub use memory::{FilterMemory, MemoryError, TrackerMemory, WaitingFrame};
pub use motion::{Begins, FrameBelief, KalmanOptions, Motion, MotionError, Predicted, Seen};
pub use smoothing::{Smoother, SmoothingError, WHOLE_LAG, smoothed};
pub use tracker::{SEARCH_BELOW_IOU, Tracker, WhenToSearch};
pub use tune::{Tuned, tune};
