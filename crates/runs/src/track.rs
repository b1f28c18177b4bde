//! A track run: frame after frame of a take is read, segmented and fitted, in one direction, or from two key poses towards
//! each other. The command line and the inspector both drive it and hear of it by [`TrackMessage`]s.

mod plan;
mod reading;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::convert::Infallible;
use std::sync::Arc;

use backlit_formats::FootageError;
use backlit_formats::export::resume_file::{Resume, WaitingFrames};
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::survey::{self, Survey};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{Cue, FrameCues};
use backlit_tracking::fit::{FitError, FitView};
use backlit_tracking::numbers::OptionError;
use backlit_tracking::posing;
use backlit_tracking::track::join::{self, Source};
use backlit_tracking::track::{
    FrameEstimate, MemoryError, MotionError, REWOUND_FRAMES, Rewind, Smoother, SmoothingError, Track,
    Tracker, TrackerMemory, WaitingFrame,
};

pub use plan::{KeyUse, Leg, RIVALS, Smoothing, TrackPlan};
pub use reading::{FrameReader, ReadAhead, TakeReader};

/// What a run tells while it goes on.
#[derive(Debug)]
pub enum TrackMessage<F> {
    /// A frame was taken up: this was read of it.
    Taken(usize, Arc<F>),
    /// A frame was tracked. `is_final` is false where it will be smoothed by later frames.
    Frame {
        /// What was found.
        estimate: Box<FrameEstimate>,
        /// Whether no later frame smooths it.
        is_final: bool,
    },
    /// Frames that were tracked before are now smoothed by later ones.
    Revised(Vec<FrameEstimate>),
    /// A later frame has shown that the poses of these were wrong: here are better ones.
    Rewound(Vec<FrameEstimate>),
    /// Two tracks were joined.
    Joined {
        /// All their frames.
        estimates: Vec<FrameEstimate>,
        /// The last frame of the forward track.
        frame: usize,
        /// How far apart the joints of both tracks are there.
        distance_m: f64,
        /// Whether that is near enough to be one movement.
        meets: bool,
    },
    /// Frames cannot be smoothed.
    NotSmoothed(SmoothingError),
    /// The run is over.
    Done(TrackEnding),
}

/// How a run ends.
#[derive(Debug)]
pub enum TrackEnding {
    /// All frames were tracked.
    Whole,
    /// It was stopped.
    Cancelled,
    /// A frame cannot be tracked.
    Failed {
        /// The frame.
        frame: usize,
        /// Why.
        error: TrackError,
    },
}

/// Why frames cannot be tracked.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum TrackError {
    #[error(transparent)]
    Footage(#[from] FootageError),
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    Motion(#[from] MotionError),
    #[error(transparent)]
    Cues(#[from] OptionError),
    #[error(transparent)]
    Memory(#[from] MemoryError),
}

/// Frames of an earlier run that a track goes on from.
#[derive(Debug)]
pub struct EarlierFrames {
    /// What the tracker knew after its last frame.
    pub memory: TrackerMemory,
    /// The frames that waited to be smoothed, and what is known of them.
    pub waiting: Vec<(FrameEstimate, WaitingFrame)>,
    /// The newest frames and their poses, in the order of tracking: as many as may be mended by later ones.
    pub recent: VecDeque<(usize, Pose)>,
    /// How many frames a pose may still be followed back.
    pub rewind: usize,
}

/// Looks at the silhouettes of at most `most` of some frames. Frames that cannot be read count as empty: they are reported
/// when it is their turn.
pub fn survey<R: FrameReader>(reader: &R, frames: &[usize], most: usize, cancel: &CancelToken) -> Survey {
    let views = |frame: usize| -> Result<Vec<FitView>, Infallible> {
        let read = if cancel.is_cancelled() { None } else { reader.read(frame).ok() };
        Ok(read.map_or_else(Vec::new, |read| reader.views(&read)))
    };
    let Ok(found) = survey::survey(&survey::spread(frames, most), views);
    found
}

/// A track being made. It reads ahead on other threads and keeps the estimates of few frames.
#[derive(Debug)]
pub struct TrackRun<R: FrameReader> {
    reader: Arc<R>,
    plan: TrackPlan,
    tracker: Option<Tracker>,
    ahead: Option<ReadAhead<R>>,
    /// Of the leg that is being tracked, if it is to be joined with the other.
    kept: Track,
    /// Smooths the leg's frames by later ones, where that is asked for.
    smoother: Option<Smoother>,
    /// Legs that are whole, if they are to be joined.
    whole: Vec<Track>,
    joins: bool,
    /// Whether [`resume_point`](Self::resume_point) is asked for.
    remembers: bool,
    /// What the tracker knew after the newest frame.
    memory: Option<TrackerMemory>,
    /// The frames that waited when the rest was smoothed.
    waiting: Option<Vec<WaitingFrame>>,
    /// Frames that later ones may mend, in the order of tracking.
    recent: VecDeque<(usize, Pose)>,
    /// Whether the first of them is the first frame of the track.
    is_whole: bool,
    /// How many frames a pose may be followed back: as many as were tracked since, so that a track takes no more than twice the time.
    rewind: usize,
}

impl<R: FrameReader> TrackRun<R> {
    /// A run that has not begun.
    pub fn new(reader: Arc<R>, plan: TrackPlan) -> Self {
        Self {
            joins: plan.legs.len() > 1,
            smoother: plan.smoothing.map(|smoothing| Smoother::new(smoothing.lag)),
            reader,
            plan,
            tracker: None,
            ahead: None,
            kept: Track::default(),
            whole: Vec::new(),
            remembers: false,
            memory: None,
            waiting: None,
            recent: VecDeque::new(),
            is_whole: true,
            rewind: REWOUND_FRAMES,
        }
    }

    /// Takes another reader; of a run that has not begun.
    pub fn read_by(&mut self, reader: Arc<R>) {
        self.reader = reader;
    }

    /// Remembers after every frame what is needed to go on after it.
    pub fn remembering(self) -> Self {
        Self { remembers: true, ..self }
    }

    /// Goes on from the frames of an earlier run, as if nothing had stopped it.
    pub fn resuming(mut self, earlier: EarlierFrames) -> Result<Self, TrackError> {
        let Some(leg) = self.plan.legs.front() else { return Ok(self) };
        let EarlierFrames { memory, waiting, recent, rewind } = earlier;
        self.is_whole = recent.len() < REWOUND_FRAMES;
        (self.recent, self.rewind) = (recent, rewind);
        let last = memory.last.frame;
        let begins_flow = memory.cues.as_ref().is_some_and(|cues| cues.before.is_some());
        self.memory = Some(memory.clone());
        let mut tracker = self.plan.tracker(leg.start.clone())?.with_memory(memory)?;
        if begins_flow && self.plan.cues.iter().any(|cue| *cue != Cue::Keypoints) {
            let read = self.reader.read(last)?;
            tracker = tracker.with_pictures_before(&self.reader.views(&read), self.reader.cues(&read)?);
        }
        let motion = tracker.motion_model();
        self.tracker = Some(tracker);
        if let Some((smoother, motion)) = self.smoother.take().zip(motion) {
            let (known, waiting) = waiting.into_iter().unzip();
            self.smoother = Some(smoother.with_waiting(known, waiting, &motion, self.plan.frame_rate));
        }
        Ok(self)
    }

    /// What is needed to go on after the newest frame, if there is one.
    pub fn resume_point(&self) -> Option<Resume> {
        let waiting = self.waiting.clone().or_else(|| Some(self.smoother.as_ref()?.waiting()));
        let lag = self.plan.smoothing.and_then(|smoothing| smoothing.lag);
        let smoothing = waiting.map(|frames| WaitingFrames { lag, frames });
        Some(Resume { memory: self.memory.clone()?, smoothing, rewind: self.rewind })
    }

    /// Tracks the next frame, or ends. After [`TrackMessage::Done`] there is nothing left to do.
    pub fn step(&mut self, cancel: &CancelToken, tell: &mut impl FnMut(TrackMessage<R::Data>)) {
        if cancel.is_cancelled() {
            return self.end(TrackEnding::Cancelled, tell);
        }
        let Some(frame) = self.plan.legs.front_mut().and_then(|leg| leg.frames.pop_front()) else {
            self.end_leg(tell);
            self.plan.legs.pop_front();
            if self.plan.legs.is_empty() {
                if self.joins {
                    self.join(cancel, tell);
                }
                tell(TrackMessage::Done(TrackEnding::Whole));
            }
            return;
        };
        match self.read(frame, cancel) {
            Ok(read) => self.take_up(frame, &read, cancel, tell),
            Err(error) => self.end(TrackEnding::Failed { frame, error: error.into() }, tell),
        }
    }

    /// Tracks the next frame, which somebody else has read.
    pub fn step_with(
        &mut self,
        read: &Arc<R::Data>,
        cancel: &CancelToken,
        tell: &mut impl FnMut(TrackMessage<R::Data>),
    ) {
        if let Some(frame) = self.plan.legs.front_mut().and_then(|leg| leg.frames.pop_front()) {
            self.take_up(frame, read, cancel, tell);
        }
    }

    /// Ends the run: smooths what has not been smoothed yet.
    pub fn end(&mut self, ending: TrackEnding, tell: &mut impl FnMut(TrackMessage<R::Data>)) {
        self.end_leg(tell);
        tell(TrackMessage::Done(ending));
    }

    fn read(&mut self, frame: usize, cancel: &CancelToken) -> Result<Arc<R::Data>, FootageError> {
        let to_come = || self.plan.legs.iter().flat_map(|leg| leg.frames.iter().copied());
        let ahead = self.ahead.get_or_insert_with(|| {
            let order = std::iter::once(frame).chain(to_come()).collect();
            ReadAhead::new(self.reader.clone(), order, cancel.clone())
        });
        ahead.get(frame)
    }

    fn take_up(
        &mut self,
        frame: usize,
        read: &Arc<R::Data>,
        cancel: &CancelToken,
        tell: &mut impl FnMut(TrackMessage<R::Data>),
    ) {
        tell(TrackMessage::Taken(frame, read.clone()));
        match self.track(frame, read, cancel) {
            // A cancelled fit is not finished.
            Ok(_) if cancel.is_cancelled() => {}
            Ok(mut estimate) => {
                if estimate.cost.is_some() {
                    estimate.rms = self.reader.rms(read, &estimate.pose, estimate.rms);
                }
                match self.rewind(&estimate, cancel) {
                    // Nor is a frame whose pose was not followed back: who resumes tracks it again.
                    Ok(None) => {}
                    Ok(Some(mended)) => {
                        if self.remembers {
                            self.memory = self.tracker.as_ref().and_then(Tracker::memory);
                        }
                        self.keep(estimate, tell);
                        self.mend(mended, tell);
                    }
                    Err(error) => self.end(TrackEnding::Failed { frame, error }, tell),
                }
            }
            Err(error) => self.end(TrackEnding::Failed { frame, error }, tell),
        }
    }

    /// Follows a pose that was found elsewhere back through the frames before: better poses of these. `None` if it is cancelled;
    /// nothing is changed then.
    fn rewind(
        &mut self,
        found: &FrameEstimate,
        cancel: &CancelToken,
    ) -> Result<Option<Vec<FrameEstimate>>, TrackError> {
        if !self.plan.rewinds() {
            return Ok(Some(Vec::new()));
        }
        let (frame, mut left, mut mended) = (found.frame, self.rewind, Vec::new());
        if self.plan.at_keys == KeyUse::Keep && self.plan.keys.contains_key(&frame) {
            // What was set by hand stays, and so does what leads to it.
            self.recent.clear();
        } else if let Some((_, before)) = self.recent.back()
            && let Some(mut rewind) = Rewind::begin(|pose| self.plan.tracker(pose), found, before)?
        {
            let begins_here = |leg: &Leg| leg.continues.is_none();
            let mut reaches_first = self.is_whole && self.plan.legs.front().is_some_and(begins_here);
            for (frame, track) in self.recent.iter().rev() {
                if left == 0 {
                    reaches_first = false;
                    break;
                }
                left -= 1;
                let read = self.reader.read(*frame)?;
                let goes_on = rewind.step(*frame, self.reader.views(&read), track, cancel)?;
                if let Some(one) = rewind.found_in(*frame) {
                    one.rms = self.reader.rms(&read, &one.pose, one.rms);
                }
                if !goes_on {
                    reaches_first = false;
                    break;
                }
            }
            mended = rewind.finish(reaches_first);
        }
        if cancel.is_cancelled() {
            return Ok(None);
        }
        self.recent.push_back((frame, found.pose.clone()));
        self.rewind = (left + 1).min(REWOUND_FRAMES);
        if self.recent.len() > REWOUND_FRAMES {
            self.recent.pop_front();
            self.is_whole = false;
        }
        Ok(Some(mended))
    }

    /// Takes better poses of earlier frames, and tells of them.
    fn mend(&mut self, mended: Vec<FrameEstimate>, tell: &mut impl FnMut(TrackMessage<R::Data>)) {
        for one in &mended {
            if let Some((_, pose)) = self.recent.iter_mut().rev().find(|(frame, _)| *frame == one.frame) {
                pose.clone_from(&one.pose);
            }
            if self.joins {
                self.kept.frames.insert(one.frame, one.clone());
            }
        }
        if !mended.is_empty() {
            tell(TrackMessage::Rewound(mended));
        }
    }

    fn track(
        &mut self,
        frame: usize,
        read: &R::Data,
        cancel: &CancelToken,
    ) -> Result<FrameEstimate, TrackError> {
        let (plan, views) = (&self.plan, self.reader.views(read));
        if let Some(key) = plan.keys.get(&frame) {
            let start = match plan.at_keys {
                KeyUse::Keep => {
                    self.tracker = Some(plan.tracker(key.clone())?.continuing_from(frame));
                    let mut kept = FrameEstimate::of_pose(frame, key.clone());
                    kept.measure_overlap(&plan.model, plan.fit.renderer, &views);
                    return Ok(kept);
                }
                KeyUse::Begin => key.clone(),
                KeyUse::BeginTurned => posing::turn_round(&plan.model, key),
            };
            self.tracker = Some(plan.tracker(start)?);
        }
        if self.tracker.is_none()
            && let Some(leg) = plan.legs.front()
        {
            let tracker = plan.tracker(leg.start.clone())?;
            self.tracker = Some(match leg.continues {
                Some(neighbour) => tracker.continuing_from(neighbour),
                None => tracker,
            });
        }
        let cues = if plan.cues.is_empty() { FrameCues::default() } else { self.reader.cues(read)? };
        match &mut self.tracker {
            Some(tracker) => Ok(tracker.track_frame_with_cues(frame, views, cues, cancel)?),
            None => Err(FitError::NoData { reasons: "there is no pose to begin with".to_owned() }.into()),
        }
    }

    /// Tells of a frame, and of earlier ones that are smoothed by it.
    fn keep(&mut self, estimate: FrameEstimate, tell: &mut impl FnMut(TrackMessage<R::Data>)) {
        // A key pose that was set by hand is not smoothed.
        let is_key = self.plan.at_keys == KeyUse::Keep && self.plan.keys.contains_key(&estimate.frame);
        if self.joins && !is_key {
            let plain = FrameEstimate { belief: None, ..estimate.clone() };
            self.kept.frames.insert(plain.frame, plain);
        }
        let smoother = self.smoother.as_mut().filter(|_| !is_key);
        let (is_final, again) = (smoother.is_none(), smoother.map(|smoother| (smoother, estimate.clone())));
        tell(TrackMessage::Frame { estimate: Box::new(estimate), is_final });
        if let Some((smoother, estimate)) = again {
            let known = smoother.push(estimate);
            self.revise(known, tell);
        }
    }

    fn revise(
        &mut self,
        known: Result<Vec<FrameEstimate>, SmoothingError>,
        tell: &mut impl FnMut(TrackMessage<R::Data>),
    ) {
        match known {
            Err(error) => tell(TrackMessage::NotSmoothed(error)),
            Ok(known) if known.is_empty() => {}
            Ok(known) => {
                if self.joins {
                    self.kept.frames.extend(known.iter().map(|one| (one.frame, one.clone())));
                }
                tell(TrackMessage::Revised(known));
            }
        }
    }

    fn end_leg(&mut self, tell: &mut impl FnMut(TrackMessage<R::Data>)) {
        if let Some(mut smoother) = self.smoother.take() {
            self.waiting = self.remembers.then(|| smoother.waiting());
            self.revise(smoother.finish(), tell);
            self.smoother = self.plan.smoothing.map(|smoothing| Smoother::new(smoothing.lag));
        }
        self.tracker = None;
        self.recent.clear();
        (self.is_whole, self.rewind) = (true, REWOUND_FRAMES);
        self.whole.push(std::mem::take(&mut self.kept));
    }

    /// Joins the two legs. What lies between them is fitted again.
    fn join(&self, cancel: &CancelToken, tell: &mut impl FnMut(TrackMessage<R::Data>)) {
        let [forward, backward] = &self.whole[..] else { return };
        let Some((_, first)) = forward.frames.first_key_value() else { return };
        let Ok(tracker) = self.plan.tracker(first.pose.clone()) else { return };
        let behind = |frame: usize, poses: [&Pose; 2]| {
            let read = if cancel.is_cancelled() { None } else { self.reader.read(frame).ok() };
            let [forward, backward] = tracker.energies(&self.reader.views(&read?), poses)?;
            Some(forward - backward)
        };
        let join = join::join(&self.plan.model, self.plan.frame_rate, [forward, backward], behind);
        let Some(join) = join else { return };
        let mut joined = Vec::with_capacity(join.sources.len());
        for (frame, source) in &join.sources {
            if cancel.is_cancelled() {
                return;
            }
            let (from, to) = (forward.frames.get(frame), backward.frames.get(frame));
            let cost = |one: &FrameEstimate| one.cost.unwrap_or(f64::INFINITY);
            let best = || from.into_iter().chain(to).min_by(|a, b| cost(a).total_cmp(&cost(b)));
            joined.extend(match source {
                Source::Forward => from.cloned(),
                Source::Backward => to.cloned(),
                Source::Blended(pose) => match self.track_again(*frame, pose, cancel) {
                    Ok(again) if !again.is_lost() => Some(again),
                    _ => best().cloned(),
                },
            });
        }
        let (frame, distance_m, meets) = (join.frame, join.distance_m, join.meets());
        tell(TrackMessage::Joined { estimates: joined, frame, distance_m, meets });
    }

    fn track_again(
        &self,
        frame: usize,
        pose: &Pose,
        cancel: &CancelToken,
    ) -> Result<FrameEstimate, TrackError> {
        let read = self.reader.read(frame)?;
        let mut tracker = self.plan.tracker(pose.clone())?.continuing_from(frame.saturating_sub(1));
        let mut again = tracker.track_frame(frame, self.reader.views(&read), cancel)?;
        again.rms = self.reader.rms(&read, &again.pose, again.rms);
        Ok(again)
    }
}
