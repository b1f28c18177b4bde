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
use backlit_jobs::{News, Outbox, Task, one_step};
use backlit_runs::camera_check::{self, CheckStage, CheckedCameras, FindingWords, is_repairable, repaired};
use backlit_tracking::diagnosis::Finding;
use egui::Ui;

use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, FeatureCard, Requests, SessionRequest, ShellRequest, priority};

/// What stands in a project where the name of a calibration's file would be.
const REPAIRED: &str = "cameras repaired by the check";

#[derive(Debug, Default)]
pub(crate) struct CameraCheck {
    check: Task<(), CheckMessage, { priority::TRACK }>,
    /// Whether the cameras are to be checked as soon as the footage is seen by those of the document.
    is_wanted: bool,
    /// What is being done, and how much of it, of how much.
    progress: Option<(CheckStage, [usize; 2])>,
    checked: Option<Checked>,
    /// Cameras that were taken from a finding, and what is repaired with them.
    repair: Option<(Arc<Calibration>, String)>,
}

#[derive(Debug)]
enum CheckMessage {
    At(CheckStage, [usize; 2]),
    Ended(Checked),
}

/// What a check has said.
#[derive(Debug)]
struct Checked {
    /// The cameras that were checked; `None` for the take's own.
    calibration: Option<Arc<Calibration>>,
    outcome: Result<Box<CheckedCameras>, String>,
}

fn check(footage: &Footage, out: &Outbox<CheckMessage>) {
    let tell = |stage, done| out.send(CheckMessage::At(stage, done));
    let outcome = camera_check::check(footage, USUAL_FRAMES, out.cancel(), tell);
    if !out.cancel().is_cancelled() {
        let outcome = outcome.map(Box::new).map_err(|error| error.to_string());
        out.send(CheckMessage::Ended(Checked { calibration: footage.calibration.clone(), outcome }));
    }
}

impl Feature for CameraCheck {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for news in self.check.poll() {
            match news {
                News::Output(CheckMessage::At(stage, done)) => self.progress = Some((stage, done)),
                News::Output(CheckMessage::Ended(checked)) => self.checked = Some(checked),
                News::Ended => self.progress = None,
                News::Failed(failure) => requests.failed("The check of the cameras", &failure),
            }
        }
        let take = context.session.take.as_ref().filter(|_| self.is_wanted);
        if let Some(take) = take.filter(|take| take.calibration == context.document().calibration) {
            (self.is_wanted, self.progress, self.checked) = (false, None, None);
            let take = take.clone();
            self.check.begin(context.pool, (), |()| one_step(move |out: &Outbox<_>| check(&take, out)));
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::CameraCheck;
        if is_own {
            self.is_wanted = !self.is_current(context);
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
    /// Whether what was found is about the cameras in use.
    fn is_current(&self, context: &Context<'_>) -> bool {
        let calibration = &context.document().calibration;
        self.checked.as_ref().is_some_and(|checked| checked.calibration == *calibration)
    }

    /// What is repaired with the cameras in use, if they were taken from a finding.
    fn repaired_now(&self, context: &Context<'_>) -> Option<&str> {
        let (calibration, what) = self.repair.as_ref()?;
        (context.document().calibration.as_ref() == Some(calibration)).then_some(what.as_str())
    }

    fn stop(&mut self) {
        self.is_wanted = false;
        self.check.stop();
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
