//! The fit of the frame on the screen: stepping, running, refitting a part.
//!
//! | file | holds |
//! |---|---|
//! | `update` | begun, gone on with, its steps taken in, stopped |
//! | `job` | the fit, one iteration a step |
//! | `part` | which rotations a refit may move |
//! | `unavailable` | why a command cannot be used now |
//! | `refit`, [`refitted`] | the section of that name, and what the last refit has done |
//! | `solver`, `renderer`, `measurement` | the sections of those names |

mod job;
pub(crate) mod measurement;
mod part;
mod refit;
pub(crate) mod refitted;
pub(crate) mod renderer;
pub(crate) mod solver;
#[cfg(test)]
mod tests;
mod unavailable;
mod update;

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_jobs::{Priority, Task};
use job::{Fitted, Running};
use refitted::Refitted;

use crate::document::history::Gesture;
use crate::document::run::RunStep;
use crate::session::prediction::{FitInputs, Predicted};

/// The feature.
#[derive(Debug)]
pub(crate) struct Fit {
    task: Task<(), Fitted>,
    /// The run that may go on.
    live: Option<LiveRun>,
    /// The fit of that run between two steps.
    running: Option<Box<Running>>,
    /// Steps that were asked for while one was being made.
    pending_steps: usize,
    /// The gesture of what that run does to the document.
    gesture: Option<Gesture>,
    /// What that run refits, if it does.
    refitting: Option<String>,
    /// The last refit of each frame.
    refits: BTreeMap<usize, Refitted>,
    /// Time of the last step, in seconds.
    pub(crate) step_seconds: Option<f64>,
}

/// The run that may go on: what it depends on, and how far it is.
#[derive(Debug)]
struct LiveRun {
    number: usize,
    frame: usize,
    inputs: FitInputs,
    /// The mismatch of its start.
    before: f64,
    /// Accepted and rejected steps.
    steps: usize,
    /// The last of them, or the start, with what it predicts.
    last: Option<(RunStep, Arc<Predicted>)>,
    /// The solver itself has ended it: there are no more steps.
    is_over: bool,
}

impl Default for Fit {
    fn default() -> Self {
        Self {
            task: Task::new(Priority::FIT),
            live: None,
            running: None,
            pending_steps: 0,
            gesture: None,
            refitting: None,
            refits: BTreeMap::new(),
            step_seconds: None,
        }
    }
}

impl Fit {
    /// The same without any work that is going on, for a picture of it.
    pub(crate) fn at_rest(&self) -> Self {
        Self { refits: self.refits.clone(), step_seconds: self.step_seconds, ..Self::default() }
    }

    /// Another take is open: all of it was about the old one.
    pub(crate) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Whether steps are being made.
    pub(crate) const fn is_running(&self) -> bool {
        self.task.is_busy()
    }

    /// The number of the run whose steps are being made.
    pub(crate) fn fitted_run(&self) -> Option<usize> {
        self.live.as_ref().filter(|_| self.is_running()).map(|live| live.number)
    }
}
