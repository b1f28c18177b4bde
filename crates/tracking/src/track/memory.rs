//! What a tracker knows after a frame, apart from what it was made with: enough to go on as if nothing had stopped it.

use thiserror::Error;

use super::beam::{Beam, Rival};
use super::estimate::FrameEstimate;
use super::lost::UsualCost;
use super::motion::{FrameBelief, KalmanOptions, Motion, MotionError, MotionModel, Predicted};
use super::patience::{CONFUSION, LAST_RESORT, Patience, RESEEDING};
use super::tracker::{Tracker, watched};
use crate::body::{Model, Parameters, Pose, PoseError};
use crate::cues::{CueMemory, CueWatch, FrameCues};
use crate::filter::Belief;
use crate::fit::FitView;
use crate::numbers::Brief;

/// Nobody carries more rivals.
const MOST_RIVALS: usize = 64;
/// Larger numbers than this are nobody's velocity or covariance.
const LARGEST: f64 = 1e12;

/// What a [`Tracker`] knows after a frame. Together with its options it decides all that follows.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackerMemory {
    /// The frame.
    pub last: LastFrame,
    /// What cost is usual.
    pub usual: UsualCost,
    /// When a lost frame is looked for everywhere again.
    pub last_resort: Patience,
    /// Whether a pose to start from was ever known.
    pub has_start: bool,
    /// What a Kalman filter believes; `None` without one.
    pub filter: Option<FilterMemory>,
    /// What cues have learnt; `None` without them.
    pub cues: Option<CueMemory>,
    /// What is carried beside the leading hypothesis.
    pub beam: Beam,
}

/// The frame before, and where its motion leads.
#[derive(Debug, Clone, PartialEq)]
pub struct LastFrame {
    /// Its number.
    pub frame: usize,
    /// As it was fitted, before any filter.
    pub pose: Pose,
    /// Whether the subject was lost there.
    pub lost: bool,
    /// Tangent units per second, where the motion goes on from the frame before that.
    pub velocity: Option<Vec<f64>>,
}

impl LastFrame {
    /// Where the motion leads in this many seconds, negative backwards.
    pub(super) fn leads_to(&self, seconds: f64) -> Pose {
        match &self.velocity {
            Some(velocity) => {
                let step: Vec<f64> = velocity.iter().map(|value| value * seconds).collect();
                self.pose.retract(Parameters::Tangent, &step)
            }
            None => self.pose.clone(),
        }
    }

    /// The velocity that leads to a pose in this many seconds.
    pub(super) fn velocity_to(&self, pose: &Pose, seconds: f64) -> Vec<f64> {
        pose.local(&self.pose).into_iter().map(|value| value / seconds).collect()
    }
}

/// What a Kalman filter believes after a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterMemory {
    /// Its noise.
    pub noise: KalmanOptions,
    /// The mean pose.
    pub pose: Pose,
    /// Velocity and covariance.
    pub belief: Belief,
}

/// A frame that waits to be smoothed by later ones, as the filter left it.
#[derive(Debug, Clone, PartialEq)]
pub struct WaitingFrame {
    /// Its number.
    pub frame: usize,
    /// The mean pose.
    pub pose: Pose,
    /// Velocity and covariance; `None` where no filter looked at it.
    pub belief: Option<Belief>,
    /// Whether the filter went on from the frame before; else it began again here.
    pub goes_on: bool,
}

/// Why a tracker cannot go on from what another one knew.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum MemoryError {
    #[error("`{field}`: {error}")]
    Pose { field: String, error: PoseError },
    #[error("`{field}` has {found} numbers; expected {expected}")]
    Count { field: String, found: usize, expected: usize },
    #[error("`{field}` is {}; expected {expected}", Brief(*.value))]
    Number { field: String, value: f64, expected: &'static str },
    #[error("`filter.noise`: {0}")]
    Noise(MotionError),
    #[error("it was tracked {} a Kalman filter; expected the same `motion`", if *.with { "with" } else { "without" })]
    Filter { with: bool },
    #[error("it was tracked {} cues of pictures; expected the same `cues`", if *.with { "with" } else { "without" })]
    Cues { with: bool },
}

impl Tracker {
    /// What it knows after its last frame; `None` before the first.
    #[must_use]
    pub fn memory(&self) -> Option<TrackerMemory> {
        Some(TrackerMemory {
            last: self.last.clone()?,
            usual: self.usual.clone(),
            last_resort: self.last_resort,
            has_start: self.start.is_some(),
            filter: self.filter.clone(),
            cues: self.cues.as_ref().map(CueWatch::memory),
            beam: self.beam.clone(),
        })
    }

    /// Goes on from what another tracker of the same options [knew](Self::memory), to the bit as if this one had followed its
    /// frames. A Kalman filter keeps the noise that it had. What flow needs besides is told by
    /// [`with_pictures_before`](Self::with_pictures_before); what edges have learnt is not remembered.
    ///
    /// # Errors
    /// What does not fit the body or these options.
    pub fn with_memory(mut self, memory: TrackerMemory) -> Result<Self, MemoryError> {
        memory.check(&self.model)?;
        let TrackerMemory { last, usual, last_resort, has_start, filter, cues, beam } = memory;
        if filter.is_some() != matches!(self.motion, Motion::Kalman(_)) {
            return Err(MemoryError::Filter { with: filter.is_some() });
        }
        match (cues, &mut self.cues) {
            (Some(memory), Some(watch)) => watch.remember(&memory),
            (None, None) => {}
            (cues, _) => return Err(MemoryError::Cues { with: cues.is_some() }),
        }
        if let Some(FilterMemory { noise, .. }) = filter {
            self.motion = Motion::Kalman(noise);
        }
        self.filter = filter;
        self.start = has_start.then(|| last.pose.clone());
        (self.last, self.usual, self.last_resort, self.beam) = (Some(last), usual, last_resort, beam);
        Ok(self)
    }

    /// Shows a tracker [with a memory](Self::with_memory) the pictures of its last frame, which flow compares with the next
    /// one's.
    #[must_use]
    pub fn with_pictures_before(mut self, views: &[FitView], cues: FrameCues) -> Self {
        if let Some(watch) = &mut self.cues {
            let (cameras, cues) = watched(views, cues);
            watch.see_before(&cameras, &cues);
        }
        self
    }
}

impl TrackerMemory {
    /// First thing that does not fit a body, by field.
    ///
    /// # Errors
    /// As it says.
    pub fn check(&self, model: &Model) -> Result<(), MemoryError> {
        let columns = Parameters::Tangent.columns(model.rotation_count());
        check_pose("pose", &self.last.pose, model)?;
        if let Some(velocity) = &self.last.velocity {
            check_numbers("velocity", velocity.iter(), columns)?;
        }
        if self.beam.rivals.len() > MOST_RIVALS {
            let (field, found) = ("rivals".to_owned(), self.beam.rivals.len());
            return Err(MemoryError::Count { field, found, expected: MOST_RIVALS });
        }
        for Rival { last, behind } in &self.beam.rivals {
            check_pose("rivals", &last.pose, model)?;
            last.velocity.as_ref().map_or(Ok(()), |all| check_numbers("rivals", all.iter(), columns))?;
            check_numbers("rivals", [behind].into_iter(), 1)?;
        }
        if let Some((value, expected)) = self.usual.wrong() {
            return Err(MemoryError::Number { field: "usual_rms".to_owned(), value, expected });
        }
        for (field, patience, rarest) in [
            ("last_resort", self.last_resort, LAST_RESORT),
            ("patience", self.beam.reseeds, RESEEDING),
            ("patience", self.beam.confusions, CONFUSION),
        ] {
            if let Some((value, expected)) = patience.wrong(rarest) {
                return Err(MemoryError::Number { field: field.to_owned(), value, expected });
            }
        }
        if let Some(FilterMemory { noise, pose, belief }) = &self.filter {
            noise.check().map_err(MemoryError::Noise)?;
            check_pose("filter.pose", pose, model)?;
            check_belief("filter", belief, columns)?;
        }
        let Some(CueMemory { offsets, before }) = &self.cues else { return Ok(()) };
        if let Some(before) = before {
            check_pose("cues.before", before, model)?;
        }
        let limbs = model.limbs().len();
        if offsets.len() != limbs {
            let field = "cues.offsets".to_owned();
            return Err(MemoryError::Count { field, found: offsets.len(), expected: limbs });
        }
        check_numbers("cues.offsets", offsets.iter().flatten(), 12 * limbs)
    }
}

impl WaitingFrame {
    /// First thing that does not fit a body, by field.
    ///
    /// # Errors
    /// As it says.
    pub fn check(&self, model: &Model) -> Result<(), MemoryError> {
        let at = format!("waiting.{}", self.frame);
        check_pose(&at, &self.pose, model)?;
        let columns = Parameters::Tangent.columns(model.rotation_count());
        self.belief.as_ref().map_or(Ok(()), |belief| check_belief(&at, belief, columns))
    }
}

/// These frames as they were when they began to wait: `known` is what else is known of each, in the same order.
pub(super) fn waiting_again(
    known: Vec<FrameEstimate>,
    waiting: Vec<WaitingFrame>,
    motion: &MotionModel,
    frame_seconds: f64,
) -> Vec<FrameEstimate> {
    let mut before: Option<(usize, Pose, Belief)> = None;
    let again = |(estimate, waiting): (FrameEstimate, WaitingFrame)| {
        let WaitingFrame { frame, pose, belief, goes_on } = waiting;
        let prediction = before.take().filter(|_| goes_on).map(|(last, pose, belief)| {
            let seconds = (frame as f64 - last as f64) * frame_seconds;
            Predicted::after(motion.clone(), &pose, &belief, seconds)
        });
        before = belief.clone().map(|belief| (frame, pose.clone(), belief));
        let believed = |belief| FrameBelief {
            belief,
            predicted: prediction,
            innovation: None,
            begins: None,
            measurement: None,
        };
        let belief = belief.map(believed);
        FrameEstimate { pose, belief, ..estimate }
    };
    known.into_iter().zip(waiting).map(again).collect()
}

fn check_pose(field: &str, pose: &Pose, model: &Model) -> Result<(), MemoryError> {
    pose.check(model).map_err(|error| MemoryError::Pose { field: field.to_owned(), error })
}

fn check_belief(field: &str, belief: &Belief, columns: usize) -> Result<(), MemoryError> {
    check_numbers(&format!("{field}.velocity"), belief.velocity.iter(), columns)?;
    let covariance = &belief.covariance;
    check_numbers(&format!("{field}.covariance"), covariance.iter(), 4 * columns * columns)?;
    check_numbers(&format!("{field}.covariance"), covariance.column(0).iter(), 2 * columns)
}

fn check_numbers<'a>(
    field: &str,
    mut numbers: impl Iterator<Item = &'a f64> + Clone,
    expected: usize,
) -> Result<(), MemoryError> {
    let field = field.to_owned();
    let found = numbers.clone().count();
    if found != expected {
        return Err(MemoryError::Count { field, found, expected });
    }
    match numbers.find(|number| number.is_nan() || number.abs() > LARGEST) {
        Some(&value) => Err(MemoryError::Number { field, value, expected: "a number of at most 1e12" }),
        None => Ok(()),
    }
}
