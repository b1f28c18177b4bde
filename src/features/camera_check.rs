//! Cameras that are checked against one another by what they see of the person: what is wrong with which, and cameras in the place
//! of the take's that repair it. `card` is the card that tells it.

mod card;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_formats::footage::replacement::Calibration;
use backlit_formats::synchronise::USUAL_FRAMES;
use backlit_runs::camera_check::{self, CheckStage, CheckedCameras, FindingWords, is_repairable, repaired};
use backlit_tracking::diagnosis::Finding;
use egui::Ui;

use crate::context::camera_work::{CameraWork, WorkMessage};
use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, FeatureCard, Requests, SessionRequest, ShellRequest, priority};

/// What stands in a project where the name of a calibration's file would be.
const REPAIRED: &str = "cameras repaired by the check";

#[derive(Debug, Default)]
pub(crate) struct CameraCheck {
    /// Its progress is what is being done, and how much of it, of how much.
    work: CameraWork<(CheckStage, [usize; 2]), CheckedCameras, { priority::TRACK }>,
    /// Cameras that were taken from a finding, and what is repaired with them.
    repair: Option<(Arc<Calibration>, String)>,
}

impl Feature for CameraCheck {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if let Some(take) = self.work.update("The check of the cameras", context, requests) {
            self.work.begin_step(context.pool, move |out| {
                let tell = |stage, done| out.send(WorkMessage::At((stage, done)));
                let checked = camera_check::check(&take, USUAL_FRAMES, out.cancel(), tell);
                checked.map_err(|error| error.to_string())
            });
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::CameraCheck;
        if is_own {
            self.work.want_current(context);
            requests.request(ShellRequest::OpenCard(FeatureCard::CameraCheck));
        }
        is_own
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        if command != Command::CameraCheck {
            return None;
        }
        let is_one = context.session.take.as_ref().is_some_and(|take| take.cameras.len() < 2);
        no_take(context)
            .or(because(is_one, "The take has one camera only, and cameras are checked against one another"))
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        self.show(ui, context, requests)
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self::default();
    }
}

impl CameraCheck {
    /// What is repaired with the cameras in use, if they were taken from a finding.
    fn repaired_now(&self, context: &Context<'_>) -> Option<&str> {
        let (calibration, what) = self.repair.as_ref()?;
        (context.document().calibration.as_ref() == Some(calibration)).then_some(what.as_str())
    }

    /// Puts the cameras of the last of these findings, with all of them repaired, in the place of those in use.
    fn use_repaired(&mut self, findings: &[Finding], context: &Context<'_>, requests: &mut Requests) {
        let Some(take) = context.session.take.as_ref().map(|footage| footage.take()) else { return };
        let Some(rig) = findings.last().and_then(|last| repaired(take, last)) else { return };
        let what = findings.iter().filter(|finding| is_repairable(finding.kind));
        let what: Vec<String> =
            what.map(|finding| FindingWords::of(finding, take.rig().cameras()).what).collect();
        let calibration = Arc::new(Calibration { path: REPAIRED.into(), rig });
        requests.edit(Edit::SetCalibration(Some(calibration.clone())));
        self.repair = Some((calibration, what.join(" and ")));
    }
}

/// Selects the camera of a finding, and goes to the frame from which on it is wrong.
fn look_at(finding: &Finding, context: &Context<'_>, requests: &mut Requests) {
    requests.others.extend(finding.camera.map(|camera| ShellRequest::Camera(camera).into()));
    let seconds = context.session.take.as_ref().map(|footage| footage.take().seconds());
    if let Some((since, seconds)) = finding.since_s.zip(seconds) {
        let frame = seconds.partition_point(|at| *at < since).min(seconds.len().saturating_sub(1));
        requests.request(SessionRequest::Frame(frame));
    }
}
