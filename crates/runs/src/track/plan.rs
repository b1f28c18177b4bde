//! What a track run is told: frames, direction, motion, cues, key poses.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use backlit_document::likely_poses;
use backlit_document::tracking_choices::Following;
use backlit_formats::Take;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{Cue, CueOptions};
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::residual::learnt_prior::LearntPrior;
use backlit_tracking::track::{
    FrameEstimate, KalmanOptions, Motion, Track, Tracker, Tuned, WhenToSearch, tune,
};

use super::{FrameReader, TrackEnding, TrackError, TrackMessage, TrackRun};

/// Most frames from which the filter's noise is estimated: a filter keeps a third of a megabyte of each.
const TUNED_FRAMES: usize = 600;

/// Hypotheses that are carried beside the leading one unless something else is asked for.
pub const RIVALS: usize = 7;

/// How frames are followed.
#[derive(Debug, Clone)]
pub struct TrackPlan {
    /// The body.
    pub model: Arc<Model>,
    /// The fit of a frame.
    pub fit: Arc<FitOptions>,
    /// Frames a second.
    pub frame_rate: f64,
    /// How motion is carried from frame to frame.
    pub motion: Motion,
    /// When other poses than the one downhill are looked for.
    pub search: WhenToSearch,
    /// Most hypotheses that are carried beside the leading one.
    pub rivals: usize,
    /// What else pulls at limbs that the silhouettes do not hold.
    pub cues: Vec<Cue>,
    /// How later frames smooth earlier ones, if they do.
    pub smoothing: Option<Smoothing>,
    /// Key poses on the way.
    pub keys: BTreeMap<usize, Pose>,
    /// What becomes of them.
    pub at_keys: KeyUse,
    /// Tracked one after the other. Two legs are tracks of the same frames from both sides, which are joined.
    pub legs: VecDeque<Leg>,
}

/// How later frames smooth earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Smoothing {
    /// How many frames after each count; all if `None`.
    pub lag: Option<usize>,
}

/// What becomes of a key pose on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyUse {
    /// It stays as it was set, and the track goes on from it.
    Keep,
    /// The fit of its frame begins there.
    Begin,
    /// The fit of its frame begins there, turned to face the other way.
    BeginTurned,
}

/// A track in one direction.
#[derive(Debug, Clone)]
pub struct Leg {
    /// The pose before its first frame is fitted.
    pub start: Pose,
    /// The neighbour of the first frame if the start is that neighbour's fitted pose.
    pub continues: Option<usize>,
    /// The frames in their order.
    pub frames: VecDeque<usize>,
}

impl TrackPlan {
    /// Follows these frames of a take from a pose as the robust preset does.
    pub fn of_frames(take: &Take, start: Pose, frames: VecDeque<usize>) -> Self {
        Self::new(Arc::clone(take.model()), take.frame_rate(), start, frames)
    }

    /// The same with this fit, and all else as this preset follows frames.
    pub fn of_preset(
        preset: Preset,
        fit: FitOptions,
        take: &Take,
        start: Pose,
        frames: VecDeque<usize>,
    ) -> Self {
        let (search, rivals) = match preset {
            Preset::Report => (WhenToSearch::Never, 0),
            Preset::Robust => (WhenToSearch::WhenPoor, RIVALS),
        };
        let motion = Motion::of_preset(Some(preset));
        Self { fit: Arc::new(fit), motion, search, rivals, ..Self::of_frames(take, start, frames) }
    }

    /// The same without a take.
    pub fn new(model: Arc<Model>, frame_rate: f64, start: Pose, frames: VecDeque<usize>) -> Self {
        Self {
            model,
            fit: Arc::default(),
            frame_rate,
            motion: Motion::default(),
            search: WhenToSearch::default(),
            rivals: RIVALS,
            cues: Vec::new(),
            smoothing: None,
            keys: BTreeMap::new(),
            at_keys: KeyUse::Begin,
            legs: [Leg { start, continues: None, frames }].into(),
        }
    }

    /// The same with motion carried in another way.
    #[must_use]
    pub fn following(self, how: Following) -> Self {
        let smoothing = match how {
            Following::Smoothed { lag } => Some(Smoothing { lag }),
            _ => None,
        };
        Self { motion: how.motion(), smoothing, ..self }
    }

    /// A tracker that begins with this pose.
    pub fn tracker(&self, start: Pose) -> Result<Tracker, TrackError> {
        let mut fit = (*self.fit).clone();
        // Limbs are judged by likely poses even where these do not pull.
        fit.prior.get_or_insert_with(|| LearntPrior { pose_weight: 0.0, ..likely_poses::people() });
        let tracker = Tracker::new(self.model.clone(), fit, start)?;
        let tracker = tracker.with_motion(self.motion, self.frame_rate)?.with_search(self.search);
        let tracker = tracker.with_rivals(self.rivals).with_trust();
        Ok(match &self.cues[..] {
            [] => tracker,
            cues => tracker.with_cues(CueOptions::default().only(cues))?,
        })
    }

    /// Whether poses that are found elsewhere are followed back to mend earlier frames: not where a filter or cues carry what was
    /// seen before.
    pub fn rewinds(&self) -> bool {
        self.rivals > 0 && self.cues.is_empty() && !matches!(self.motion, Motion::Kalman(_))
    }

    /// Tracks some frames once to find the noise that makes them most likely. `None` if there are too few of them, or the run
    /// was cancelled.
    pub fn tune<R: FrameReader>(
        &self,
        reader: Arc<R>,
        noise: KalmanOptions,
        cancel: &CancelToken,
        mut on_frame: impl FnMut(&FrameEstimate),
    ) -> Result<Option<Tuned>, TrackEnding> {
        let mut plan =
            Self { motion: Motion::Kalman(noise), cues: Vec::new(), smoothing: None, ..self.clone() };
        plan.legs.iter_mut().for_each(|leg| leg.frames.truncate(TUNED_FRAMES));
        let (mut run, mut track, mut ending) = (TrackRun::new(reader, plan), Track::default(), None);
        while ending.is_none() {
            run.step(cancel, &mut |message| match message {
                TrackMessage::Frame { estimate, .. } => {
                    on_frame(&estimate);
                    track.frames.insert(estimate.frame, *estimate);
                }
                TrackMessage::Done(how) => ending = Some(how),
                _ => {}
            });
        }
        match ending {
            Some(TrackEnding::Whole) | None => Ok(tune(&track, noise)),
            Some(other) => Err(other),
        }
    }
}
