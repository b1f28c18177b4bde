//! The fit of the body's own sizes to several frames: one frame is read a step, then all are fitted at once.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::{BodyFitError, BodyFitOptions, BodyFrame, CLOTHED, fit_body};
use backlit_tracking::segment::SegmentOptions;

use crate::app::load_job::load_frame;
use crate::session::prediction::FitInputs;
use crate::take::footage::Footage;
use crate::worker::{Event, Job, Outbox, Step};

/// A body to be fitted.
#[derive(Debug)]
pub struct BodyJob {
    footage: Arc<Footage>,
    measurement: Arc<Vec<SegmentOptions>>,
    scene: FitInputs,
    waiting: VecDeque<(usize, Pose)>,
    read: Vec<BodyFrame>,
}

impl BodyJob {
    /// Fits the scene's body to frames with poses near theirs.
    #[must_use]
    pub fn new(
        footage: Arc<Footage>,
        measurement: Arc<Vec<SegmentOptions>>,
        scene: FitInputs,
        frames: Vec<(usize, Pose)>,
    ) -> Self {
        Self { footage, measurement, scene, waiting: frames.into(), read: Vec::new() }
    }
}

impl Job<Event> for BodyJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if out.cancel().is_cancelled() {
            return Step::Done;
        }
        if let Some((frame, start)) = self.waiting.pop_front() {
            self.scene.frame = Some(Arc::new(load_frame(&self.footage, &self.measurement, frame)));
            self.read.push(BodyFrame { frame, views: self.scene.views(), start, joints: Vec::new() });
            return Step::Again;
        }
        let frames = std::mem::take(&mut self.read);
        let options = BodyFitOptions::default().with_proportions(CLOTHED);
        match fit_body(self.scene.model.clone(), frames, None, &options, out.cancel(), |_| {}) {
            Ok(fit) => out.send(Event::BodyFitted(Box::new(fit))),
            Err(BodyFitError::Cancelled) => {}
            Err(error) => out.send(Event::Failed(format!("The body cannot be fitted: {error}."))),
        }
        Step::Done
    }
}
