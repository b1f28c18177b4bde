//! The laboratory's work: fits that are stepped together, their pictures, their gradients' check, and the plot's
//! file.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use backlit_formats::images;
use backlit_tracking::body::Pose;
use backlit_tracking::fit::Fit;
use image::DynamicImage;
use rayon::prelude::*;

use crate::context::write_advice::remedy;
use crate::document::run::{RunEnding, RunStep};
use crate::drawing::plot::Figure;
use crate::features::fit::job::{ending_of, run_step};
use crate::features::laboratory::comparison::PushKey;
use crate::features::laboratory::{CheckProgress, ColumnCheck, Push, Pushed};
use crate::session::Extent;
use crate::session::prediction::{CameraPrediction, FitInputs, Predicted};
use crate::style::theme::Theme;
use crate::worker::{Event, Job, Outbox, Step};

/// Columns of a gradient that are checked at once.
const COLUMNS_A_STEP: usize = 8;
/// The level of the background, and from where on a pixel is hardly anything else.
const BACKGROUND: f32 = 255.0;
const NEARLY_BACKGROUND: f32 = 250.0;

/// What the laboratory's jobs say. Numbers in front are those of the fits.
#[derive(Debug)]
pub enum LaboratoryEvent {
    /// A step of a fit; the first is the start.
    Step(usize, Box<RunStep>, Arc<Predicted>),
    /// Where data and start of a fit are, by camera.
    Extents(Vec<Option<Extent>>),
    /// A fit has ended by itself, or could not begin.
    Ended(usize, RunEnding),
    /// The picture of the step that is looked at.
    Looked(usize, Arc<Predicted>),
    /// What pushes at the start, of all fits.
    Pushed(PushKey, Vec<Pushed>),
    /// How far the check of a fit's gradient has come.
    Checked {
        /// The fit.
        index: usize,
        /// The pose.
        pose: Pose,
        /// What was found so far.
        progress: CheckProgress,
    },
    /// The plot was written.
    Written(PathBuf),
}

/// Fits that wait for their next step. The job puts them back when it has done its steps.
pub type LiveLaboratory = Arc<Mutex<Vec<Racing>>>;

/// One of the fits between two steps.
#[derive(Debug)]
pub struct Racing {
    /// `None` once it has ended.
    fit: Option<Fit>,
    scene: FitInputs,
    last: Arc<Predicted>,
    done: usize,
}

/// Steps of all fits, in turn: the one with the fewest steps is next, the first of them if there are several.
#[derive(Debug)]
pub struct LaboratoryJob {
    /// What is still to begin.
    starts: Vec<(FitInputs, Pose)>,
    live: LiveLaboratory,
    /// Steps to do; `None` runs to the end.
    steps: Option<usize>,
    /// Where to stop, once it is known.
    target: Option<usize>,
    fits: Vec<Racing>,
}

impl LaboratoryJob {
    /// Begins a comparison and makes no step yet.
    #[must_use]
    pub fn begin(mut starts: Vec<(FitInputs, Pose)>, live: LiveLaboratory) -> Self {
        starts.reverse();
        Self { starts, live, steps: Some(0), target: None, fits: Vec::new() }
    }

    /// Goes on with all fits by so many steps, or to their ends.
    #[must_use]
    pub fn go_on(live: LiveLaboratory, steps: Option<usize>) -> Self {
        let fits = std::mem::take(&mut *live.lock().unwrap_or_else(PoisonError::into_inner));
        Self { starts: Vec::new(), live, steps, target: None, fits }
    }

    fn begin_next(&mut self, scene: FitInputs, pose: &Pose, out: &Outbox<Event>) {
        let index = self.fits.len();
        let last = Arc::new(Predicted::new(&scene, pose, None));
        send(out, LaboratoryEvent::Extents(last.cameras.iter().map(extent).collect()));
        let options = (*scene.fit).clone();
        let fit = match Fit::new(scene.model.clone(), scene.views(), pose.clone(), options) {
            Ok(fit) => {
                let first = RunStep {
                    pose: pose.clone(),
                    mismatch: last.mismatch,
                    rms: last.rms.unwrap_or_default(),
                    step_norm: 0.0,
                    cost: fit.cost(),
                    trial_cost: fit.cost(),
                    foretold: 0.0,
                    fell: 0.0,
                    damping: scene.fit.damping,
                    seconds: 0.0,
                    stage: 0,
                    accepted: true,
                };
                send(out, LaboratoryEvent::Step(index, Box::new(first), last.clone()));
                Some(fit)
            }
            Err(error) => {
                send(out, LaboratoryEvent::Ended(index, RunEnding::Solver(error.to_string())));
                None
            }
        };
        self.fits.push(Racing { fit, scene, last, done: 0 });
    }

    /// The fit whose turn it is, unless all have come far enough.
    fn next(&self) -> Option<usize> {
        let going = self.fits.iter().enumerate().filter(|(_, racing)| racing.fit.is_some());
        let (index, racing) = going.min_by_key(|(index, racing)| (racing.done, *index))?;
        self.target.is_none_or(|target| racing.done < target).then_some(index)
    }

    fn end(&mut self) -> Step {
        *self.live.lock().unwrap_or_else(PoisonError::into_inner) = std::mem::take(&mut self.fits);
        Step::Done
    }
}

/// Where data or model are in a camera.
fn extent(camera: &CameraPrediction) -> Option<Extent> {
    let width = camera.prediction.width.max(1);
    let data = camera.data.as_ref().map_or(&[][..], |data| data.values());
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

fn send(out: &Outbox<Event>, event: LaboratoryEvent) {
    out.send(Event::Laboratory(Box::new(event)));
}

impl Job<Event> for LaboratoryJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if let Some((scene, pose)) = self.starts.pop() {
            self.begin_next(scene, &pose, out);
            return if self.starts.is_empty() { self.end() } else { Step::Again };
        }
        if out.cancel().is_cancelled() {
            return self.end();
        }
        if let Some(steps) = self.steps.take() {
            let going = self.fits.iter().filter(|racing| racing.fit.is_some());
            self.target = going.map(|racing| racing.done).min().map(|least| least + steps);
        }
        let Some(index) = self.next() else { return self.end() };
        let racing = &mut self.fits[index];
        let Some(fit) = &mut racing.fit else { return self.end() };
        let began = Instant::now();
        let Some(record) = fit.step() else {
            let is_annealed = racing.scene.fit.stages.len() > 1;
            let ending = fit.termination().map(|why| ending_of(why, is_annealed));
            racing.fit = None;
            send(out, LaboratoryEvent::Ended(index, ending.unwrap_or(RunEnding::Stopped)));
            return Step::Again;
        };
        let seconds = began.elapsed().as_secs_f64();
        racing.done += 1;
        if record.accepted {
            racing.last = Arc::new(Predicted::new(&racing.scene, &record.pose, Some(&racing.last)));
        }
        let step = run_step(&record, &racing.last, seconds);
        send(out, LaboratoryEvent::Step(index, Box::new(step), racing.last.clone()));
        Step::Again
    }
}

/// What the screen lacks: pictures of the step that is looked at, and what pushes at the start.
#[derive(Debug)]
pub struct LaboratoryLookJob {
    /// Fits, each with its scene, its pose, and a prediction whose data may be reused.
    pub looks: Vec<(usize, FitInputs, Pose, Option<Arc<Predicted>>)>,
    /// Which pushes, and the scenes and starts of all fits.
    pub push: Option<(PushKey, Vec<(FitInputs, Pose)>)>,
}

impl Job<Event> for LaboratoryLookJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if let Some((index, scene, pose, earlier)) = self.looks.pop() {
            let predicted = Predicted::new(&scene, &pose, earlier.as_deref());
            send(out, LaboratoryEvent::Looked(index, Arc::new(predicted)));
        } else if let Some((key, starts)) = self.push.take() {
            let (camera, axis, limb) = key;
            let look = |(scene, pose): &(FitInputs, Pose)| {
                let camera = scene.cameras.get(camera)?;
                let how = (scene.fit.renderer, scene.fit.final_ramp());
                Some(Push::new(&scene.model, pose, camera, how, (axis, limb)))
            };
            let pushes: Vec<Push> = starts.iter().filter_map(look).collect();
            send(out, LaboratoryEvent::Pushed(key, Pushed::all(pushes)));
        }
        if self.looks.is_empty() && self.push.is_none() { Step::Done } else { Step::Again }
    }
}

/// Checks the gradients of several fits in all cameras, a few columns of one of them a step: all of them come
/// on together.
#[derive(Debug)]
pub struct LaboratoryCheckJob {
    fits: Vec<FitCheck>,
}

/// The check of one fit.
#[derive(Debug)]
pub struct FitCheck {
    /// The fit.
    pub index: usize,
    /// What is to be checked, by camera, in the order in which it is.
    pub cameras: Vec<(usize, ColumnCheck)>,
    /// How far it has come.
    pub progress: CheckProgress,
}

impl FitCheck {
    /// A check of a fit in these cameras.
    #[must_use]
    pub fn new(index: usize, cameras: Vec<(usize, ColumnCheck)>) -> Self {
        let total = cameras.iter().map(|(_, check)| check.columns()).sum();
        Self { index, cameras, progress: CheckProgress { total, ..CheckProgress::default() } }
    }

    /// Compares the next columns, shared out among threads; the pose that they are of. What is found does not depend on
    /// how they are shared out.
    fn go_on(&mut self) -> Option<Pose> {
        let (_, first) = self.cameras.first()?;
        // All cameras see the same state.
        let columns = first.columns().max(1);
        let last = (self.progress.done + COLUMNS_A_STEP).min(self.progress.total);
        let compare = |at: usize| {
            let (camera, check) = self.cameras.get(at / columns)?;
            let column = at % columns;
            Some((*camera, check, column, check.compare(column, &check.analytic(column))))
        };
        let found: Vec<_> = (self.progress.done..last).into_par_iter().filter_map(compare).collect();
        for (camera, check, column, found) in found {
            self.progress.add(&found, check, (camera, column));
        }
        Some(first.pose.clone())
    }
}

impl LaboratoryCheckJob {
    /// A check of these fits.
    #[must_use]
    pub const fn new(fits: Vec<FitCheck>) -> Self {
        Self { fits }
    }
}

impl Job<Event> for LaboratoryCheckJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let going = self.fits.iter_mut().filter(|fit| !fit.progress.is_whole());
        let next = going.min_by_key(|fit| (fit.progress.done, fit.index));
        let Some(fit) = next else { return Step::Done };
        let Some(pose) = fit.go_on() else { return Step::Done };
        send(out, LaboratoryEvent::Checked { index: fit.index, pose, progress: fit.progress.clone() });
        Step::Again
    }
}

/// Writes the plot as a PNG.
#[derive(Debug)]
pub struct LaboratoryPlotJob {
    /// The plot.
    pub figure: Figure,
    /// Its colours.
    pub theme: Theme,
    /// The file.
    pub path: PathBuf,
}

impl Job<Event> for LaboratoryPlotJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let picture = DynamicImage::ImageRgba8(self.figure.picture(self.theme));
        match images::write_png(&self.path, &picture) {
            Ok(()) => send(out, LaboratoryEvent::Written(self.path.clone())),
            Err(error) => {
                let remedy = remedy(&error);
                out.send(Event::Failed(format!("The plot was not saved: {error}. {remedy}")));
            }
        }
        Step::Done
    }
}
