//! The laboratory: several ways to fit, from one start, side by side. Nothing here is saved or undone.

pub(crate) mod check;
mod commands;
pub(crate) mod comparison;
mod job;
pub(crate) mod lineup;
mod panel;
pub(crate) mod push;
pub(crate) mod start;
#[cfg(test)]
mod tests;
mod update;

use backlit_document::run::RunStep;
use backlit_jobs::Task;
use backlit_take::demonstration::Demonstration;
use backlit_tracking::body::{Model, Pose};

pub(crate) use check::{Checked, Worst};
pub use comparison::{Basis, Comparison, Contestant};
use job::{DrawingMessage, LaboratoryMessage, Lacking, Racing};
pub use lineup::{Entrant, Lineup};
pub(crate) use push::{Push, PushAxis, Pushed};
pub(crate) use start::StartChoice;

use crate::context::file_dialog::FileDialogs;
use crate::context::priority;

/// What is chosen in its layout.
#[derive(Debug, Clone, Copy, Default)]
pub struct LaboratoryChoices {
    /// What is compared.
    pub lineup: Lineup,
    pub(crate) start: StartChoice,
    /// Along which motion pushes are shown; what suits the body until it is chosen.
    axis: Option<PushAxis>,
    /// The camera whose pictures are shown.
    pub camera: usize,
    /// Whether the plot's heights are logarithmic.
    pub is_log: bool,
    /// The fit whose worst pixel is marked.
    pub marked: Option<usize>,
}

impl LaboratoryChoices {
    /// The motion along which pushes are shown.
    fn axis_for(&self, model: &Model) -> PushAxis {
        self.axis.unwrap_or_else(|| PushAxis::of(model))
    }
}

/// The feature.
#[derive(Debug, Default)]
pub struct Laboratory {
    /// What is chosen.
    pub choices: LaboratoryChoices,
    /// The comparison, once it has begun.
    pub comparison: Option<Comparison>,
    /// Time of the last step of every fit, in seconds.
    pub(crate) step_seconds: Option<f64>,
    comparisons: u64,
    /// Whether the comparison is to run as soon as it has begun.
    wants_run: bool,
    /// Steps that were asked for while one was being made.
    pending_steps: usize,
    fits: Vec<Racing>,
    steps: Task<(), LaboratoryMessage, { priority::LABORATORY }>,
    looks: Task<Lacking, DrawingMessage, { priority::LABORATORY_LOOK }>,
    /// Known by the fits and poses whose gradients are checked.
    checks: Task<Vec<(usize, Pose)>, (usize, Checked), { priority::LABORATORY_CHECK }>,
    dialogs: FileDialogs<()>,
}

impl Laboratory {
    /// A take was opened: its comparison begins as its demonstration does, if it is one.
    pub(crate) fn begin_with(&mut self, demonstration: Option<Demonstration>) {
        self.choices.start = StartChoice::of(demonstration);
    }

    pub(crate) fn is_running(&self) -> bool {
        self.steps.is_busy()
    }

    /// Whether the last check of gradients broke down.
    fn check_broke_down(&self) -> bool {
        self.checks.failure().is_some()
    }

    /// The comparison, where there is something of it to be seen.
    fn begun(&self) -> Option<&Comparison> {
        self.comparison.as_ref().filter(|comparison| comparison.has_begun())
    }

    /// The time of one step of all fits together, from their newest ones.
    fn measure_steps(&mut self) {
        let newest = |steps: &Vec<RunStep>| steps.iter().skip(1).next_back().map(|step| step.seconds);
        let seconds = self.comparison.iter().flat_map(|comparison| &comparison.contestants);
        let seconds: Vec<f64> = seconds.filter_map(|fit| newest(&fit.steps)).collect();
        self.step_seconds = (!seconds.is_empty()).then(|| seconds.iter().sum());
    }
}
