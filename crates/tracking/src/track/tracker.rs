//! Frame after frame: each fit starts where the motion so far leads.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::evidence::{Evidence, FitError, FitView};
use super::fit::Fit;
use super::motion::{FrameBelief, Motion, MotionFilter, Predicted};
use super::options::FitOptions;
use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::cancel::CancelToken;
use crate::optimize::Termination;
use crate::render::{Ramp, View, prediction};
use crate::silhouette::{Label, Mask, Overlap};

/// A frame counts as lost below this overlap of model and silhouettes (IoU).
pub const LOST_BELOW_IOU: f64 = 0.4;

/// What the tracker found in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameEstimate {
    /// Number of the frame.
    pub frame: usize,
    /// Its pose.
    pub pose: Pose,
    /// Cost at the end, squared grey levels, by the last stage's measure.
    pub cost: f64,
    /// Root of the mean squared residual per pixel, grey levels.
    pub rms: f64,
    /// Overlap of model and silhouette, camera by camera; `None` where there was no mask or nobody in it.
    pub overlap: Vec<Option<Overlap>>,
    /// Cameras that had nothing to say and were left out, by name.
    pub empty_cameras: Vec<String>,
    /// Iterations, rejected ones included.
    pub iterations: usize,
    /// Whether the subject was lost: no silhouettes, or hardly any overlap with them.
    pub lost: bool,
    /// Why the fit ended; `None` if there was nothing to fit.
    pub termination: Option<Termination>,
    /// What the Kalman filter believed, where it ran.
    pub belief: Option<FrameBelief>,
}

impl FrameEstimate {
    /// Overlap of all cameras together; `None` without masks.
    #[must_use]
    pub fn iou(&self) -> Option<f64> {
        self.overlap.iter().flatten().copied().reduce(Overlap::merge).and_then(|overlap| overlap.iou())
    }
}

/// Estimates by frame, in the order of the frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    /// By frame number.
    pub frames: BTreeMap<usize, FrameEstimate>,
}

/// Follows a body from frame to frame, forwards or backwards.
#[derive(Debug)]
pub struct Tracker {
    model: Arc<Model>,
    options: FitOptions,
    next_start: Pose,
    /// The last frame's number and pose.
    last: Option<(usize, Pose)>,
    /// Whether the subject was lost there.
    lost: bool,
    motion: Motion,
    filter: Option<MotionFilter>,
    frame_seconds: f64,
}

impl Tracker {
    /// Starts from a pose near the first frame's. `continues` says that it comes from a neighbouring frame:
    /// then the wide first stages are skipped.
    ///
    /// # Errors
    /// A pose that is not the model's, or options that make no sense.
    pub fn new(model: Arc<Model>, options: FitOptions, start: Pose) -> Result<Self, FitError> {
        start.check(&model)?;
        options.check()?;
        Ok(Self {
            model,
            options,
            next_start: start.normalized(),
            last: None,
            lost: false,
            motion: Motion::default(),
            filter: None,
            frame_seconds: 1.0,
        })
    }

    /// Carries motion from frame to frame in another way, at so many frames a second.
    #[must_use]
    pub fn with_motion(mut self, motion: Motion, frame_rate: f64) -> Self {
        self.motion = motion;
        self.frame_seconds = 1.0 / frame_rate;
        self.filter = match motion {
            Motion::Kalman(options) => Some(MotionFilter::new(&self.model, options)),
            Motion::Still | Motion::Velocity => None,
        };
        self
    }

    /// Goes on from a frame that was fitted before: the next one skips the wide first stages.
    #[must_use]
    pub fn continuing_from(mut self, frame: usize) -> Self {
        self.last = Some((frame, self.next_start.clone()));
        self
    }

    /// The pose that the next frame's fit will start from.
    #[must_use]
    pub fn next_start(&self) -> &Pose {
        &self.next_start
    }

    /// Fits one frame. A camera that sees nobody is left out and named. A frame in which none sees anybody is marked lost
    /// and keeps the predicted pose.
    ///
    /// After a lost frame the motion is not carried on, and the search is as wide as in a first frame.
    ///
    /// # Errors
    /// Data that are not the camera's. Nothing that was tracked is lost.
    pub fn track_frame(
        &mut self,
        frame: usize,
        views: Vec<FitView>,
        cancel: &CancelToken,
    ) -> Result<FrameEstimate, FitError> {
        let masks: Vec<Option<Arc<Mask>>> = views
            .iter()
            .map(|view| match &view.evidence {
                Evidence::Mask(mask) if mask.count(Label::Subject) > 0 => Some(Arc::clone(mask)),
                _ => None,
            })
            .collect();
        let cameras: Vec<_> = views.iter().map(|view| Arc::clone(&view.camera)).collect();
        let mut options = self.options.clone();
        if self.last.is_some() && !self.lost {
            let skipped = options.skip_when_tracking.min(options.stages.len() - 1);
            options.stages.drain(..skipped);
        }
        let predicted = self.predict(frame);
        let start = predicted.as_ref().map_or(&self.next_start, |predicted| &predicted.mean).clone();
        let prior = self.filter.as_ref().zip(predicted.as_ref()).and_then(|(filter, p)| filter.prior(p));
        let mut products = None;
        let mut estimate = FrameEstimate {
            frame,
            pose: start.clone(),
            cost: 0.0,
            rms: 0.0,
            overlap: vec![None; views.len()],
            empty_cameras: Vec::new(),
            iterations: 0,
            lost: true,
            termination: None,
            belief: None,
        };
        let names: Vec<String> = cameras.iter().map(|camera| camera.name().to_owned()).collect();
        let model = Arc::clone(&self.model);
        let fit = match prior {
            Some(prior) => Fit::with_motion_prior(model, views, prior, options),
            None => Fit::new(model, views, start, options),
        };
        match fit {
            Ok(mut fit) => {
                let summary = fit.run(cancel, |_| {});
                estimate.pose = summary.pose;
                estimate.cost = summary.final_cost;
                estimate.rms = summary.final_rms;
                estimate.iterations = summary.iterations.len();
                estimate.termination = Some(summary.termination);
                estimate.empty_cameras = summary.empty_cameras;
                estimate.lost = false;
                products = self.filter.is_some().then(|| fit.frame_equations().jtj);
            }
            Err(FitError::NoData { .. }) => estimate.empty_cameras = names,
            Err(error) => return Err(error),
        }
        let kinematics = Kinematics::new(&self.model, &estimate.pose);
        for ((overlap, mask), camera) in estimate.overlap.iter_mut().zip(&masks).zip(&cameras) {
            *overlap = mask.as_ref().and_then(|mask| {
                let view = View::new(&self.model, &kinematics, camera, self.options.renderer, Ramp::Half);
                Overlap::between(mask, &prediction::lambda(&view)).ok()
            });
        }
        if estimate.iou().is_some_and(|iou| iou < LOST_BELOW_IOU) {
            estimate.lost = true;
        }
        if let Some(filter) = &mut self.filter {
            let products = products.filter(|_| !estimate.lost);
            estimate.belief = Some(filter.learn(&estimate.pose, products.as_ref(), predicted));
        }
        self.advance(&estimate);
        Ok(estimate)
    }

    /// What the Kalman filter foretells of a frame; after a lost one it begins anew.
    fn predict(&self, frame: usize) -> Option<Predicted> {
        let (before, pose) = self.last.as_ref().filter(|_| !self.lost)?;
        let frames = frame as f64 - *before as f64;
        self.filter.as_ref()?.predict(pose, frames * self.frame_seconds)
    }

    /// Predicts the next start: the motion between the last two frames goes on, unless the subject was lost.
    fn advance(&mut self, estimate: &FrameEstimate) {
        let (frame, pose) = (estimate.frame, &estimate.pose);
        let goes_on = self.motion != Motion::Still && !estimate.lost;
        self.next_start = match &self.last {
            Some((before, from)) if *before != frame && goes_on => {
                pose.retract(Parameters::Tangent, &pose.local(from))
            }
            _ => pose.clone(),
        };
        self.last = Some((frame, pose.clone()));
        self.lost = estimate.lost;
    }
}
