//! The fit of one frame, one iteration a step.

use std::sync::Arc;
use std::time::Instant;

use backlit_document::run::{RunEnding, RunStep};
use backlit_jobs::{Job, Outbox, Turn};
use backlit_tracking::body::Pose;
use backlit_tracking::fit::{Fit, FitError, FitOptions, Stage};
use backlit_ui::drawing::ViewedPicture;

use crate::session::prediction::{FitInputs, PosedInputs, Predicted};

#[derive(Debug)]
pub(super) enum FitMessage {
    /// The start or a step, with what the pose after it predicts.
    Step(Box<RunStep>, Arc<Predicted>),
    Refused(FitError),
    /// The steps are done, with the ending if there are no more to come, and the fit if it may go on.
    Paused(Option<RunEnding>, Option<Box<PausedFit>>),
}

#[derive(Debug)]
pub(super) struct FitStart {
    /// The frame's data and the choices of the fit.
    pub(super) inputs: FitInputs,
    pub(super) pose: Pose,
    /// The choices, at the scale of what is seen.
    pub(super) options: FitOptions,
    /// Rotations that may move; all of them if there is none.
    pub(super) free: Option<Vec<bool>>,
    /// Whose ramp and data its steps are measured by, where that is not its own last stage.
    pub(super) measured_by: Option<Stage>,
    /// The pictures that are made of every step, by camera.
    pub(super) views: Arc<Vec<Vec<ViewedPicture>>>,
}

/// A fit between two steps: damping and stage go on where they were.
#[derive(Debug)]
pub(super) struct PausedFit {
    fit: Fit,
    inputs: FitInputs,
    /// What its steps are measured by, where it is not that.
    measure: Option<FitInputs>,
    views: Arc<Vec<Vec<ViewedPicture>>>,
    last: Arc<Predicted>,
    /// The prediction before that: the next is drawn in its memory.
    before: Option<Arc<Predicted>>,
}

#[derive(Debug)]
pub(super) struct FitJob {
    /// Begins a new fit; otherwise the one that runs goes on.
    pub(super) start: Option<FitStart>,
    pub(super) fit: Option<Box<PausedFit>>,
    /// Steps to do; `None` runs to the end.
    pub(super) left: Option<usize>,
}

impl FitJob {
    fn pause(&mut self, out: &Outbox<FitMessage>, ending: Option<RunEnding>) -> Turn {
        let mut fit = self.fit.take().filter(|paused| paused.fit.termination.is_none());
        fit.iter_mut().for_each(|paused| paused.before = None);
        out.send(FitMessage::Paused(ending, fit));
        Turn::Done
    }
}

impl FitStart {
    fn begin(self, out: &Outbox<FitMessage>) -> Result<PausedFit, FitError> {
        let Self { inputs, pose, options, free, measured_by, views } = self;
        let fit = Fit::with_free_rotations(inputs.model.clone(), inputs.views(), pose, options, free)?;
        let posed = PosedInputs { inputs: inputs.clone(), pose: fit.pose().clone() };
        let last = Arc::new(Predicted::with_pictures(&posed, &views, None, None));
        let first = last.start_of(&fit);
        let measure = measured_by.map(|stage| {
            let fit = FitOptions { stages: vec![stage], ..(*inputs.fit).clone() };
            FitInputs { fit: Arc::new(fit), ..inputs.clone() }
        });
        let running = PausedFit { fit, inputs, measure, views, last, before: None };
        running.send(first, out);
        Ok(running)
    }
}

impl PausedFit {
    /// Sends a step that ends at what was predicted last, measured as the other runs of its frame are.
    fn send(&self, mut step: RunStep, out: &Outbox<FitMessage>) {
        if let Some(measure) = &self.measure {
            let measured = measure.measure(&self.last.pose);
            (step.mismatch, step.rms) = (measured.mismatch, measured.rms.unwrap_or_default());
        }
        out.send(FitMessage::Step(Box::new(step), self.last.clone()));
    }
}

impl Job<FitMessage> for FitJob {
    fn step(&mut self, out: &Outbox<FitMessage>) -> Turn {
        if let Some(start) = self.start.take() {
            match start.begin(out) {
                Ok(begun) => self.fit = Some(Box::new(begun)),
                Err(error) => {
                    out.send(FitMessage::Refused(error));
                    return Turn::Done;
                }
            }
        }
        if out.cancel().is_cancelled() {
            return self.pause(out, Some(RunEnding::Stopped));
        }
        if self.left == Some(0) {
            return self.pause(out, None);
        }
        let Some(running) = &mut self.fit else { return self.pause(out, Some(RunEnding::Stopped)) };
        let began = Instant::now();
        let Some(record) = running.fit.step() else {
            let is_annealed = running.inputs.fit.stages.len() > 1;
            let ending = running.fit.termination.map(|why| RunEnding::of(why, is_annealed));
            return self.pause(out, Some(ending.unwrap_or(RunEnding::Stopped)));
        };
        let seconds = began.elapsed().as_secs_f64();
        if record.accepted {
            let posed = PosedInputs { inputs: running.inputs.clone(), pose: record.point.clone() };
            let spare = running.before.take().and_then(Arc::into_inner);
            let new = Predicted::with_pictures(&posed, &running.views, Some(&running.last), spare);
            running.before = Some(std::mem::replace(&mut running.last, Arc::new(new)));
        }
        let step = running.last.step_of(record, seconds);
        running.send(step, out);
        self.left = self.left.map(|left| left.saturating_sub(1));
        Turn::Again
    }
}
