//! Reading and segmenting a frame, its cameras shared out among threads.

use std::sync::Arc;

use backlit_tracking::segment::SegmentOptions;
use rayon::prelude::*;

use crate::session::FrameData;
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

/// A frame. The result does not depend on how the cameras are shared out.
pub(crate) fn load_frame(
    footage: &Footage,
    measurement: &Arc<Vec<SegmentOptions>>,
    frame: usize,
) -> FrameData {
    let load = |camera: usize| {
        let options = measurement.get(camera).cloned().unwrap_or_default();
        footage.load(camera, frame, &options)
    };
    let cameras = (0..footage.cameras.len()).into_par_iter().map(load).collect();
    FrameData { frame, cameras, made_with: footage.made_with(measurement, frame) }
}
