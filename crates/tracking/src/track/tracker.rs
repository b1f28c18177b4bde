//! Frame after frame: each fit starts where the motion so far leads.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::estimate::{FrameEstimate, iou};
use super::lost::{Lost, UsualCost};
use super::motion::{Motion, MotionFilter, Predicted};
use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::camera::Camera;
use crate::cancel::CancelToken;
use crate::fit::{Evidence, Fit, FitError, FitOptions, FitView, SolverSummary};
use crate::render::{Ramp, RendererKind, View, prediction};
use crate::residual::motion_prior::MotionPrior;
use crate::search::{self, Hypothesis, SearchOptions};
use crate::silhouette::{Label, Mask, Overlap};

/// A first fit that overlaps better than this (IoU) is not questioned. On real footage with two and four cameras, fits
/// of the right pose begin at 0.88 and those of a wrong one reach 0.88; a search from the right one changed nothing.
pub const SEARCH_BELOW_IOU: f64 = 0.9;

/// When to look for other poses than the one downhill from the start
/// ([`search`]): in a first frame, or in one after a lost one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WhenToSearch {
    /// Never.
    #[default]
    Never,
    /// Where the plain fit overlaps by less than [`SEARCH_BELOW_IOU`].
    WhenPoor,
    /// Always.
    Always,
}

/// The cameras of a frame, and the masks of those that see somebody.
pub(super) struct FrameMasks {
    cameras: Vec<Arc<Camera>>,
    masks: Vec<Option<Arc<Mask>>>,
}

impl FrameMasks {
    pub(super) fn of(views: &[FitView]) -> Self {
        let mask = |view: &FitView| match &view.evidence {
            Evidence::Mask(mask) if mask.labels().contains(&Label::Subject) => Some(Arc::clone(mask)),
            _ => None,
        };
        Self {
            cameras: views.iter().map(|view| Arc::clone(&view.camera)).collect(),
            masks: views.iter().map(mask).collect(),
        }
    }

    /// Overlap of a pose with every mask.
    pub(super) fn overlap(&self, model: &Model, pose: &Pose, renderer: RendererKind) -> Vec<Option<Overlap>> {
        let kinematics = Kinematics::new(model, pose);
        let of_camera = |(mask, camera): (&Option<Arc<Mask>>, &Arc<Camera>)| {
            let view = View::new(model, &kinematics, camera, renderer, Ramp::Half);
            Overlap::of_covered(mask.as_ref()?, &prediction::covered(&view)).ok()
        };
        self.masks.iter().zip(&self.cameras).map(of_camera).collect()
    }
}

/// A frame's fit that has run.
struct Found {
    fit: Fit,
    summary: SolverSummary,
    hypotheses: Vec<Hypothesis>,
}

impl Found {
    fn run(mut fit: Fit, hypotheses: Vec<Hypothesis>, cancel: &CancelToken) -> Self {
        let summary = fit.run(cancel, |_| {});
        Self { fit, summary, hypotheses }
    }
}

/// The same, and how it is judged.
struct Attempt {
    found: Found,
    overlap: Vec<Option<Overlap>>,
    lost: Option<Lost>,
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
    usual: UsualCost,
    motion: Motion,
    search: WhenToSearch,
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
            usual: UsualCost::default(),
            motion: Motion::default(),
            search: WhenToSearch::default(),
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

    /// Looks for other poses in a first frame and after a lost one.
    #[must_use]
    pub fn with_search(mut self, search: WhenToSearch) -> Self {
        self.search = search;
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
    /// A frame that looks lost ([`Lost`]) is fitted once more, as widely as a first frame, other poses included where that
    /// is asked for ([`with_search`](Self::with_search)); the better fit stays. After a lost frame the motion is not
    /// carried on, and the next one begins as widely.
    ///
    /// # Errors
    /// Data that are not the camera's. Nothing that was tracked is lost.
    pub fn track_frame(
        &mut self,
        frame: usize,
        views: Vec<FitView>,
        cancel: &CancelToken,
    ) -> Result<FrameEstimate, FitError> {
        let masks = FrameMasks::of(&views);
        let mut predicted = self.predict(frame);
        let start = predicted.as_ref().map_or(&self.next_start, |predicted| &predicted.mean).clone();
        let prior = self.filter.as_ref().zip(predicted.as_ref()).and_then(|(filter, p)| filter.prior(p));
        let begins = self.last.is_none() || self.lost;
        let again = (!begins).then(|| views.clone());
        let found = if begins {
            self.fit_widely(views, &start, &masks, cancel)
        } else {
            self.follow(views, start.clone(), prior, cancel)
        };
        let found = match found {
            Ok(found) => found,
            Err(FitError::NoData { .. }) => return Ok(self.nobody(frame, start, &masks, predicted)),
            Err(error) => return Err(error),
        };
        let mut attempt = self.attempt(found, &masks);
        if let Some(views) = again.filter(|_| attempt.lost.is_some() && !cancel.is_cancelled()) {
            let wider = self.attempt(self.fit_widely(views, &start, &masks, cancel)?, &masks);
            if wider.found.summary.final_rms < attempt.found.summary.final_rms {
                attempt = wider;
                // Where the motion was wrong it says nothing of what follows.
                predicted = None;
            }
        }
        Ok(self.keep(frame, attempt, predicted))
    }

    fn attempt(&self, found: Found, masks: &FrameMasks) -> Attempt {
        let overlap = masks.overlap(&self.model, &found.summary.pose, self.options.renderer);
        let lost = self.usual.judge(found.summary.final_rms, iou(&overlap));
        Attempt { found, overlap, lost }
    }

    /// Learns from a frame's fit.
    fn keep(&mut self, frame: usize, attempt: Attempt, predicted: Option<Predicted>) -> FrameEstimate {
        let Attempt { found: Found { mut fit, summary, hypotheses }, overlap, lost } = attempt;
        self.usual.remember(summary.final_rms, lost);
        let belief = self.filter.as_mut().map(|filter| {
            let products = lost.is_none().then(|| fit.frame_equations().jtj);
            filter.learn(&summary.pose, products.as_ref(), predicted)
        });
        let estimate = FrameEstimate {
            frame,
            pose: summary.pose,
            cost: Some(summary.final_cost),
            rms: Some(summary.final_rms),
            overlap,
            empty_cameras: summary.empty_cameras,
            iterations: summary.iterations.len(),
            lost_because: lost,
            termination: Some(summary.termination),
            belief,
            hypotheses,
        };
        self.advance(&estimate);
        estimate
    }

    /// A frame in which there is nobody: the pose is the predicted one.
    fn nobody(
        &mut self,
        frame: usize,
        pose: Pose,
        masks: &FrameMasks,
        predicted: Option<Predicted>,
    ) -> FrameEstimate {
        let belief = self.filter.as_mut().map(|filter| filter.learn(&pose, None, predicted));
        let estimate = FrameEstimate {
            frame,
            overlap: masks.overlap(&self.model, &pose, self.options.renderer),
            pose,
            cost: None,
            rms: None,
            empty_cameras: masks.cameras.iter().map(|camera| camera.name().to_owned()).collect(),
            iterations: 0,
            lost_because: Some(Lost::Nobody),
            termination: None,
            belief,
            hypotheses: Vec::new(),
        };
        self.advance(&estimate);
        estimate
    }

    /// Fits a frame near the one before: from a start, or from what the motion foretells, without the widest stages.
    fn follow(
        &self,
        views: Vec<FitView>,
        start: Pose,
        prior: Option<MotionPrior>,
        cancel: &CancelToken,
    ) -> Result<Found, FitError> {
        let model = Arc::clone(&self.model);
        let options = self.options.clone().near_at_scale(&model, &views, &start);
        let fit = match prior {
            Some(prior) => Fit::with_motion_prior(model, views, prior, options),
            None => Fit::new(model, views, start, options),
        }?;
        Ok(Found::run(fit, Vec::new(), cancel))
    }

    /// Fits a frame from far away: with all stages, and with a search where that is asked for.
    fn fit_widely(
        &self,
        views: Vec<FitView>,
        start: &Pose,
        masks: &FrameMasks,
        cancel: &CancelToken,
    ) -> Result<Found, FitError> {
        let (model, options) = (&self.model, self.options.clone());
        if self.search == WhenToSearch::Always {
            return self.search(views, start, options, cancel);
        }
        let again = (self.search == WhenToSearch::WhenPoor).then(|| views.clone());
        let fit = Fit::new(Arc::clone(model), views, start.clone(), options.clone())?;
        let found = Found::run(fit, Vec::new(), cancel);
        let overlap = || iou(&masks.overlap(model, &found.summary.pose, options.renderer));
        let is_poor = || {
            overlap().is_some_and(|iou| iou < SEARCH_BELOW_IOU)
                || self.usual.judge(found.summary.final_rms, None).is_some()
        };
        match again.filter(|_| is_poor()) {
            Some(views) => self.search(views, start, options, cancel),
            None => Ok(found),
        }
    }

    fn search(
        &self,
        views: Vec<FitView>,
        start: &Pose,
        options: FitOptions,
        cancel: &CancelToken,
    ) -> Result<Found, FitError> {
        let effort = SearchOptions::default();
        let (fit, found) = search::fit_best(Arc::clone(&self.model), views, start, options, &effort, cancel)?;
        Ok(Found::run(fit, found, cancel))
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
        let goes_on = self.motion != Motion::Still && !estimate.is_lost();
        self.next_start = match &self.last {
            Some((before, from)) if *before != frame && goes_on => {
                pose.retract(Parameters::Tangent, &pose.local(from))
            }
            _ => pose.clone(),
        };
        self.last = Some((frame, pose.clone()));
        self.lost = estimate.is_lost();
    }
}
