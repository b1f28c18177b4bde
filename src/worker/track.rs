//! The fit of frame after frame, one frame a step.

use std::collections::BTreeMap;
use std::collections::VecDeque;
use std::sync::Arc;

use backlit_tracking::body::Pose;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::{FitError, Tracker};

use super::load::load_frame;
use super::{Event, Job, Outbox, Scene, Step};
use crate::document::{Estimate, Origin};
use crate::footage::Footage;

/// A run of the tracker.
#[derive(Debug)]
pub struct TrackJob {
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
    scene: Scene,
    tracker: Tracker,
    keys: Arc<BTreeMap<usize, Pose>>,
    frames: VecDeque<usize>,
}

impl TrackJob {
    /// Tracks `frames` in their order, from `start`. A key pose on the way is where its frame's fit begins.
    ///
    /// # Errors
    /// A pose or choices that make no sense.
    pub fn new(
        footage: Arc<Footage>,
        measurement: Arc<Vec<SegmentOptions>>,
        scene: Scene,
        start: Pose,
        keys: Arc<BTreeMap<usize, Pose>>,
        frames: VecDeque<usize>,
    ) -> Result<Self, FitError> {
        let tracker = Tracker::new(scene.model.clone(), (*scene.fit).clone(), start)?;
        Ok(Self { footage, measurement, scene, tracker, keys, frames })
    }

    /// Says that the start is the fitted pose of this frame, a neighbour of the first one.
    #[must_use]
    pub fn continuing_from(mut self, frame: usize) -> Self {
        self.tracker = self.tracker.continuing_from(frame);
        self
    }

    fn track(&mut self, frame: usize, out: &Outbox<Event>) -> Result<Arc<Estimate>, FitError> {
        let data = Arc::new(load_frame(&self.footage, &self.measurement, frame));
        self.scene.frame = Some(data.clone());
        out.send(Event::FrameLoaded(data));
        if let Some(key) = self.keys.get(&frame) {
            let options = (*self.scene.fit).clone();
            self.tracker = Tracker::new(self.scene.model.clone(), options, key.clone())?;
        }
        let found = self.tracker.track_frame(frame, self.scene.views(), out.cancel())?;
        Ok(Arc::new(Estimate {
            iou: found.iou(),
            pose: found.pose,
            origin: Origin::Track,
            cost: found.cost,
            rms: found.rms,
            steps: found.iterations,
            lost: found.lost,
        }))
    }
}

impl Job<Event> for TrackJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let Some(frame) = self.frames.pop_front() else { return Step::Done };
        if out.cancel().is_cancelled() {
            return Step::Done;
        }
        match self.track(frame, out) {
            // What a cancelled fit leaves is half a fit.
            Ok(_) if out.cancel().is_cancelled() => return Step::Done,
            Ok(estimate) => out.send(Event::FrameTracked(frame, estimate)),
            Err(error) => {
                out.send(Event::Failed(format!("The tracker stopped at frame {frame}: {error}")));
                return Step::Done;
            }
        }
        if self.frames.is_empty() { Step::Done } else { Step::Again }
    }
}
