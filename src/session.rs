//! Everything derived from document and footage: pictures, silhouettes, predictions, runs of the fit. It can
//! be made again at any time and is never saved.

mod frames;
pub mod playback;
pub(crate) mod prediction;
pub mod selection;

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_tracking::body::Pose;

pub(crate) use frames::load_frame;
pub use frames::{FrameCache, FrameData};

use crate::document::Document;
use crate::document::run::{Run, RunStep};
use crate::features::fit::refitted::Refitted;
use crate::session::prediction::{FitInputs, Predicted};
use crate::session::selection::{Selection, StepRef};
use crate::take::footage::Footage;

/// Bounds in a camera's pictures: left, top, right, bottom, in pixels.
pub type Extent = [f32; 4];

/// The derived data.
#[derive(Debug, Clone, Default)]
pub struct Session {
    /// The take that is open.
    pub take: Option<Arc<Footage>>,
    /// Decoded frames and their silhouettes.
    pub frames: FrameCache,
    /// The silhouettes that the pose on the screen predicts. While a newer one is made, the old stays.
    pub predicted: Option<Arc<Predicted>>,
    /// Whether [`predicted`](Self::predicted) is of an older pose than the one on the screen.
    pub is_stale: bool,
    /// Runs of the fit, the newest last.
    pub runs: Vec<Run>,
    /// Runs that were begun so far: the number of the newest one.
    pub runs_begun: usize,
    /// The runs before some were removed, until that cannot be undone any more.
    pub removed: Option<RemovedRuns>,
    /// The newest run, if it may go on.
    pub live: Option<usize>,
    /// What that run depends on.
    pub live_scene: Option<FitInputs>,
    /// What the last step of that run predicts.
    pub live_prediction: Option<Arc<Predicted>>,
    /// What the run that is going on refits, if it does.
    pub refitting: Option<String>,
    /// The last refit of each frame.
    pub refits: BTreeMap<usize, Refitted>,
    /// Whether that run is being stepped right now.
    pub is_stepping: bool,
    /// The frame that was shown last: it stays until the next one is there.
    pub last_frame: Option<Arc<FrameData>>,
    /// Changes with the pictures on the screen.
    pub generation: u64,
    /// Where the subject is over the whole take, by camera.
    pub subject: Vec<Option<Extent>>,
    /// Time of the last step of a fit, in seconds.
    pub step_seconds: Option<f64>,
    /// Time of the last prediction, in seconds.
    pub predict_seconds: Option<f64>,
}

/// The runs as they were before some were removed.
#[derive(Debug, Clone, PartialEq)]
pub struct RemovedRuns {
    /// All of them, removed or not.
    pub runs: Vec<Run>,
    /// The document's revision when that was done: a later change of the document is undone first.
    pub revision: u64,
}

impl Session {
    /// Number of frames of the take, zero without one.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.take.as_ref().map_or(0, |take| take.frame_count())
    }

    /// Number of cameras, zero without a take.
    #[must_use]
    pub fn camera_count(&self) -> usize {
        self.take.as_ref().map_or(0, |take| take.cameras.len())
    }

    /// Pixels of a camera's pictures, across and down.
    #[must_use]
    pub fn camera_size(&self, camera: usize) -> Option<[usize; 2]> {
        let camera = self.take.as_ref()?.cameras.get(camera)?;
        Some([camera.width(), camera.height()])
    }

    /// The pose on the screen: that of the step that is looked at, or of the run that is going on, or the
    /// document's.
    #[must_use]
    pub fn shown_pose<'a>(&'a self, document: &'a Document, selection: &Selection) -> &'a Pose {
        let live = || {
            let run = self.runs.get(self.live.filter(|_| self.is_stepping)?)?;
            run.steps.last().filter(|_| run.frame == selection.frame)
        };
        let step = selection.step.and_then(|step| self.step(step)).or_else(live);
        step.map_or_else(|| document.pose_at(selection.frame), |step| &step.pose)
    }

    /// A frame, or the one that was shown last as long as it is not there.
    #[must_use]
    pub fn shown_frame(&self, frame: usize) -> Option<&Arc<FrameData>> {
        self.frames.get(frame).or(self.last_frame.as_ref())
    }

    /// Whether a prediction's data are those of the frame on the screen.
    #[must_use]
    pub fn is_of_shown_frame(&self, predicted: &Predicted, frame: usize) -> bool {
        let shown = self.shown_frame(frame);
        predicted.scene.frame.as_ref().zip(shown).is_some_and(|(a, b)| Arc::ptr_eq(a, b))
    }

    /// A step of a run.
    #[must_use]
    pub fn step(&self, at: StepRef) -> Option<&RunStep> {
        self.runs.get(at.run)?.steps.get(at.step)
    }

    /// The first step of an earlier run on a frame that ended at this pose, if it is not that run's start: the run's
    /// number, and the step.
    #[must_use]
    pub fn step_with_pose(&self, frame: usize, pose: &Pose) -> Option<(usize, usize)> {
        let found = |run: &Run| {
            let step = run.steps.iter().position(|step| step.pose == *pose)?;
            (step > 0).then_some((run.number, step))
        };
        self.runs.iter().filter(|run| run.frame == frame).find_map(found)
    }

    /// The first colour that no run has.
    #[must_use]
    pub fn free_colour(&self) -> usize {
        (0..).find(|colour| self.runs.iter().all(|run| run.colour != *colour)).unwrap_or_default()
    }

    /// The run that is looked at, or else the newest one of a frame.
    #[must_use]
    pub fn run_of(&self, selection: &Selection) -> Option<usize> {
        match selection.step {
            Some(step) if step.run < self.runs.len() => Some(step.run),
            _ => self.runs.iter().rposition(|run| run.frame == selection.frame),
        }
    }

    /// Intersection over union of all cameras together, of the prediction on the screen.
    #[must_use]
    pub fn iou(&self) -> Option<f64> {
        self.predicted.as_ref()?.iou()
    }

    /// The same without any work that is going on.
    #[must_use]
    pub fn at_rest(&self) -> Self {
        Self { live: None, live_scene: None, live_prediction: None, is_stepping: false, ..self.clone() }
    }

    /// Forgets what was made of another take.
    pub fn reset(&mut self, take: Option<Arc<Footage>>) {
        *self = Self { take, ..Self::default() };
    }

    /// Takes in a frame that was read.
    pub(crate) fn keep_frame(&mut self, frame: Arc<FrameData>) {
        self.frames.insert(frame);
        self.generation += 1;
    }

    /// Forgets silhouettes and what follows from them: the measurement's settings have changed.
    pub fn forget_measurements(&mut self) {
        self.frames.clear();
        self.predicted = None;
    }
}
