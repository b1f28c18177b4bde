//! Frame after frame: each fit starts where the motion so far leads.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::beam::{Beam, Mode};
use super::estimate::{FrameEstimate, iou, overlaps};
use super::extent;
use super::lost::{Lost, UsualCost};
use super::memory::{FilterMemory, LastFrame};
use super::motion::{
    Begins, ConditionedPrediction, FrameBelief, FrameMeasurement, KalmanOptions, Motion, MotionError,
    Predicted,
};
use super::patience::{LAST_RESORT, Patience};
use super::trust::FrameContext;
use crate::belief::{self, Conflicts};
use crate::body::{Kinematics, Model, Pose, Sides};
use crate::cancel::CancelToken;
use crate::cues::{CueOptions, CueWatch, FrameCues, WatchedCamera};
use crate::fit::{Evidence, Fit, FitError, FitOptions, FitView, SolverSummary};
use crate::numbers::OptionError;
use crate::optimize::NormalEquations;
use crate::residual::learnt_prior::LearntPrior;
use crate::search::{self, Hypothesis, SearchOptions, WithoutStartError, WithoutStartOptions};
use crate::silhouette::Overlap;

/// A first fit that overlaps better than this (IoU) is not questioned. Set on the balancing footage with two and four cameras,
/// where fits of the right pose begin at 0.88 and those of a wrong one reach 0.88; a search from the right one changed nothing. In
/// loose clothes right poses stay below it, and are searched for in vain (`lab/thresholds.rs`).
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

/// Follows a body from frame to frame, forwards or backwards. Frames need not follow one another at equal distances:
/// their numbers and the frame rate are the time.
#[derive(Debug)]
pub struct Tracker {
    pub(super) model: Arc<Model>,
    pub(super) options: FitOptions,
    /// Where the first frame's fit starts; `None` looks for it in the visual hull.
    pub(super) start: Option<Pose>,
    pub(super) last: Option<LastFrame>,
    pub(super) usual: UsualCost,
    pub(super) last_resort: Patience,
    pub(super) motion: Motion,
    search: WhenToSearch,
    /// What a Kalman filter believes after the last frame.
    pub(super) filter: Option<FilterMemory>,
    frame_seconds: f64,
    pub(super) cues: Option<CueWatch>,
    /// Most rivals that are carried.
    pub(super) most_rivals: usize,
    pub(super) beam: Beam,
    /// Whether every limb is judged.
    judges: bool,
}

impl Tracker {
    /// Starts from a pose near the first frame's. `continues` says that it comes from a neighbouring frame:
    /// then the wide first stages are skipped.
    ///
    /// # Errors
    /// A pose that is not the model's, or options out of range.
    pub fn new(model: Arc<Model>, options: FitOptions, start: Pose) -> Result<Self, FitError> {
        start.check(&model)?;
        Self::begin(model, options, Some(start.normalized()))
    }

    /// Starts where no pose is known: the first frame in which somebody is seen is searched
    /// ([`without_start`](crate::search::without_start())).
    ///
    /// # Errors
    /// An option out of range.
    pub fn without_start(model: Arc<Model>, options: FitOptions) -> Result<Self, FitError> {
        Self::begin(model, options, None)
    }

    fn begin(model: Arc<Model>, options: FitOptions, start: Option<Pose>) -> Result<Self, FitError> {
        options.check()?;
        Ok(Self {
            model,
            options,
            start,
            last_resort: Patience::default(),
            last: None,
            usual: UsualCost::default(),
            motion: Motion::default(),
            search: WhenToSearch::default(),
            filter: None,
            frame_seconds: 1.0,
            cues: None,
            most_rivals: 0,
            beam: Beam::default(),
            judges: false,
        })
    }

    /// Carries motion from frame to frame in another way, at this many frames a second.
    ///
    /// # Errors
    /// A number out of range, by field.
    pub fn with_motion(mut self, motion: Motion, frame_rate: f64) -> Result<Self, MotionError> {
        if !(frame_rate.is_normal() && frame_rate > 0.0) {
            return Err(MotionError::FrameRate(frame_rate));
        }
        if let Motion::Kalman(options) = &motion {
            options.check()?;
        }
        (self.motion, self.frame_seconds, self.filter) = (motion, 1.0 / frame_rate, None);
        Ok(self)
    }

    /// Looks for other poses in a first frame and after a lost one.
    #[must_use]
    pub fn with_search(mut self, search: WhenToSearch) -> Self {
        self.search = search;
        self
    }

    /// Carries other hypotheses beside the leading one, this many at most, where silhouettes speak against it.
    #[must_use]
    pub fn with_rivals(mut self, most: usize) -> Self {
        self.most_rivals = most;
        self
    }

    /// Says of every frame how far each limb may be believed ([`FrameEstimate::trust`]).
    #[must_use]
    pub fn with_trust(mut self) -> Self {
        self.judges = true;
        self
    }

    /// Lets cues of the pictures pull at limbs that silhouettes do not hold, and says of every frame what held which limb.
    ///
    /// # Errors
    /// An option out of range, by field.
    pub fn with_cues(mut self, options: CueOptions) -> Result<Self, OptionError> {
        self.cues = Some(CueWatch::new(Arc::clone(&self.model), options, self.options.renderer)?);
        Ok(self)
    }

    /// Goes on from a frame that was fitted before: the next one skips the wide first stages.
    #[must_use]
    pub fn continuing_from(mut self, frame: usize) -> Self {
        let pose = self.first_start();
        self.start = Some(pose.clone());
        self.last = Some(LastFrame { frame, pose, lost: false, velocity: None });
        self
    }

    fn first_start(&self) -> Pose {
        self.start.clone().unwrap_or_else(|| Pose::rest(&self.model))
    }

    /// The pose that a frame's fit will start from: where the motion leads until then; at rest where no start is known.
    #[must_use]
    pub fn start_of(&self, frame: usize) -> Pose {
        if self.steering().is_some()
            && let Ok(prediction) = self.predict(frame)
        {
            return prediction.mean;
        }
        let Some(last) = &self.last else { return self.first_start() };
        last.leads_to(self.seconds_between(last.frame, frame))
    }

    /// Fits one frame. A camera that sees nobody is left out and named. A frame in which none sees anybody is marked lost
    /// and keeps the predicted pose.
    ///
    /// A frame that looks lost ([`Lost`]) is fitted once more, as widely as a first frame, other poses included where that
    /// is asked for ([`with_search`](Self::with_search)); the better fit stays. After a lost frame the motion is not
    /// carried on, and the next one begins as widely. What leads from a lost pose to the one that is found is no motion.
    /// Where other poses may be looked for and a frame stays lost, the last resort is the visual hull
    /// ([`without_start`](crate::search::without_start())): in the first lost frame, and then ever more rarely.
    ///
    /// # Errors
    /// Data that are not the camera's. Nothing that was tracked is lost.
    pub fn track_frame(
        &mut self,
        frame: usize,
        views: Vec<FitView>,
        cancel: &CancelToken,
    ) -> Result<FrameEstimate, FitError> {
        self.track_frame_with_cues(frame, views, FrameCues::default(), cancel)
    }

    /// The same with what the frame's pictures say beside their silhouettes, in the order of `views`. Only a tracker
    /// [with cues](Self::with_cues) looks at it.
    ///
    /// # Errors
    /// As [`track_frame`](Self::track_frame).
    pub fn track_frame_with_cues(
        &mut self,
        frame: usize,
        views: Vec<FitView>,
        cues: FrameCues,
        cancel: &CancelToken,
    ) -> Result<FrameEstimate, FitError> {
        let led = self.last.as_ref().filter(|last| last.velocity.is_some());
        let step_seconds = led.map(|last| self.seconds_between(last.frame, frame).abs());
        self.options.prior = self.options.prior.take().map(|prior| LearntPrior { step_seconds, ..prior });
        let mut predicted = self.predict(frame);
        let start = self.start_of(frame);
        if let Some(watch) = &mut self.cues {
            let (cameras, cues) = watched(&views, cues);
            watch.update(cameras, cues, &start);
        }
        let begins = self.last.as_ref().is_none_or(|last| last.lost);
        let attempt = if self.start.is_none() {
            match self.find(&views, None, cancel) {
                Err(WithoutStartError::Fit(error)) => Err(error),
                Err(_) => return Ok(self.lost(frame, start, &views, predicted, Lost::NoStart)),
                Ok(attempt) => {
                    self.start = Some(attempt.summary.pose.clone());
                    Ok(attempt)
                }
            }
        } else if begins {
            self.fit_widely(&views, &start, cancel)
        } else {
            self.follow(&views, start.clone(), predicted.as_ref().ok(), cancel)
        };
        let mut attempt = match attempt {
            Ok(attempt) => attempt,
            Err(FitError::NoData { .. }) => {
                return Ok(self.lost(frame, start, &views, predicted, Lost::Nobody));
            }
            Err(error) => return Err(error),
        };
        if !begins && attempt.lost.is_some() && !cancel.is_cancelled() {
            let wider = self.fit_widely(&views, &start, cancel)?;
            if wider.is_better(&attempt) {
                attempt = wider;
                // Where the motion was wrong it says nothing of what follows.
                predicted = Err(Begins::FoundElsewhere);
            }
        }
        if self.search != WhenToSearch::Never
            && !cancel.is_cancelled()
            && self.last_resort.is_due(attempt.lost.is_some(), LAST_RESORT)
            && let Ok(found) = self.find(&views, Some(&start), cancel)
            && found.is_better(&attempt)
        {
            attempt = found;
            predicted = Err(Begins::FoundElsewhere);
        }
        if self.most_rivals > 0 && !attempt.summary.is_broken() && !cancel.is_cancelled() {
            let conflicts = self.conflicts(&attempt.summary.pose, &views);
            let (winner, modes) = self.contest(frame, &mut attempt.fit, &conflicts, &views, cancel);
            if let Some(fit) = winner {
                attempt = self.judged(fit, attempt.hypotheses, &views);
                predicted = Err(Begins::FoundElsewhere);
            } else {
                attempt.conflicts = Some(conflicts);
            }
            attempt.modes = modes;
        }
        if attempt.lost == Some(Lost::OutOfScene) {
            let kinematics = Kinematics::new(&self.model, &start);
            let mut pose = start;
            if extent::is_beyond(&self.model, &kinematics, &views, &self.overlaps(&pose, &views))
                && let Some(root) = extent::place(&self.model, &views)
            {
                pose.root = root;
            }
            return Ok(self.lost(frame, pose, &views, predicted, Lost::OutOfScene));
        }
        Ok(self.keep(frame, attempt, predicted, &views, cancel))
    }

    /// Runs a fit of the frame at hand with its cues, if there are any, and judges it.
    fn attempt(
        &self,
        fit: Fit,
        hypotheses: Vec<Hypothesis>,
        views: &[FitView],
        cancel: &CancelToken,
    ) -> Result<Attempt, FitError> {
        let mut fit = match &self.cues {
            Some(watch) => fit.with_cues(Arc::clone(watch.set()))?,
            None => fit,
        };
        fit.run(cancel, |_| {});
        Ok(self.judged(fit, hypotheses, views))
    }

    /// Judges a fit that has run.
    fn judged(&self, fit: Fit, hypotheses: Vec<Hypothesis>, views: &[FitView]) -> Attempt {
        let summary = fit.summary();
        let overlap = self.overlaps(&summary.pose, views);
        let kinematics = Kinematics::new(&self.model, &summary.pose);
        let is_out = extent::is_beyond(&self.model, &kinematics, views, &overlap);
        let usual = self.usual.by(fit.options.final_ramp());
        let judge = || usual.judge(rms(&summary), iou(&overlap), &overlap);
        let lost = if is_out { Some(Lost::OutOfScene) } else { judge() };
        Attempt { fit, summary, hypotheses, overlap, lost, conflicts: None, modes: Vec::new() }
    }

    fn overlaps(&self, pose: &Pose, views: &[FitView]) -> Vec<Option<Overlap>> {
        overlaps(&self.model, pose, self.options.renderer, views)
    }

    /// Learns from a frame's fit. A Kalman filter weighs it against what was predicted; the next frame's fit starts from it as
    /// it is, so that what the filter believes loses nothing that the fit would have found.
    fn keep(
        &mut self,
        frame: usize,
        attempt: Attempt,
        mut predicted: Result<ConditionedPrediction, Begins>,
        views: &[FitView],
        cancel: &CancelToken,
    ) -> FrameEstimate {
        let goes_on = predicted != Err(Begins::FoundElsewhere);
        let Attempt { mut fit, mut summary, hypotheses, mut overlap, lost, mut conflicts, modes } = attempt;
        self.usual = self.usual.by(fit.options.final_ramp());
        self.usual.remember(summary.final_rms, lost);
        let fitted = summary.pose.clone();
        let mut variance = 0.0;
        if lost.is_none()
            && let Motion::Kalman(options) = &self.motion
        {
            variance = self.variance(options, &fit, views);
            if let Ok(prediction) = &predicted {
                match self.weigh(&mut fit, prediction, variance, views, cancel) {
                    Ok(weighed) => variance = weighed,
                    Err(error) => predicted = Err(Begins::Broken(error)),
                }
                conflicts = None;
                summary = fit.summary();
                overlap = self.overlaps(&summary.pose, views);
            }
        }
        let measurement = || {
            let NormalEquations { jtj, jtr, .. } = fit.measured_equations();
            FrameMeasurement { products: jtj, pull: jtr, variance }
        };
        let belief = self.believe(&summary.pose, || lost.is_none().then(measurement), predicted);
        let holds = self.cues.as_mut().map(|watch| watch.learn(&summary.pose, lost.is_none()));
        let signs = if self.judges {
            let conflicts = conflicts.unwrap_or_else(|| self.conflicts(&summary.pose, views));
            let holds = holds.as_deref().unwrap_or_default();
            let beside = FrameContext { holds, modes: &modes, lost, rms: rms(&summary) };
            self.signs(frame, &mut fit, &conflicts, beside, views)
        } else {
            Vec::new()
        };
        let estimate = FrameEstimate {
            frame,
            pose: summary.pose,
            cost: Some(summary.final_cost).filter(|cost| cost.is_finite()),
            rms: Some(summary.final_rms).filter(|rms| rms.is_finite()),
            overlap,
            empty_cameras: summary.empty_cameras,
            iterations: summary.iterations.len(),
            lost_because: lost,
            termination: Some(summary.termination),
            belief,
            hypotheses,
            holds: holds.unwrap_or_default(),
            trust: belief::trust(&signs),
            signs,
            modes,
            is_elsewhere: !goes_on,
        };
        self.advance(frame, fitted, lost.is_some(), goes_on);
        estimate
    }

    /// What a Kalman filter believes after a frame, if there is one.
    fn believe(
        &mut self,
        pose: &Pose,
        measurement: impl FnOnce() -> Option<FrameMeasurement>,
        predicted: Result<ConditionedPrediction, Begins>,
    ) -> Option<FrameBelief> {
        let Motion::Kalman(noise) = self.motion else { return None };
        let learned = FrameBelief::learnt(pose, measurement(), predicted);
        self.filter = Some(FilterMemory { noise, pose: pose.clone(), belief: learned.belief.clone() });
        Some(learned)
    }

    /// A frame in which there is nobody, or nobody to be found within the scene: the pose is the predicted one.
    fn lost(
        &mut self,
        frame: usize,
        pose: Pose,
        views: &[FitView],
        predicted: Result<ConditionedPrediction, Begins>,
        because: Lost,
    ) -> FrameEstimate {
        let names = || views.iter().map(|view| view.camera.name().to_owned()).collect();
        let empty = if because == Lost::Nobody { names() } else { Vec::new() };
        let belief = self.believe(&pose, || None, predicted);
        if let Some(watch) = &mut self.cues {
            watch.learn(&pose, false);
        }
        let estimate = FrameEstimate {
            overlap: self.overlaps(&pose, views),
            empty_cameras: empty,
            lost_because: Some(because),
            belief,
            trust: if self.judges { self.nothing_believed() } else { Vec::new() },
            ..FrameEstimate::of_pose(frame, pose)
        };
        self.advance(frame, estimate.pose.clone(), true, false);
        estimate
    }

    /// Fits a frame near the one before, without the widest stages; by what was predicted of it, where that is to steer.
    fn follow(
        &self,
        views: &[FitView],
        start: Pose,
        prediction: Option<&ConditionedPrediction>,
        cancel: &CancelToken,
    ) -> Result<Attempt, FitError> {
        let model = Arc::clone(&self.model);
        let options = self.options.clone().near_at_scale(&model, views, &start);
        let mut fit = Fit::new(model, views.to_vec(), start, options)?;
        if let Some((options, prediction)) = self.steering().zip(prediction)
            && let Ok(prior) = prediction.prior(self.variance(options, &fit, views))
        {
            fit = fit.steered_by(prior);
        }
        self.attempt(fit, Vec::new(), views, cancel)
    }

    /// Looks for the body in the visual hull, and fits it there. Where silhouettes do not tell front from back it looks as
    /// in `before`.
    fn find(
        &self,
        views: &[FitView],
        before: Option<&Pose>,
        cancel: &CancelToken,
    ) -> Result<Attempt, WithoutStartError> {
        let sides = before.and_then(|pose| Sides::of(&self.model, &Kinematics::new(&self.model, pose)));
        let faces = sides.map(|sides| sides.ahead);
        let choices = WithoutStartOptions { faces, ..WithoutStartOptions::for_fit(&self.options) };
        let found = search::without_start(&self.model, views, &choices, cancel)?;
        let attempt = self.follow(views, found.pose().clone(), None, cancel)?;
        Ok(Attempt { hypotheses: found.hypotheses, ..attempt })
    }

    /// Fits a frame from far away: with all stages, and with a search where that is asked for.
    fn fit_widely(&self, views: &[FitView], start: &Pose, cancel: &CancelToken) -> Result<Attempt, FitError> {
        if self.search == WhenToSearch::Always {
            return self.search(views, start, cancel);
        }
        let fit = Fit::new(Arc::clone(&self.model), views.to_vec(), start.clone(), self.options.clone())?;
        let attempt = self.attempt(fit, Vec::new(), views, cancel)?;
        let usual = self.usual.by(attempt.fit.options.final_ramp());
        let is_poor = iou(&attempt.overlap).is_some_and(|iou| iou < SEARCH_BELOW_IOU)
            || usual.judge(rms(&attempt.summary), None, &attempt.overlap).is_some();
        if self.search == WhenToSearch::WhenPoor && is_poor {
            return self.search(views, start, cancel);
        }
        Ok(attempt)
    }

    fn search(&self, views: &[FitView], start: &Pose, cancel: &CancelToken) -> Result<Attempt, FitError> {
        // A track knows which way its body faces; a first frame's start may not.
        let effort = SearchOptions { turned: self.last.is_none(), ..SearchOptions::default() };
        let (model, options) = (Arc::clone(&self.model), self.options.clone());
        let (fit, found) = search::fit_best(model, views.to_vec(), start, options, &effort, cancel)?;
        self.attempt(fit, found, views, cancel)
    }

    /// What the Kalman filter predicts of a frame, or why it begins there.
    fn predict(&self, frame: usize) -> Result<ConditionedPrediction, Begins> {
        let last = self.last.as_ref().ok_or(Begins::First)?;
        if last.lost {
            return Err(Begins::AfterLoss);
        }
        let seconds = self.seconds_between(last.frame, frame);
        let (FilterMemory { pose, belief, .. }, motion) =
            self.filter.as_ref().zip(self.motion_model()).ok_or(Begins::First)?;
        let predicted = Predicted::after(motion, pose, belief, seconds);
        let known = self.known(&predicted.mean);
        predicted.conditioned_on(&known).map_err(Begins::Broken)
    }

    /// The filter's options, if it steers.
    fn steering(&self) -> Option<&KalmanOptions> {
        match &self.motion {
            Motion::Kalman(options) => Some(options).filter(|options| options.steers),
            _ => None,
        }
    }

    /// Negative backwards.
    pub(super) fn seconds_between(&self, before: usize, frame: usize) -> f64 {
        (frame as f64 - before as f64) * self.frame_seconds
    }

    /// Takes a frame as the last one. Its velocity is the motion from the one before, unless the subject was lost in one
    /// of the two or was found elsewhere: what leads to a recovered pose is no motion.
    fn advance(&mut self, frame: usize, pose: Pose, lost: bool, goes_on: bool) {
        let before = self.last.as_ref().filter(|last| {
            self.motion != Motion::Still && goes_on && !lost && !last.lost && last.frame != frame
        });
        let velocity = before.map(|last| last.velocity_to(&pose, self.seconds_between(last.frame, frame)));
        self.last = Some(LastFrame { frame, pose, lost, velocity });
    }
}

/// A fit of a frame that has run, before it is taken for the frame's pose, and how it is judged.
struct Attempt {
    fit: Fit,
    summary: SolverSummary,
    hypotheses: Vec<Hypothesis>,
    overlap: Vec<Option<Overlap>>,
    lost: Option<Lost>,
    /// What silhouettes say against the pose, where that was looked at.
    conflicts: Option<Conflicts>,
    /// The rivals beside it.
    modes: Vec<Mode>,
}

impl Attempt {
    /// A fit whose numbers ran out of range is never better, and any other is better than that.
    fn is_better(&self, other: &Self) -> bool {
        rms(&self.summary).total_cmp(&rms(&other.summary)).is_lt()
    }
}

/// What a fit is judged by: infinite where the numbers ran out of range.
fn rms(summary: &SolverSummary) -> f64 {
    if summary.is_broken() { f64::INFINITY } else { summary.final_rms }
}

/// The cameras that see somebody, with their cues: one that sees nobody, or is left out, holds nothing and has no cues.
pub(super) fn watched(views: &[FitView], mut cues: FrameCues) -> (Vec<WatchedCamera>, FrameCues) {
    let camera = |view: &FitView| WatchedCamera {
        camera: Arc::clone(&view.camera),
        mask: match &view.evidence {
            Evidence::Mask(mask) => Some(Arc::clone(mask)),
            Evidence::Measurement(_) => None,
        },
    };
    cues.cameras.resize_with(views.len(), Default::default);
    let used = views.iter().zip(cues.cameras).filter(|(view, _)| view.has_data());
    let (cameras, cues) = used.map(|(view, cues)| (camera(view), cues)).unzip();
    (cameras, FrameCues { cameras: cues })
}
