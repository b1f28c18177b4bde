//! The visual hull of a frame, for the 3-D scene.

use std::sync::Arc;

use backlit_tracking::camera::Camera;
use backlit_tracking::visual_hull::{HullOptions, HullView, VisualHull};

use crate::session::FrameData;
use crate::worker::{Event, Job, Outbox, Step};

/// Carves the hull of one frame from the silhouettes of all cameras.
#[derive(Debug)]
pub struct HullJob {
    /// The cameras without distortion.
    pub cameras: Arc<Vec<Arc<Camera>>>,
    /// The frame.
    pub frame: Arc<FrameData>,
}

impl Job<Event> for HullJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let pairs = self.cameras.iter().zip(&self.frame.cameras);
        let views: Vec<_> = pairs
            .filter_map(|(camera, data)| {
                Some(HullView { camera: camera.as_ref(), silhouette: data.mask.as_deref()? })
            })
            .collect();
        let hull = VisualHull::carve(&views, &HullOptions::default(), out.cancel());
        if !out.cancel().is_cancelled() {
            out.send(Event::HullCarved(self.frame.clone(), hull.map(Arc::new)));
        }
        Step::Done
    }
}
