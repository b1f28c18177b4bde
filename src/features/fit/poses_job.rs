//! The search for other poses that fit one frame.

use backlit_tracking::body::Pose;
use backlit_tracking::search::{self, SearchOptions};

use crate::session::prediction::FitInputs;
use crate::worker::{Event, Job, Outbox, Step};

/// A search to be made.
#[derive(Debug)]
pub struct PosesJob {
    /// The frame's data and the choices of the fit.
    pub scene: FitInputs,
    /// Where it begins.
    pub start: Pose,
}

impl Job<Event> for PosesJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let scene = &self.scene;
        let Some(frame) = scene.frame.as_ref().map(|frame| frame.frame) else { return Step::Done };
        let (effort, views) = (SearchOptions::default(), scene.views());
        match search::search(&scene.model, views, &self.start, &scene.fit, &effort, out.cancel()) {
            // Half a search has looked at half of the body.
            Ok(_) if out.cancel().is_cancelled() => {}
            Ok(found) => out.send(Event::PosesFound(frame, found.found)),
            Err(error) => out.send(Event::Failed(format!("Other poses cannot be looked for: {error}."))),
        }
        Step::Done
    }
}
