//! Reading and segmenting a frame, one camera a step.

use std::sync::Arc;

use backlit_tracking::segment::SegmentOptions;

use super::{Event, Job, Outbox, Step};
use crate::footage::{CameraFrame, Footage};
use crate::session::FrameData;

/// A frame to be loaded.
#[derive(Debug)]
pub struct LoadJob {
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
    frame: usize,
    cameras: Vec<CameraFrame>,
}

impl LoadJob {
    /// All cameras' pictures of a frame.
    #[must_use]
    pub fn new(footage: Arc<Footage>, measurement: Arc<Vec<SegmentOptions>>, frame: usize) -> Self {
        Self { footage, measurement, frame, cameras: Vec::new() }
    }
}

impl Job<Event> for LoadJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if out.cancel().is_cancelled() {
            return Step::Done;
        }
        self.cameras.push(load(&self.footage, &self.measurement, self.cameras.len(), self.frame));
        if self.cameras.len() < self.footage.cameras.len() {
            return Step::Again;
        }
        let cameras = std::mem::take(&mut self.cameras);
        let made_with = self.footage.made_with(&self.measurement, self.frame);
        out.send(Event::FrameLoaded(Arc::new(FrameData { frame: self.frame, cameras, made_with })));
        Step::Done
    }
}

/// One camera of a frame.
fn load(footage: &Footage, measurement: &[SegmentOptions], camera: usize, frame: usize) -> CameraFrame {
    let options = measurement.get(camera).cloned().unwrap_or_default();
    footage.load(camera, frame, &options)
}

/// A frame at once, for the tracker.
pub(super) fn load_frame(
    footage: &Footage,
    measurement: &Arc<Vec<SegmentOptions>>,
    frame: usize,
) -> FrameData {
    let cameras = (0..footage.cameras.len()).map(|camera| load(footage, measurement, camera, frame));
    FrameData { frame, cameras: cameras.collect(), made_with: footage.made_with(measurement, frame) }
}
