//! Ways to begin: where a fit may start when the pose is hardly known or not at all, each played step by step, in a table beside
//! one another; and a body acquired from nothing. Nothing here is saved; what is taken is an edit like any other.
//!
//! The methods are the core's (`backlit_tracking::initialisation`), the same that `backlit experiment begin` counts.

mod panel;
mod record;
#[cfg(test)]
mod tests;
mod update;

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_jobs::Task;
use backlit_tracking::body::Pose;
use backlit_tracking::initialisation::InitialisationMethod as Method;
use backlit_ui::drawing::Ghosts;

use crate::context::priority;
use crate::session::prediction::FitInputs;
use update::{BeginningMessage, Outcome};

/// The methods that are compared with one another, in the order of their rows.
const COMPARED: [Method; 5] =
    [Method::Particles, Method::Ramp, Method::Templates, Method::Search, Method::Report];

struct MethodWords {
    name: &'static str,
    /// In the middle of a sentence.
    lower_case: &'static str,
    /// One sentence about what it does, without its full stop.
    explanation: &'static str,
}

impl MethodWords {
    const fn of(method: Method) -> Self {
        let (name, lower_case, explanation) = match method {
            Method::Particles => (
                "Particle filter",
                "the particle filter",
                "Hundreds of bodies are moved at random and weighed by how well they explain the silhouettes; the heaviest \
                 have children. First the trunk, then every arm, leg and the head",
            ),
            Method::Ramp => (
                "Softened ramp",
                "the softened ramp",
                "The fit goes downhill on wide, soft outlines, which become sharp step by step",
            ),
            Method::RampAlone => (
                "Softened ramp alone",
                "the softened ramp alone",
                "The fit of the 2004 report on outlines that are wide and soft at first, and nothing else changed",
            ),
            Method::Templates => (
                "Templates",
                "templates",
                "A ball finds the head, a capsule hangs from it and turns to the middle of its pixels, then limb after limb. \
                 The start plays no part",
            ),
            Method::Search => (
                "Search",
                "the search",
                "The program's own: fits from many places, with arms, legs and head found again",
            ),
            Method::Report => {
                ("Report 2004", "the way of 2004", "The fit of the 2004 report goes downhill, as it was")
            }
            Method::Body => (
                "Acquired body",
                "a body from nothing",
                "Nothing is known, the person's size neither: the search finds the pose of a scaled body, then every limb \
                 shrinks until it holds no background and grows until background enters",
            ),
        };
        Self { name, lower_case, explanation }
    }
}

/// The frame that all runs are about.
#[derive(Debug, Clone)]
struct InitialisedFrame {
    frame: usize,
    inputs: FitInputs,
    /// Where they begin; `None` where nothing is known.
    start: Option<Pose>,
}

/// A step that is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct AttemptIndex {
    method: Method,
    step: usize,
}

#[derive(Debug, Default)]
pub(crate) struct Beginnings {
    task: Task<(), BeginningMessage, { priority::BASIN }>,
    about: Option<InitialisedFrame>,
    /// What each way led to, or why it led nowhere.
    ended: BTreeMap<Method, Result<Arc<Outcome>, String>>,
    running: Option<Method>,
    /// Whether ways begin without a start.
    no_start: bool,
    at: Option<AttemptIndex>,
    /// Whether its step is drawn in views and scene, in the place of the pose.
    is_shown: bool,
    /// When the next step is played, seconds.
    plays: Option<f64>,
    drawn: Option<(AttemptIndex, Arc<Ghosts>)>,
    /// All are tried as soon as the frame is read.
    waits: bool,
}

impl Beginnings {
    pub(crate) const fn is_running(&self) -> bool {
        self.task.is_busy()
    }

    /// What the way that is looked at led to.
    fn outcome(&self) -> Option<&Arc<Outcome>> {
        self.ended.get(&self.at?.method)?.as_ref().ok()
    }
}
