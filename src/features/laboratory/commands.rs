//! What commands mean in the laboratory's layout: its own, and those of others that step and go through steps.

use super::Laboratory;
use crate::context::Context;
use crate::context::command::{Command, FitCommand, LaboratoryCommand, TimelineCommand, ViewCommand};
use crate::context::preferences::Layout;
use crate::context::unavailable::{because, no_take};

/// Steps of the keys for ten frames.
const MANY_STEPS: isize = 10;

/// What a command means in the laboratory's layout.
#[derive(Debug, Clone, Copy)]
enum LaboratoryMove {
    /// Goes on by a step.
    Step,
    /// Runs all fits to their ends.
    Run,
    /// Looks at the step so far on, or back.
    Go(isize),
    Stop,
    Restart,
}

/// `None` for commands that mean here what they mean everywhere.
fn meaning(command: Command) -> Option<LaboratoryMove> {
    use {FitCommand as F, TimelineCommand as T};
    Some(match command {
        Command::Fit(F::Step | F::LaterStep) | Command::Timeline(T::NextFrame) => LaboratoryMove::Step,
        Command::Fit(F::Run) => LaboratoryMove::Run,
        Command::Fit(F::StepBack | F::EarlierStep) | Command::Timeline(T::PreviousFrame) => {
            LaboratoryMove::Go(-1)
        }
        Command::Timeline(T::TenFramesBack) => LaboratoryMove::Go(-MANY_STEPS),
        Command::Timeline(T::TenFramesOn) => LaboratoryMove::Go(MANY_STEPS),
        Command::Timeline(T::FirstFrame) => LaboratoryMove::Go(isize::MIN),
        Command::Timeline(T::LastFrame) => LaboratoryMove::Go(isize::MAX),
        Command::Fit(F::Stop) => LaboratoryMove::Stop,
        Command::Laboratory(LaboratoryCommand::Restart) => LaboratoryMove::Restart,
        _ => return None,
    })
}

impl Laboratory {
    /// Does what a command of another feature means in the laboratory's layout. `false` for those that mean there
    /// what they mean everywhere.
    pub(crate) fn takes(&mut self, command: Command, context: &Context<'_>) -> bool {
        if context.preferences.layout != Layout::Demonstrate {
            return false;
        }
        if let Command::View(ViewCommand::CameraAlone(camera)) = command {
            self.choices.camera = camera;
            return true;
        }
        let is_running = self.is_running();
        let Some(comparison) = &mut self.comparison else { return false };
        let here = comparison.cursor;
        match meaning(command) {
            Some(LaboratoryMove::Step) => self.step(Some(1), context.pool),
            Some(LaboratoryMove::Run) => self.step(None, context.pool),
            Some(LaboratoryMove::Go(steps)) => comparison.go_to(here.saturating_add_signed(steps)),
            Some(LaboratoryMove::Stop) if is_running => {
                self.pending_steps = 0;
                self.steps.stop();
            }
            Some(LaboratoryMove::Stop | LaboratoryMove::Restart) | None => return false,
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
        let meaning = meaning(command)?;
        let Some(comparison) = self.begun() else { return Some(Some("The laboratory has not begun yet")) };
        let at_end = comparison.cursor == comparison.last();
        let is_over = comparison.is_over() && at_end;
        Some(match meaning {
            LaboratoryMove::Step => because(is_over, "All fits have ended"),
            LaboratoryMove::Run => {
                because(is_over, "All fits have ended").or(because(self.is_running(), "They are running"))
            }
            LaboratoryMove::Go(..0) => because(comparison.cursor == 0, "This is the start"),
            LaboratoryMove::Go(_) => because(at_end, "This is the newest step"),
            LaboratoryMove::Stop if self.is_running() => None,
            LaboratoryMove::Stop => return None,
            LaboratoryMove::Restart => {
                let is_new = comparison.last() == 0 && comparison.problem().is_none();
                because(is_new, "No step has been made yet")
            }
        })
    }
}
