//! A body from several frames with poses: one frame is read a step, then all are used at once.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_jobs::{Job, Outbox, Step};
use backlit_take::footage::Footage;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::body_fit::{BodyFitError, BodyFitOptions, BodyFrame, CLOTHED, fit_body};
use backlit_tracking::body_spheres::PosedViews;
use backlit_tracking::segment::SegmentOptions;

use super::Found;
use crate::session::load_frame;
use crate::session::prediction::FitInputs;

/// Frames with poses, of which a body is made.
#[derive(Debug)]
pub(super) struct BodyJob {
    pub(super) footage: Arc<Footage>,
    pub(super) measurement: Arc<Vec<SegmentOptions>>,
    pub(super) fit: FitInputs,
    /// Frames that are still to be read, each with its pose.
    pub(super) waiting: VecDeque<(usize, Pose)>,
    pub(super) read: Vec<PosedViews>,
    /// Makes a body of this one, and says what came of it.
    pub(super) make: fn(&Arc<Model>, Vec<PosedViews>, &Outbox<Found>),
}

impl Job<Found> for BodyJob {
    fn step(&mut self, out: &Outbox<Found>) -> Step {
        if out.cancel().is_cancelled() {
            return Step::Done;
        }
        if let Some((frame, pose)) = self.waiting.pop_front() {
            self.fit.frame = Some(Arc::new(load_frame(&self.footage, &self.measurement, frame)));
            self.read.push(PosedViews { frame, views: self.fit.views(), pose });
            return Step::Again;
        }
        (self.make)(&self.fit.model, std::mem::take(&mut self.read), out);
        Step::Done
    }
}

/// The body's own lengths and radii.
pub(super) fn sizes(model: &Arc<Model>, frames: Vec<PosedViews>, out: &Outbox<Found>) {
    let start =
        |PosedViews { frame, views, pose }| BodyFrame { frame, views, start: pose, joints: Vec::new() };
    let frames = frames.into_iter().map(start).collect();
    let options = BodyFitOptions::default().with_proportions(CLOTHED);
    match fit_body(Arc::clone(model), frames, None, &options, out.cancel(), |_| {}) {
        Ok(fit) => out.send(Found::Body(Box::new(fit))),
        Err(BodyFitError::Cancelled) => {}
        Err(error) => out.send(Found::Refused(format!("The body cannot be fitted: {error}."))),
    }
}
