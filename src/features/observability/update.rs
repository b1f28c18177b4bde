//! Figures of what the cameras see are asked for where they are wanted and old.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::once;
use backlit_tracking::body::Pose;
use backlit_tracking::fit::{Evidence, FitError, FitView};
use backlit_tracking::observability::{FrameInformation, JointUncertainty, SubsetFigures};
use egui::Ui;

use super::{Figures, Observability};
use crate::context::command::{Command, ObservabilityCommand};
use crate::context::feature::Feature;
use crate::context::marks::{ObservabilityMarks, Uncertainty};
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, Published, Requests};
use crate::session::prediction::{FitInputs, PosedInputs};

impl Feature for Observability {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.shown = std::mem::take(&mut self.drawn);
        for found in requests.outputs("The look at what the cameras see", &mut self.task) {
            match found {
                Ok(found) => self.found = Some(found),
                Err(error) => requests.complain(format!("What the cameras see cannot be computed: {error}.")),
            }
        }
        let Some(inputs) = context.fit_inputs() else { return };
        let pose = context.shown_pose();
        let believed = context.session.believed(context.selection.frame, pose);
        self.believed = believed.map(|believed| Arc::clone(&believed.joints));
        self.is_current = self.found().is_some_and(|found| found.pose == *pose && found.inputs.is(&inputs));
        self.advance(context);
        if self.is_playing() {
            context.egui.request_repaint();
        }
        let is_wanted = self.shown.figures || self.choices.ellipses || self.sway.is_some();
        let busy = context.busy;
        let is_moving =
            busy.fitting || busy.tracking || context.drag.is_dragging() || context.playback.is_playing();
        if self.is_stale() && is_wanted && !is_moving && inputs.frame.is_some() {
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
            is_stale: self.is_stale(),
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
        self.section(ui, context, requests);
        self.subsets_section(ui, context, requests);
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self { choices: self.choices.clone(), ..Self::default() };
    }
}

/// What the cameras see of a pose.
#[derive(Debug)]
pub struct Observed {
    /// What it depends on besides the pose.
    pub(crate) inputs: FitInputs,
    pub(crate) pose: Pose,
    /// Of the cameras that count.
    pub shown: Figures,
    /// Sets of the cameras that have a silhouette, the best first.
    pub(crate) subsets: Vec<SubsetFigures>,
}

impl Observed {
    /// Looks through every camera that has a silhouette.
    ///
    /// # Errors
    /// See [`FrameInformation::new`].
    pub(crate) fn new(inputs: FitInputs, pose: Pose) -> Result<Self, FitError> {
        let view = |camera: usize| {
            let weight = inputs.uses.get(camera).map_or(1.0, |used| used.weight);
            let evidence = Evidence::Measurement(inputs.data(camera)?.shared());
            Some(FitView { camera: inputs.cameras[camera].clone(), evidence, weight })
        };
        let views: Vec<Option<FitView>> = (0..inputs.cameras.len()).map(view).collect();
        let information = FrameInformation::new(&inputs.model, &views, &inputs.fit, &pose)?;
        let counts =
            |camera: &usize| inputs.uses.get(*camera).is_some_and(|used| used.used && used.weight > 0.0);
        let used: Vec<usize> = (0..views.len()).filter(counts).collect();
        let shown = information.observe(&used);
        let subsets = information.compare_subsets(shown.noise);
        Ok(Self { inputs, pose, shown, subsets })
    }
}
