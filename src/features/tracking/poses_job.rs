//! The search for other poses that fit one frame.

use backlit_jobs::{Job, Outbox, Step};
use backlit_tracking::body::Pose;
use backlit_tracking::search::{self, Hypothesis, Origin, SearchOptions};

use super::Found;
use crate::session::prediction::FitInputs;

/// A pose that a search has found.
#[derive(Debug, Clone)]
pub(super) struct OtherPose {
    /// The pose.
    pub(super) pose: Pose,
    /// Where it comes from.
    pub(super) origin: Origin,
    /// Root mean square residual in grey levels, as the views and the timeline measure it.
    pub(super) rms: Option<f64>,
}

/// Poses that were found, in their order, each measured as the views measure the pose on the screen.
pub(super) fn measured(inputs: &FitInputs, found: &[Hypothesis]) -> Vec<OtherPose> {
    let measured = |found: &Hypothesis| OtherPose {
        rms: inputs.measure(&found.pose).rms,
        pose: found.pose.clone(),
        origin: found.origin.clone(),
    };
    found.iter().map(measured).collect()
}

/// A search to be made.
#[derive(Debug)]
pub(super) struct PosesJob {
    /// The frame's data and the choices of the fit.
    pub(super) fit: FitInputs,
    /// Where it begins.
    pub(super) start: Pose,
}

impl Job<Found> for PosesJob {
    fn step(&mut self, out: &Outbox<Found>) -> Step {
        let fit = &self.fit;
        let Some(frame) = fit.frame.as_ref().map(|frame| frame.frame) else { return Step::Done };
        let (effort, views) = (SearchOptions::default(), fit.views());
        match search::search(&fit.model, views, &self.start, &fit.fit, &effort, out.cancel()) {
            // Half a search has looked at half of the body.
            Ok(_) if out.cancel().is_cancelled() => {}
            Ok(found) => out.send(Found::Poses(frame, measured(fit, &found.found))),
            Err(error) => out.send(Found::Refused(format!("Other poses cannot be looked for: {error}."))),
        }
        Step::Done
    }
}
