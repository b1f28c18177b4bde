//! Ways to begin: where a fit may start when the pose is hardly known or not at all, each played step by step, in a table beside
//! one another; and a body acquired from nothing. Nothing here is saved; what is taken is an edit like any other.
//!
//! The ways are the lab's (`backlit_lab::experiment::begin`), the same that `backlit experiment begin` counts.
//!
//! | file | holds |
//! |---|---|
//! | `way` | [`Way`]: which there are, and what is said of each |
//! | `record` | a way's steps as bodies to draw and words |
//! | `growth` | the same of a body that grows |
//! | `job` | the runs, one a step of the pool; what each led to |
//! | `update` | begun, stopped, played, taken |
//! | `panel` | the pane |

mod growth;
mod job;
mod panel;
mod record;
#[cfg(test)]
mod tests;
mod update;
mod way;

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_jobs::Task;
use backlit_tracking::body::Pose;
use backlit_ui::drawing::Ghosts;

use crate::context::priority;
use crate::session::prediction::FitInputs;
use job::{Found, Outcome};
use way::Way;

/// What all runs are about.
#[derive(Debug, Clone)]
struct About {
    frame: usize,
    inputs: FitInputs,
    /// Where they begin; `None` where nothing is known.
    start: Option<Pose>,
}

/// A step that is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct At {
    way: Way,
    step: usize,
}

/// The feature.
#[derive(Debug, Default)]
pub(crate) struct Beginnings {
    task: Task<(), Found, { priority::BASIN }>,
    about: Option<About>,
    /// What each way led to, or why it led nowhere.
    ended: BTreeMap<Way, Result<Arc<Outcome>, String>>,
    running: Option<Way>,
    /// Whether ways begin without a start.
    no_start: bool,
    at: Option<At>,
    /// Whether its step is drawn in views and scene, in the place of the pose.
    is_shown: bool,
    /// When the next step is played, seconds.
    plays: Option<f64>,
    drawn: Option<(At, Arc<Ghosts>)>,
    /// All are tried as soon as the frame is read.
    waits: bool,
}

impl Beginnings {
    /// Whether a way is being tried.
    pub(crate) const fn is_running(&self) -> bool {
        self.task.is_busy()
    }

    /// What the way that is looked at led to.
    fn outcome(&self) -> Option<&Arc<Outcome>> {
        self.ended.get(&self.at?.way)?.as_ref().ok()
    }
}
