//! Why a command of the fit cannot be used now.

use backlit_document::runs::StepRef;

use super::Fit;
use crate::context::Context;
use crate::context::command::FitCommand;
use crate::context::unavailable::{Why, because, no_body_fit, no_fit};

impl Fit {
    /// Why a command cannot be used now.
    pub(crate) fn unavailable(command: FitCommand, context: &Context<'_>) -> Why {
        let busy = context.busy;
        match command {
            FitCommand::Step | FitCommand::SearchPoses => no_fit(context),
            FitCommand::Run | FitCommand::RunAgain(_) | FitCommand::Refit(_) => {
                no_fit(context).or(because(busy.fitting, "The fit is running"))
            }
            FitCommand::FitBody | FitCommand::MakeSpheres => {
                no_body_fit(context).or(because(busy.fitting, "The fit is running"))
            }
            FitCommand::Stop => {
                let is_behind = busy.exporting.is_some() || context.busy.basin;
                because(!(busy.fitting || busy.tracking || is_behind), "Nothing is running")
            }
            FitCommand::StepBack | FitCommand::EarlierStep => match (context.run(), context.shown_step()) {
                (None, _) => Some("This frame has no run yet: press Space to step"),
                (Some(_), Some(StepRef { step: 0, .. })) => Some("This is the start of the run"),
                (Some(run), _) => because(run.steps.len() < 2, "The run has no step yet"),
            },
            FitCommand::LaterStep => {
                let is_last = |at: StepRef| context.run().is_none_or(|run| run.last_step() == at.step);
                because(context.shown_step().is_none_or(is_last), "This is the newest step of the run")
            }
            FitCommand::Branch => because(
                context.selection.step.is_none(),
                "The frame’s pose is on the screen: go to a step of a run first",
            ),
            FitCommand::Renderer(_) | FitCommand::Preset(_) => None,
        }
    }
}
