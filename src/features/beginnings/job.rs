//! The runs, one way a step of the pool, and what each led to.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use backlit_formats::Footage;
use backlit_jobs::{Job, Outbox, Turn};
use backlit_lab::experiment::ExperimentError;
use backlit_lab::experiment::begin::{Beginning, Options, begin_watched};
use backlit_tracking::acquisition::{AcquireError, AcquireOptions, acquire};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::metrics::JointErrors;

use super::About;
use super::growth;
use super::record::{Recorder, Step};
use super::way::Way;
use crate::session::prediction::{FitInputs, Predicted};

/// What the job says.
#[derive(Debug)]
pub(super) enum Found {
    /// A way begins.
    Begun(Way),
    /// It has led somewhere.
    Ended(Way, Box<Outcome>),
    /// It leads nowhere; why.
    Nowhere(Way, String),
}

/// What a way led to.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    /// All that it did; never empty.
    pub(super) steps: Vec<Step>,
    /// Mismatch of the pose, as the window measures every pose.
    pub(super) cost: f64,
    pub(super) iou: Option<f64>,
    /// Evaluations of Λ, where they are counted.
    pub(super) evaluations: Option<usize>,
    pub(super) seconds: f64,
    /// Mean distance of the joints from the take's reference.
    pub(super) error_mm: Option<f64>,
}

/// Ways to be tried.
#[derive(Debug)]
pub(super) struct BeginJob {
    pub(super) about: About,
    pub(super) footage: Arc<Footage>,
    pub(super) ways: VecDeque<Way>,
}

/// Where a way ended.
struct End {
    model: Arc<Model>,
    pose: Pose,
    steps: Vec<Step>,
    evaluations: Option<usize>,
}

impl Job<Found> for BeginJob {
    fn step(&mut self, out: &Outbox<Found>) -> Turn {
        let Some(way) = self.ways.pop_front().filter(|_| !out.cancel().is_cancelled()) else {
            return Turn::Done;
        };
        out.send(Found::Begun(way));
        let began = Instant::now();
        let end = match way.method() {
            Some(_) => self.begin(way, out.cancel()),
            None => self.acquire(out.cancel()),
        };
        match end {
            _ if out.cancel().is_cancelled() => return Turn::Done,
            Ok(end) => {
                let outcome = self.judged(end, began.elapsed().as_secs_f64());
                out.send(Found::Ended(way, Box::new(outcome)));
            }
            Err(why) => out.send(Found::Nowhere(way, why.to_string())),
        }
        if self.ways.is_empty() { Turn::Done } else { Turn::Again }
    }
}

/// Why a way leads nowhere.
#[derive(Debug, thiserror::Error)]
enum Nowhere {
    #[error(transparent)]
    Begin(#[from] ExperimentError),
    #[error(transparent)]
    Acquire(#[from] AcquireError),
    #[error("the silhouettes do not meet in space")]
    Apart,
}

impl BeginJob {
    fn begin(&self, way: Way, cancel: &CancelToken) -> Result<End, Nowhere> {
        let inputs = &self.about.inputs;
        let model = &inputs.model;
        let (views, start) = (inputs.views(), self.about.start.as_ref());
        let from = Beginning { model, views: &views, start };
        let mut recorder = Recorder::new(way, model);
        let Some(method) = way.method() else { return Err(Nowhere::Apart) };
        let end = begin_watched(method, &from, &Options::default(), cancel, &mut |step| recorder.see(step))?;
        let pose = end.pose.ok_or(Nowhere::Apart)?;
        let mut steps = recorder.steps;
        // Of several starts the best is meant, not the last.
        if steps.last().is_none_or(|last| *last.pose() != pose) {
            let words = format!("The end: the best pose that {} found.", way.lower_case());
            let legend = way.name().to_owned();
            steps.push(Step { legend, ..Step::new(model, pose.clone(), words) });
        }
        Ok(End { model: Arc::clone(model), pose, steps, evaluations: Some(end.evaluations) })
    }

    fn acquire(&self, cancel: &CancelToken) -> Result<End, Nowhere> {
        let inputs = &self.about.inputs;
        let acquired = acquire(&inputs.model, &inputs.views(), &AcquireOptions::default(), cancel)?;
        let steps = growth::steps(&acquired);
        let pose = acquired.poses.into_iter().next().ok_or(Nowhere::Apart)?;
        Ok(End { model: acquired.model, pose, steps, evaluations: None })
    }

    /// The figures of where it ended.
    fn judged(&self, end: End, seconds: f64) -> Outcome {
        let inputs = FitInputs { model: Arc::clone(&end.model), ..self.about.inputs.clone() };
        let predicted = Predicted::new(&inputs, &end.pose, None);
        let reference = self.footage.take().reference();
        let error_mm = reference.and_then(|reference| {
            let mut errors = JointErrors::default();
            errors.add(&end.model, &end.pose, &reference.joints(self.about.frame));
            errors.overall().map(|all| all.mean)
        });
        Outcome {
            steps: end.steps,
            cost: predicted.mismatch,
            iou: predicted.iou(),
            evaluations: end.evaluations,
            seconds,
            error_mm,
        }
    }
}
