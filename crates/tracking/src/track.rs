//! Following frames: each fit starts where the motion so far leads.

#[doc(inline)]
pub use crate::{cues, filter};

mod beam;
mod certainty;
mod estimate;
mod extent;
pub mod join;
mod lost;
mod memory;
mod motion;
mod patience;
mod rewind;
mod smoothing;
mod tracker;
mod trust;
mod tune;

pub use beam::{Beam, Mode, Rival};
pub use estimate::{FrameEstimate, Track, overlaps};
pub use lost::{LOST_ABOVE_RMS_RATIO, LOST_BELOW_IOU, Lost, UsualCost};
pub use memory::{FilterMemory, LastFrame, MemoryError, TrackerMemory, WaitingFrame};
pub use motion::{
    Begins, FrameBelief, FrameMeasurement, KalmanOptions, Motion, MotionError, MotionModel, Predicted,
};
pub use patience::Patience;
pub use rewind::{REWOUND_FRAMES, Rewind};
pub use smoothing::{Smoother, SmoothingError, WHOLE_LAG, smoothed};
pub use tracker::{SEARCH_BELOW_IOU, Tracker, WhenToSearch};
pub use tune::{Tuned, tune};
