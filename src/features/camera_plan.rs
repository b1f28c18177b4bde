//! Where to put cameras: what the take's would know of a body anywhere on the floor, which could be left out, and where one more
//! would bring most. `card` is the card that shows it, `map` the floor on it.

mod card;
mod map;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::footage::replacement::Calibration;
use backlit_jobs::{Job, News, Outbox, Task, Turn};
use backlit_runs::camera_plan::{PlanResult, PlanRun, PlanSubject};
use backlit_tracking::camera::up_of;
use backlit_tracking::observability::plan::Floor;
use egui::Ui;

use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, no_take};
use crate::context::{Context, FeatureCard, Requests, ShellRequest, priority};

#[derive(Debug, Default)]
pub(crate) struct CameraPlan {
    task: Task<(), PlanMessage, { priority::BASIN }>,
    /// Whether a plan is to be made as soon as the footage is seen by the document's cameras.
    is_wanted: bool,
    /// Places that are done, of how many.
    progress: Option<[usize; 2]>,
    planned: Option<Planned>,
    /// The place for one more camera that is looked at, as its rank.
    looked_at: usize,
}

#[derive(Debug)]
enum PlanMessage {
    At([usize; 2]),
    Ended(Planned),
}

/// What a plan has said.
#[derive(Debug)]
struct Planned {
    /// The cameras that were planned with; `None` for the take's own.
    calibration: Option<Arc<Calibration>>,
    outcome: Result<Box<PlanResult>, String>,
}

/// The plan with the cameras of a calibration, one place a step.
fn places(subject: PlanSubject, calibration: Option<Arc<Calibration>>) -> impl Job<PlanMessage> {
    let (mut begin, mut run) = (Some(subject), None);
    let ended = move |outcome| PlanMessage::Ended(Planned { calibration: calibration.clone(), outcome });
    move |out: &Outbox<PlanMessage>| {
        if out.cancel().is_cancelled() {
            return Turn::Done;
        }
        if let Some(subject) = begin.take() {
            match PlanRun::new(subject) {
                Ok(made) => run = Some(made),
                Err(error) => out.send(ended(Err(error.to_string()))),
            }
        }
        let Some(run) = &mut run else { return Turn::Done };
        let goes_on = run.step();
        out.send(PlanMessage::At(run.progress()));
        if goes_on {
            return Turn::Again;
        }
        out.send(ended(Ok(Box::new(run.result()))));
        Turn::Done
    }
}

impl Feature for CameraPlan {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for news in self.task.poll() {
            match news {
                News::Output(PlanMessage::At(progress)) => self.progress = Some(progress),
                News::Output(PlanMessage::Ended(planned)) => self.planned = Some(planned),
                News::Ended => self.progress = None,
                News::Failed(failure) => requests.failed("The plan of cameras", &failure),
            }
        }
        let take = context.session.take.as_ref().filter(|_| self.is_wanted);
        if let Some(take) = take.filter(|take| take.calibration == context.document().calibration) {
            let calibration = take.calibration.clone();
            (self.is_wanted, self.progress, self.planned, self.looked_at) = (false, None, None, 0);
            match subject(take, context) {
                Some(subject) => self.task.begin(context.pool, (), |()| places(subject, calibration)),
                None => {
                    let outcome = Err("The cameras do not agree on which way is up".to_owned());
                    self.planned = Some(Planned { calibration, outcome });
                }
            }
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::CameraPlan;
        if is_own {
            self.is_wanted = !self.is_current(context);
            requests.request(ShellRequest::OpenCard(FeatureCard::CameraPlan));
        }
        is_own
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        if command == Command::CameraPlan { no_take(context) } else { None }
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        self.show(ui, context, requests)
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self::default();
    }
}

/// The body and the cameras on the screen, on the floor under the start.
fn subject(take: &Footage, context: &Context<'_>) -> Option<PlanSubject> {
    let document = context.document();
    let up = up_of(take.cameras.iter().map(|camera| &**camera))?;
    let floor = Floor::under(&document.model, &document.start, up);
    Some(PlanSubject::new(document.model.clone(), take.cameras.to_vec(), floor))
}

impl CameraPlan {
    /// Whether what was planned is about the cameras in use.
    fn is_current(&self, context: &Context<'_>) -> bool {
        let calibration = &context.document().calibration;
        self.planned.as_ref().is_some_and(|planned| planned.calibration == *calibration)
    }

    const fn is_busy(&self) -> bool {
        self.is_wanted || self.task.is_busy()
    }

    fn stop(&mut self) {
        self.is_wanted = false;
        self.task.stop();
    }
}
