//! The fit of the body's own sizes to several frames: one frame is read a step, then all are fitted at once.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_jobs::{Job, Outbox, Step};
use backlit_take::footage::Footage;
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::{BodyFitError, BodyFitOptions, BodyFrame, CLOTHED, fit_body};
use backlit_tracking::segment::SegmentOptions;

use super::Found;
use crate::session::load_frame;
use crate::session::prediction::FitInputs;

/// A body to be fitted to frames with poses near theirs.
#[derive(Debug)]
pub(super) struct BodyJob {
    pub(super) footage: Arc<Footage>,
    pub(super) measurement: Arc<Vec<SegmentOptions>>,
    pub(super) fit: FitInputs,
    /// Frames that are still to be read, each with its pose.
    pub(super) waiting: VecDeque<(usize, Pose)>,
    pub(super) read: Vec<BodyFrame>,
}

impl Job<Found> for BodyJob {
    fn step(&mut self, out: &Outbox<Found>) -> Step {
        if out.cancel().is_cancelled() {
            return Step::Done;
        }
        if let Some((frame, start)) = self.waiting.pop_front() {
            self.fit.frame = Some(Arc::new(load_frame(&self.footage, &self.measurement, frame)));
            self.read.push(BodyFrame { frame, views: self.fit.views(), start, joints: Vec::new() });
            return Step::Again;
        }
        let frames = std::mem::take(&mut self.read);
        let options = BodyFitOptions::default().with_proportions(CLOTHED);
        match fit_body(self.fit.model.clone(), frames, None, &options, out.cancel(), |_| {}) {
            Ok(fit) => out.send(Found::Body(Box::new(fit))),
            Err(BodyFitError::Cancelled) => {}
            Err(error) => out.send(Found::Refused(format!("The body cannot be fitted: {error}."))),
        }
        Step::Done
    }
}
