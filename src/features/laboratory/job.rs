//! The laboratory's work: fits that are stepped together, and their pictures.

use std::sync::Arc;
use std::time::Instant;

use backlit_document::run::{RunEnding, RunStep};
use backlit_jobs::{Job, Outbox, Turn};
use backlit_tracking::body::Pose;
use backlit_tracking::fit::Fit;

use super::comparison::PushKey;
use super::{Comparison, Push, Pushed};
use crate::session::Extent;
use crate::session::prediction::{CameraPrediction, FitInputs, Predicted};

/// The level of the background, and from where on a pixel is hardly anything else.
const BACKGROUND: f32 = 255.0;
const NEARLY_BACKGROUND: f32 = 250.0;

/// What comes of stepping. Numbers in front are those of the fits.
#[derive(Debug)]
pub(super) enum LaboratoryMessage {
    /// A step of a fit; the first is the start.
    Step(usize, Box<RunStep>, Arc<Predicted>),
    /// Where data and start of a fit are, by camera.
    Extents(Vec<Option<Extent>>),
    /// A fit has ended by itself, or could not begin.
    Ended(usize, RunEnding),
    /// The steps are done, and all fits wait for their next one.
    Waiting(Vec<Racing>),
}

#[derive(Debug)]
pub(super) enum DrawingMessage {
    /// What a fit predicts at the step that is looked at.
    Step(usize, Arc<Predicted>),
    /// What pushes at the start, of all fits.
    Pushes(PushKey, Vec<Pushed>),
}

/// Pictures that the screen lacks.
#[derive(Debug, PartialEq)]
pub(super) struct Lacking {
    /// Fits, with the poses of the step that is looked at.
    pub(super) steps: Vec<(usize, Pose)>,
    pub(super) push: Option<PushKey>,
}

/// One of the fits between two steps.
#[derive(Debug)]
pub(super) struct Racing {
    /// `None` once it has ended.
    fit: Option<Fit>,
    last: Arc<Predicted>,
    done: usize,
}

/// Steps of all fits, in turn: the one with the fewest steps is next, the first of them if there are several.
#[derive(Debug)]
pub(super) struct StepJob {
    /// What is still to begin.
    starts: Vec<(FitInputs, Pose)>,
    /// Steps to do, until the target is known; `None` runs to the end.
    steps: Option<usize>,
    /// Where to stop, once it is known.
    target: Option<usize>,
    fits: Vec<Racing>,
}

impl StepJob {
    /// Begins a comparison and makes no step yet.
    pub(super) fn begin(mut starts: Vec<(FitInputs, Pose)>) -> Self {
        starts.reverse();
        Self { starts, steps: Some(0), target: None, fits: Vec::new() }
    }

    /// Goes on with all fits by this many steps, or to their ends.
    pub(super) fn go_on(fits: Vec<Racing>, steps: Option<usize>) -> Self {
        Self { starts: Vec::new(), steps, target: None, fits }
    }

    fn begin_next(&mut self, scene: FitInputs, pose: &Pose, out: &Outbox<LaboratoryMessage>) {
        let index = self.fits.len();
        let last = Arc::new(Predicted::new(&scene, pose, None));
        out.send(LaboratoryMessage::Extents(last.cameras.iter().map(extent).collect()));
        let options = (*scene.fit).clone();
        let fit = match Fit::new(scene.model.clone(), scene.views(), pose.clone(), options) {
            Ok(fit) => {
                out.send(LaboratoryMessage::Step(index, Box::new(last.start_of(&fit)), last.clone()));
                Some(fit)
            }
            Err(error) => {
                out.send(LaboratoryMessage::Ended(index, RunEnding::Solver(error.to_string())));
                None
            }
        };
        self.fits.push(Racing { fit, last, done: 0 });
    }

    /// The fit whose turn it is, unless all have come far enough.
    fn next(&self) -> Option<usize> {
        let going = self.fits.iter().enumerate().filter(|(_, racing)| racing.fit.is_some());
        let (index, racing) = going.min_by_key(|(index, racing)| (racing.done, *index))?;
        self.target.is_none_or(|target| racing.done < target).then_some(index)
    }

    fn end(&mut self, out: &Outbox<LaboratoryMessage>) -> Turn {
        out.send(LaboratoryMessage::Waiting(std::mem::take(&mut self.fits)));
        Turn::Done
    }
}

/// Where data or model are in a camera.
fn extent(camera: &CameraPrediction) -> Option<Extent> {
    let width = camera.prediction.width.max(1);
    let data = camera.data.as_ref().map_or(&[][..], |data| data.measurement().values());
    let mut found: Option<Extent> = None;
    for (index, level) in camera.prediction.lambda.iter().enumerate() {
        if level.min(*data.get(index).unwrap_or(&BACKGROUND)) < NEARLY_BACKGROUND {
            let [x, y] = [(index % width) as f32, (index / width) as f32];
            let [left, top, right, bottom] = found.unwrap_or([x, y, x, y]);
            found = Some([left.min(x), top.min(y), right.max(x), bottom.max(y)]);
        }
    }
    found
}

impl Job<LaboratoryMessage> for StepJob {
    fn step(&mut self, out: &Outbox<LaboratoryMessage>) -> Turn {
        if let Some((scene, pose)) = self.starts.pop() {
            self.begin_next(scene, &pose, out);
            return if self.starts.is_empty() { self.end(out) } else { Turn::Again };
        }
        if out.cancel().is_cancelled() {
            return self.end(out);
        }
        if let Some(steps) = self.steps.take() {
            let going = self.fits.iter().filter(|racing| racing.fit.is_some());
            self.target = going.map(|racing| racing.done).min().map(|least| least + steps);
        }
        let Some(index) = self.next() else { return self.end(out) };
        let racing = &mut self.fits[index];
        let Some(fit) = &mut racing.fit else { return self.end(out) };
        let began = Instant::now();
        let Some(record) = fit.step() else {
            let is_annealed = racing.last.scene.fit.stages.len() > 1;
            let ending = fit.termination.map(|why| RunEnding::of(why, is_annealed));
            racing.fit = None;
            out.send(LaboratoryMessage::Ended(index, ending.unwrap_or(RunEnding::Stopped)));
            return Turn::Again;
        };
        let seconds = began.elapsed().as_secs_f64();
        racing.done += 1;
        if record.accepted {
            let last = &racing.last;
            racing.last = Arc::new(Predicted::new(&last.scene, &record.point, Some(last)));
        }
        let step = racing.last.step_of(record, seconds);
        out.send(LaboratoryMessage::Step(index, Box::new(step), racing.last.clone()));
        Turn::Again
    }
}

/// Draws what the screen lacks: pictures of the step that is looked at, and what pushes at the start.
pub(super) fn draw(comparison: &Comparison, lacking: &Lacking) -> impl Job<DrawingMessage> + use<> {
    // Each with its scene, its pose, and a prediction whose data may be reused.
    let step = |(index, pose): &(usize, Pose)| {
        let fit = comparison.contestants.get(*index)?;
        Some((*index, fit.scene.clone(), pose.clone(), fit.shown.clone()))
    };
    let mut steps: Vec<_> = lacking.steps.iter().filter_map(step).collect();
    let starts = comparison.contestants.iter();
    let starts = starts.map(|fit| (fit.scene.clone(), comparison.basis.start.clone()));
    let mut push: Option<(PushKey, Vec<(FitInputs, Pose)>)> = lacking.push.map(|key| (key, starts.collect()));
    move |out: &Outbox<DrawingMessage>| {
        if let Some((index, scene, pose, earlier)) = steps.pop() {
            let predicted = Predicted::new(&scene, &pose, earlier.as_deref());
            out.send(DrawingMessage::Step(index, Arc::new(predicted)));
        } else if let Some((key, starts)) = push.take() {
            let pushes = starts.iter().filter_map(|(scene, pose)| Push::new(scene, pose, key));
            out.send(DrawingMessage::Pushes(key, Pushed::all(pushes.collect())));
        }
        if steps.is_empty() && push.is_none() { Turn::Done } else { Turn::Again }
    }
}
