//! The fit of the frame on the screen: stepping, running, refitting a part.

mod job;
pub(crate) mod measurement;
pub(crate) mod refit;
pub(crate) mod renderer;
mod solver;
mod stages;
#[cfg(test)]
mod tests;
mod update;
mod variants;

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use backlit_document::history::Gesture;
use backlit_document::run::RunStep;
use backlit_jobs::Task;
use egui::Ui;
use job::{FitMessage, PausedFit};
use refit::Refitted;
use variants::VariantRun;

use crate::context::{Context, Requests, priority};
use crate::session::prediction::{FitInputs, Predicted};

#[derive(Debug, Default)]
pub(crate) struct Fit {
    task: Task<(), FitMessage, { priority::FIT }>,
    /// The run that may go on.
    live: Option<LiveRun>,
    /// The fit of that run between two steps.
    paused: Option<Box<PausedFit>>,
    /// Steps that were asked for while one was being made.
    pending_steps: usize,
    /// The gesture of what that run does to the document.
    gesture: Option<Gesture>,
    /// What that run refits, if it does.
    refitting: Option<String>,
    /// The last refit of each frame.
    refits: BTreeMap<usize, Refitted>,
    /// What is still to be run from one start, to be compared.
    again: VecDeque<VariantRun>,
    /// Whether the stages are open to be edited.
    edits_stages: bool,
    /// Time of the last step, in seconds.
    pub(crate) step_seconds: Option<f64>,
}

/// The run that may go on: what it depends on, and how far it is.
#[derive(Debug)]
struct LiveRun {
    number: usize,
    frame: usize,
    inputs: FitInputs,
    before: f64,
    /// Accepted and rejected steps.
    steps: usize,
    /// The last of them, or the start, with what it predicts.
    last: Option<(RunStep, Arc<Predicted>)>,
    /// The solver itself has ended it: there are no more steps.
    is_over: bool,
    /// It is to be compared with others: the body stays as it was.
    is_comparison: bool,
}

impl Fit {
    /// The section of the solver, with what else it holds at its end.
    pub(crate) fn solver_section(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        requests: &mut Requests,
        open: bool,
        more: impl FnOnce(&mut Ui, &mut Requests),
    ) {
        solver::ui(ui, context, requests, (open, &mut self.edits_stages), more);
    }

    pub(crate) const fn is_running(&self) -> bool {
        self.task.is_busy()
    }

    /// The number of the run whose steps are being made.
    pub(crate) fn fitted_run(&self) -> Option<usize> {
        self.live.as_ref().filter(|_| self.is_running()).map(|live| live.number)
    }
}
