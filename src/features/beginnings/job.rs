//! The runs, one method a step of the pool, and what each led to.

use std::sync::Arc;

use backlit_jobs::{Job, Outbox, Turn};
use backlit_runs::initialisation::{InitialisationMessage, InitialisationOutcome, InitialisationRun};
use backlit_tracking::initialisation::InitialisationMethod as Method;

use super::record::{Recorder, ShownAttempt};
use crate::session::prediction::{FitInputs, Predicted};

/// What the job says.
#[derive(Debug)]
pub(super) enum BeginningMessage {
    /// A method begins.
    Begun(Method),
    /// It has come by a pose.
    Ended(Method, Box<Outcome>),
    /// It leads nowhere; why.
    Failed(Method, String),
}

/// What a method led to.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    /// All that it did; never empty.
    pub(super) steps: Vec<ShownAttempt>,
    /// Mismatch of the pose, as the window measures every pose.
    pub(super) cost: f64,
    pub(super) iou: Option<f64>,
    /// Evaluations of Λ, where they are counted.
    pub(super) evaluations: Option<usize>,
    pub(super) seconds: f64,
    /// Mean distance of the joints from the take's reference.
    pub(super) error_mm: Option<f64>,
}

/// Methods to be tried.
#[derive(Debug)]
pub(super) struct BeginJob {
    pub(super) run: InitialisationRun,
    pub(super) inputs: FitInputs,
}

impl Job<BeginningMessage> for BeginJob {
    fn step(&mut self, out: &Outbox<BeginningMessage>) -> Turn {
        let (model, inputs) = (Arc::clone(&self.run.model), &self.inputs);
        let mut recorder = None;
        let goes_on = self.run.step(out.cancel(), &mut |message| match message {
            InitialisationMessage::Begun(method) => {
                recorder = Some(Recorder::new(method, &model));
                out.send(BeginningMessage::Begun(method));
            }
            InitialisationMessage::Attempt(attempt) => {
                if let Some(recorder) = &mut recorder {
                    recorder.record(attempt);
                }
            }
            InitialisationMessage::Ended(method, outcome) => {
                if let Some(recorder) = recorder.take() {
                    let outcome = measured(inputs, outcome, recorder);
                    out.send(BeginningMessage::Ended(method, Box::new(outcome)));
                }
            }
            InitialisationMessage::Failed(method, why) => out.send(BeginningMessage::Failed(method, why)),
        });
        if goes_on { Turn::Again } else { Turn::Done }
    }
}

/// The figures of where a method ended, as the window measures every pose.
fn measured(inputs: &FitInputs, outcome: InitialisationOutcome, mut recorder: Recorder) -> Outcome {
    let InitialisationOutcome { result, pose, seconds, error_mm } = outcome;
    recorder.end(&pose);
    let inputs = FitInputs { model: result.model, ..inputs.clone() };
    let predicted = Predicted::new(&inputs, &pose, None);
    let (cost, iou) = (predicted.mismatch, predicted.iou());
    Outcome { steps: recorder.steps, cost, iou, evaluations: result.evaluations, seconds, error_mm }
}
