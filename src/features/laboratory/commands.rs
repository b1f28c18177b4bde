//! What commands mean in the laboratory's layout: its own, and those of others that step and go through steps.

use super::Laboratory;
use crate::context::Context;
use crate::context::command::{Command, FitCommand, LaboratoryCommand, TimelineCommand, ViewCommand};
use crate::context::preferences::Layout;
use crate::context::unavailable::{because, no_take};

/// Steps of the keys for ten frames.
const MANY_STEPS: usize = 10;

impl Laboratory {
    /// Does what a command of another feature means in the laboratory's layout. `false` for those that mean there
    /// what they mean everywhere.
    pub(crate) fn takes(&mut self, command: Command, context: &Context<'_>) -> bool {
        if context.preferences.layout != Layout::Demonstrate {
            return false;
        }
        if let Command::View(ViewCommand::CameraAlone(camera)) = command {
            self.camera = camera;
            return true;
        }
        let is_running = self.is_running();
        let Some(comparison) = &mut self.comparison else { return false };
        let here = comparison.cursor;
        match command {
            Command::Fit(FitCommand::Step | FitCommand::LaterStep)
            | Command::Timeline(TimelineCommand::NextFrame) => self.step(Some(1), context.pool),
            Command::Fit(FitCommand::Run) => self.step(None, context.pool),
            Command::Fit(FitCommand::StepBack | FitCommand::EarlierStep)
            | Command::Timeline(TimelineCommand::PreviousFrame) => comparison.go_to(here.saturating_sub(1)),
            Command::Timeline(TimelineCommand::TenFramesBack) => {
                comparison.go_to(here.saturating_sub(MANY_STEPS));
            }
            Command::Timeline(TimelineCommand::TenFramesOn) => comparison.go_to(here + MANY_STEPS),
            Command::Timeline(TimelineCommand::FirstFrame) => comparison.go_to(0),
            Command::Timeline(TimelineCommand::LastFrame) => comparison.go_to(usize::MAX),
            Command::Fit(FitCommand::Stop) if is_running => {
                self.pending_steps = 0;
                self.steps.stop();
            }
            _ => return false,
        }
        true
    }

    /// Why a command cannot be used that means something of its own here; the outer `None` is for commands that the
    /// laboratory leaves to others.
    pub(crate) fn overrides(&self, command: Command, context: &Context<'_>) -> Option<Option<&'static str>> {
        if context.preferences.layout == Layout::Demonstrate {
            return self.unavailable_in_layout(command).map(|answer| no_take(context).or(answer));
        }
        let elsewhere = "The Demonstrate layout has the laboratory: press F3";
        matches!(command, Command::Laboratory(_)).then_some(Some(elsewhere))
    }

    fn unavailable_in_layout(&self, command: Command) -> Option<Option<&'static str>> {
        let Some(comparison) = self.begun() else {
            return is_own(command).then_some(Some("The laboratory has not begun yet"));
        };
        let at_end = comparison.cursor == comparison.last();
        let is_over = comparison.is_over() && at_end;
        Some(match command {
            Command::Fit(FitCommand::Step | FitCommand::LaterStep)
            | Command::Timeline(TimelineCommand::NextFrame) => because(is_over, "All fits have ended"),
            Command::Fit(FitCommand::Run) => {
                because(is_over, "All fits have ended").or(because(self.is_running(), "They are running"))
            }
            Command::Fit(FitCommand::StepBack | FitCommand::EarlierStep)
            | Command::Timeline(
                TimelineCommand::PreviousFrame | TimelineCommand::TenFramesBack | TimelineCommand::FirstFrame,
            ) => because(comparison.cursor == 0, "This is the start"),
            Command::Timeline(TimelineCommand::LastFrame | TimelineCommand::TenFramesOn) => {
                because(at_end, "This is the newest step")
            }
            Command::Fit(FitCommand::Stop) if self.is_running() => None,
            Command::Laboratory(LaboratoryCommand::Restart) => {
                let is_new = comparison.last() == 0 && comparison.problem().is_none();
                because(is_new, "No step has been made yet")
            }
            _ => return None,
        })
    }
}

/// Whether a command means something of its own in the laboratory's layout.
fn is_own(command: Command) -> bool {
    use {FitCommand as F, TimelineCommand as T};
    matches!(
        command,
        Command::Fit(F::Step | F::StepBack | F::Run | F::Stop | F::EarlierStep | F::LaterStep)
            | Command::Timeline(T::PreviousFrame | T::NextFrame | T::TenFramesBack | T::TenFramesOn)
            | Command::Timeline(T::FirstFrame | T::LastFrame)
            | Command::Laboratory(LaboratoryCommand::Restart)
    )
}
