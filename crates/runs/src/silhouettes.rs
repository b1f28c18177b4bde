//! How good the silhouettes of a take are: which are worst, and which settings make cameras and body agree best.

mod settings;
#[cfg(test)]
mod tests;
mod tune;
mod worst;

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::fit::FitOptions;

pub use settings::{changes, with_changes};
pub use tune::{Agreement, TuneError, TunedSettings, tune};
pub use worst::{SilhouetteQuality, worst};

/// A body whose pose is known in some frames.
#[derive(Debug, Clone)]
pub struct PosedBody {
    /// The body.
    pub model: Arc<Model>,
    /// How it is fitted.
    pub fit: Arc<FitOptions>,
    /// Its poses, by frame.
    pub poses: BTreeMap<usize, Pose>,
}
