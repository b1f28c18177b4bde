//! Figures of what the cameras see are asked for where they are wanted and old.

use backlit_formats::Footage;
use egui::Ui;
use std::sync::Arc;

use backlit_jobs::{News, once};

use super::{Observability, Observed};
use crate::context::Published;
use crate::context::command::Command;
use crate::context::command::ObservabilityCommand;
use crate::context::feature::Feature;
use crate::context::observability::{ObservabilityMarks, Uncertainty};
use crate::context::preferences::Layout;
use crate::context::unavailable::Why;
use crate::context::unavailable::{because, no_take};
use crate::context::{Context, Requests};
use crate::session::prediction::PosedInputs;
use backlit_tracking::observability::JointUncertainty;

impl Feature for Observability {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
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

    fn publish(&self, published: &mut Published) {
        let uncertainty = |(joints, others): (&[JointUncertainty], Option<&[usize]>)| {
            let model = self.found()?.shown.model.clone();
            let is_believed = others.is_none() && self.believed.is_some();
            Some(Uncertainty { model, joints: joints.to_vec(), is_of_others: others.is_some(), is_believed })
        };
        published.observability = ObservabilityMarks {
            is_stale: self.is_stale,
            is_playing: self.is_playing(),
            swaying: self.swaying(),
            swayed_pose: self.swayed_pose(),
            uncertainty: self.ellipses().and_then(uncertainty),
            factor: self.ellipse_factor(),
            angle: self.shown.angle,
        };
    }

    fn run(&mut self, command: Command, _: &Context<'_>, _: &mut Requests) -> bool {
        let Command::Observability(command) = command else { return false };
        match command {
            ObservabilityCommand::Ellipses => self.choices.ellipses ^= true,
            ObservabilityCommand::Sway => self.toggle_sway(),
            ObservabilityCommand::WeakerDirection => self.pick_next(1),
            ObservabilityCommand::StrongerDirection => self.pick_next(-1),
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Observability(command) = command else { return None };
        no_take(context).or(match command {
            ObservabilityCommand::Ellipses | ObservabilityCommand::Sway => None,
            ObservabilityCommand::WeakerDirection | ObservabilityCommand::StrongerDirection => {
                because(self.found.is_none(), "Open the Observability section first")
            }
        })
    }

    fn sections(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let is_open = context.preferences.layout == Layout::Debug;
        self.section(ui, context, requests, is_open);
        self.subsets_section(ui, context, requests, is_open);
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self { choices: self.choices.clone(), ..Self::default() };
    }
}
