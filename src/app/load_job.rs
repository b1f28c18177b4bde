//! Reading and segmenting a frame for the window.

use std::sync::Arc;

use backlit_tracking::segment::SegmentOptions;

use crate::session::load_frame;
use crate::take::footage::Footage;
use crate::worker::{Event, Job, Outbox, Step};

/// A frame to be loaded.
#[derive(Debug)]
pub struct LoadJob {
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
    frame: usize,
}

impl LoadJob {
    /// All cameras' pictures of a frame.
    #[must_use]
    pub fn new(footage: Arc<Footage>, measurement: Arc<Vec<SegmentOptions>>, frame: usize) -> Self {
        Self { footage, measurement, frame }
    }
}

impl Job<Event> for LoadJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if !out.cancel().is_cancelled() {
            let data = load_frame(&self.footage, &self.measurement, self.frame);
            out.send(Event::FrameLoaded(Arc::new(data)));
        }
        Step::Done
    }
}
