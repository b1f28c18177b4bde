//! The fit of frame after frame, one frame a step: one way through the take, or from two key poses towards each
//! other.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use backlit_tracking::body::Pose;
use backlit_tracking::fit::FitError;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::join::{self, Source};
use backlit_tracking::track::{FrameEstimate, Track, Tracker, smoothed};

use super::read_ahead::ReadAhead;
use crate::app::load_job::load_frame;
use crate::document::tracking_choices::{Following, TrackingChoices};
use crate::document::{Estimate, Origin};
use crate::session::FrameData;
use crate::session::prediction::FitInputs;
use crate::take::footage::Footage;
use crate::worker::{Event, Job, Outbox, Step};

/// A way through the take.
#[derive(Debug, Clone)]
pub struct Leg {
    /// The pose before its first frame is fitted.
    pub start: Pose,
    /// The neighbour of the first frame whose fitted pose the start is, if it is one.
    pub continues: Option<usize>,
    /// The frames in their order.
    pub frames: VecDeque<usize>,
}

/// A run of the tracker.
#[derive(Debug)]
pub struct TrackJob {
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
    scene: FitInputs,
    choices: TrackingChoices,
    keys: Arc<BTreeMap<usize, Pose>>,
    /// The leg that is being tracked first.
    legs: VecDeque<Leg>,
    tracker: Option<Tracker>,
    reader: Option<ReadAhead>,
    /// Of the leg that is being tracked: what smoothing or joining still needs.
    kept: Track,
    /// The frames that are kept, in the order in which they were tracked.
    order: VecDeque<usize>,
    /// Legs that are whole, if they are to be joined.
    whole: Vec<Track>,
    joins: bool,
}

impl TrackJob {
    /// Tracks the legs one after the other. A key pose on the way is where its frame's fit begins. Two legs are
    /// tracks of the same frames from both sides, which are joined.
    #[must_use]
    pub fn new(
        footage: Arc<Footage>,
        measurement: Arc<Vec<SegmentOptions>>,
        scene: FitInputs,
        choices: TrackingChoices,
        keys: Arc<BTreeMap<usize, Pose>>,
        legs: Vec<Leg>,
    ) -> Self {
        Self {
            footage,
            measurement,
            scene,
            choices,
            keys,
            joins: legs.len() > 1,
            legs: legs.into(),
            tracker: None,
            reader: None,
            kept: Track::default(),
            order: VecDeque::new(),
            whole: Vec::new(),
        }
    }

    fn new_tracker(&self, start: Pose) -> Result<Tracker, FitError> {
        let tracker = Tracker::new(self.scene.model.clone(), (*self.scene.fit).clone(), start)?;
        let motion = self.choices.motion.motion();
        Ok(tracker.with_motion(motion, self.footage.frame_rate).with_search(self.choices.search))
    }

    /// The frame's pictures, read ahead if a thread for that was to be had.
    fn data(&mut self, frame: usize) -> Arc<FrameData> {
        if self.reader.is_none() {
            let frames = self.legs.iter().flat_map(|leg| leg.frames.iter().copied());
            let order: Vec<usize> = std::iter::once(frame).chain(frames).collect();
            let (footage, measurement) = (self.footage.clone(), self.measurement.clone());
            self.reader = ReadAhead::start(footage, measurement, order).ok();
        }
        let read = self.reader.as_ref().and_then(ReadAhead::next).filter(|data| data.frame == frame);
        read.unwrap_or_else(|| Arc::new(load_frame(&self.footage, &self.measurement, frame)))
    }

    fn track(&mut self, frame: usize, out: &Outbox<Event>) -> Result<FrameEstimate, FitError> {
        let data = self.data(frame);
        self.scene.frame = Some(data.clone());
        out.send(Event::FrameLoaded(data));
        if let Some(key) = self.keys.get(&frame) {
            self.tracker = Some(self.new_tracker(key.clone())?);
        }
        if self.tracker.is_none()
            && let Some(leg) = self.legs.front()
        {
            let tracker = self.new_tracker(leg.start.clone())?;
            let continues = leg.continues;
            self.tracker = Some(match continues {
                Some(neighbour) => tracker.continuing_from(neighbour),
                None => tracker,
            });
        }
        let views = self.scene.views();
        match &mut self.tracker {
            Some(tracker) => tracker.track_frame(frame, views, out.cancel()),
            None => Err(FitError::NoData { reasons: "there is no pose to begin with".to_owned() }),
        }
    }

    /// Keeps what is needed later, and sends what is known of earlier frames by now.
    fn keep(&mut self, found: FrameEstimate, out: &Outbox<Event>) {
        if self.joins {
            self.kept.frames.insert(found.frame, found);
            return;
        }
        let Following::Smoothed { lag } = self.choices.motion else { return };
        self.order.push_back(found.frame);
        self.kept.frames.insert(found.frame, found);
        if lag.is_some_and(|lag| self.order.len() > lag)
            && let Some(first) = self.order.pop_front()
        {
            let smoothed = smoothed(&self.kept, None);
            out.send(Event::TrackRevised(smoothed.frames.get(&first).map(revised).into_iter().collect()));
            self.kept.frames.remove(&first);
        }
    }

    /// A leg is over, or the user has stopped it.
    fn end_leg(&mut self, out: &Outbox<Event>) {
        let mut track = std::mem::take(&mut self.kept);
        if let Following::Smoothed { lag } = self.choices.motion {
            track = smoothed(&track, lag);
            if !track.frames.is_empty() {
                out.send(Event::TrackRevised(track.frames.values().map(revised).collect()));
            }
        }
        self.order.clear();
        self.tracker = None;
        self.whole.push(track);
    }

    /// Joins the two legs. What lies between them is fitted again.
    fn join(&self, out: &Outbox<Event>) {
        let [forward, backward] = &self.whole[..] else { return };
        let Some(join) = join::join(&self.scene.model, forward, backward) else { return };
        let mut scene = self.scene.clone();
        let mut found = Vec::with_capacity(join.sources.len());
        for (frame, source) in &join.sources {
            if out.cancel().is_cancelled() {
                return;
            }
            let (from, to) = (forward.frames.get(frame), backward.frames.get(frame));
            let best = || from.into_iter().chain(to).min_by(|a, b| a.cost.total_cmp(&b.cost));
            found.extend(match source {
                Source::Forward => from.map(revised),
                Source::Backward => to.map(revised),
                Source::Blended(pose) => {
                    scene.frame = Some(Arc::new(load_frame(&self.footage, &self.measurement, *frame)));
                    let again = self.new_tracker(pose.clone()).and_then(|tracker| {
                        let mut tracker = tracker.continuing_from(frame.saturating_sub(1));
                        tracker.track_frame(*frame, scene.views(), out.cancel())
                    });
                    match again {
                        Ok(again) if !again.is_lost() => Some(revised(&again)),
                        _ => best().map(revised),
                    }
                }
            });
        }
        out.send(Event::TrackRevised(found));
        let meets = join.meets();
        out.send(Event::TracksJoined { frame: join.frame, distance_m: join.distance_m, meets });
    }

    fn next_frame(&mut self) -> Option<usize> {
        self.legs.front_mut()?.frames.pop_front()
    }
}

impl Job<Event> for TrackJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if out.cancel().is_cancelled() {
            self.end_leg(out);
            return Step::Done;
        }
        let Some(frame) = self.next_frame() else {
            self.end_leg(out);
            self.legs.pop_front();
            if !self.legs.is_empty() {
                return Step::Again;
            }
            if self.joins {
                self.join(out);
            }
            return Step::Done;
        };
        match self.track(frame, out) {
            // What a cancelled fit leaves is half a fit.
            Ok(_) if out.cancel().is_cancelled() => {}
            Ok(found) => {
                out.send(Event::FrameTracked(frame, estimate(&found)));
                if !found.hypotheses.is_empty() {
                    out.send(Event::PosesFound(frame, found.hypotheses.clone()));
                }
                self.keep(found, out);
            }
            Err(error) => {
                out.send(Event::Failed(format!("The tracker stopped at frame {frame}: {error}.")));
                self.end_leg(out);
                return Step::Done;
            }
        }
        Step::Again
    }
}

fn revised(found: &FrameEstimate) -> (usize, Arc<Estimate>) {
    (found.frame, estimate(found))
}

/// What the document keeps of it.
fn estimate(found: &FrameEstimate) -> Arc<Estimate> {
    Arc::new(Estimate {
        iou: found.iou(),
        pose: found.pose.clone(),
        origin: Origin::Track,
        cost: found.cost,
        rms: found.rms,
        steps: found.iterations,
        lost: found.is_lost(),
    })
}
