//! Figures of what the cameras see, the sway along a direction, and sets of cameras.

use crate::app::App;
use crate::context::command::ObservabilityCommand;
use crate::features::observability::observed::ObserveJob;
use crate::features::observability::{ObserveRequest, Observing};
use crate::worker::Lane;

impl App {
    /// What is looked at of what the cameras see.
    #[must_use]
    pub fn observing(&self) -> &Observing {
        &self.features.observability
    }

    /// Asks for figures where they are wanted and old, once nothing more urgent is in hand, and lets the body sway.
    pub(crate) fn observe(&mut self, ctx: &egui::Context) {
        let Some(scene) = self.scene() else { return };
        let pose = self.shown_pose().clone();
        let is_stale = !self.features.observability.found().is_some_and(|found| found.is_of(&scene, &pose));
        let document = self.state.history.document();
        self.features.observability.advance(self.state.now, &pose, document, is_stale);
        if self.features.observability.is_playing() {
            ctx.request_repaint();
        }
        let is_busy = self.worker.is_busy(Lane::Fit) || self.features.tracking.is_busy();
        let is_moving = is_busy || self.context().drag.is_dragging() || self.is_playing();
        if !is_stale || is_moving || scene.frame.is_none() || !self.features.observability.is_wanted() {
            return;
        }
        let asked = self.asked_to_observe.as_ref();
        let is_known = asked.is_some_and(|(other, other_pose)| *other_pose == pose && other.is(&scene));
        if !is_known {
            self.asked_to_observe = Some((scene.clone(), pose.clone()));
            self.worker.request(Lane::Observe, ObserveJob { scene, pose });
        }
    }

    /// Does what a panel asked for.
    pub(crate) fn observe_request(&mut self, request: ObserveRequest) {
        self.features.observability.apply(request);
    }

    pub(crate) fn observability_command(&mut self, command: ObservabilityCommand) {
        match command {
            ObservabilityCommand::Ellipses => {
                self.observe_request(ObserveRequest::Ellipses(!self.features.observability.shows_ellipses()));
            }
            ObservabilityCommand::Sway => {
                self.observe_request(ObserveRequest::Play(!self.features.observability.is_playing()));
            }
            ObservabilityCommand::WeakerDirection => self.features.observability.pick_next(1),
            ObservabilityCommand::StrongerDirection => self.features.observability.pick_next(-1),
        }
    }
}
