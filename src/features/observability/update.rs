//! Figures of what the cameras see are asked for where they are wanted and old.

use std::sync::Arc;

use backlit_jobs::{News, once};

use super::{Observability, Observed};
use crate::context::command::ObservabilityCommand;
use crate::context::unavailable::{because, no_take};
use crate::context::{Context, Requests};
use crate::session::prediction::PosedInputs;

impl Observability {
    /// Does a command.
    pub(crate) fn run(&mut self, command: ObservabilityCommand) {
        match command {
            ObservabilityCommand::Ellipses => self.choices.ellipses ^= true,
            ObservabilityCommand::Sway => self.toggle_sway(),
            ObservabilityCommand::WeakerDirection => self.pick_next(1),
            ObservabilityCommand::StrongerDirection => self.pick_next(-1),
        }
    }

    /// Why a command cannot be used now.
    pub(crate) fn unavailable(
        &self,
        command: ObservabilityCommand,
        context: &Context<'_>,
    ) -> Option<&'static str> {
        no_take(context).or(match command {
            ObservabilityCommand::Ellipses | ObservabilityCommand::Sway => None,
            ObservabilityCommand::WeakerDirection | ObservabilityCommand::StrongerDirection => {
                because(self.found.is_none(), "Open the Observability section first")
            }
        })
    }

    /// Takes figures in, lets the body sway, and asks for newer figures where somebody looks at them, once nothing moves
    /// that they would be of.
    pub(crate) fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.shown = std::mem::take(&mut self.drawn);
        for news in self.task.poll() {
            match news {
                News::Output(Ok(found)) => self.found = Some(found),
                News::Output(Err(error)) => {
                    requests.complain(format!("What the cameras see cannot be computed: {error}."));
                }
                News::Failed(failure) => requests.failed("The look at what the cameras see", &failure),
                News::Ended => {}
            }
        }
        let Some(inputs) = context.fit_inputs() else { return };
        let pose = context.shown_pose();
        let believed = context.session.believed(context.selection.frame, pose);
        self.believed = believed.map(|believed| Arc::clone(&believed.joints));
        self.is_stale = !self.found().is_some_and(|found| found.pose == *pose && found.inputs.is(&inputs));
        self.advance(context);
        if self.is_playing() {
            context.egui.request_repaint();
        }
        let is_wanted = self.shown.figures || self.choices.ellipses || self.sway.is_some();
        let busy = context.busy;
        let is_moving =
            busy.fitting || busy.tracking || context.drag.is_dragging() || context.playback.is_playing();
        if self.is_stale && is_wanted && !is_moving && inputs.frame.is_some() {
            let observe = |posed: &PosedInputs| {
                let PosedInputs { inputs, pose } = posed.clone();
                once(move |_| Observed::new(inputs, pose).map(Arc::new))
            };
            self.task.ask(context.pool, PosedInputs { inputs, pose: pose.clone() }, observe);
        }
    }
}
