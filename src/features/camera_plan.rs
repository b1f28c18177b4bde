//! Where to put cameras: what the take's would know of a body anywhere on the floor, which could be left out, and where one more
//! would bring most. `card` is the card that shows it, `map` the floor on it and in the scene.

mod card;
mod map;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::{Job, Outbox, Turn};
use backlit_runs::camera_plan::{PlanResult, PlanRun, PlanSubject};
use backlit_tracking::camera::up_of;
use backlit_tracking::observability::plan::Floor;
use egui::Ui;

use crate::context::camera_work::{CameraWork, WorkMessage};
use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::marks::FloorPicture;
use crate::context::unavailable::{Why, no_take};
use crate::context::{Context, FeatureCard, Published, Requests, ShellRequest, priority};

#[derive(Debug, Default)]
pub(crate) struct CameraPlan {
    /// Its progress is places that are done, of how many.
    work: CameraWork<[usize; 2], PlanResult, { priority::BASIN }>,
    /// The place for one more camera that is looked at, as its rank.
    looked_at: usize,
    /// What the cameras there are would know, for the floor of the scene, once there is a plan.
    floor: Option<Arc<FloorPicture>>,
    /// Whether the scene's floor stays as it is.
    is_off_floor: bool,
}

/// The plan, one place a step.
fn places(subject: PlanSubject) -> impl Job<WorkMessage<[usize; 2], PlanResult>> {
    let (mut begin, mut run) = (Some(subject), None);
    move |out: &Outbox<_>| {
        if out.cancel().is_cancelled() {
            return Turn::Done;
        }
        if let Some(subject) = begin.take() {
            match PlanRun::new(subject) {
                Ok(made) => run = Some(made),
                Err(error) => out.send(WorkMessage::Ended(Err(error.to_string()))),
            }
        }
        let Some(run) = &mut run else { return Turn::Done };
        let goes_on = run.step();
        out.send(WorkMessage::At(run.progress()));
        if goes_on {
            return Turn::Again;
        }
        out.send(WorkMessage::Ended(Ok(Box::new(run.result()))));
        Turn::Done
    }
}

impl Feature for CameraPlan {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if let Some(take) = self.work.update("The plan of cameras", context, requests) {
            self.looked_at = 0;
            match subject(&take, context) {
                Some(subject) => self.work.begin(context.pool, places(subject)),
                None => self.work.refuse("The cameras do not agree on which way is up"),
            }
        }
        // About cameras that are no longer in use, the card says so; on the floor nothing could.
        let found = self.work.result().filter(|_| !self.work.is_busy() && self.work.is_current(context));
        self.floor = match (self.floor.take(), found) {
            (Some(floor), Some(_)) => Some(floor),
            (_, found) => found.and_then(map::on_floor).map(Arc::new),
        };
    }

    fn publish(&self, published: &mut Published) {
        published.floor_picture = self.floor.clone().filter(|_| !self.is_off_floor);
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::CameraPlan;
        if is_own {
            self.work.want_current(context);
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
