//! What the rest of the window knows of a feature.
//!
//! App, shell and settings go through the list in `src/features.rs` and call these methods; a feature leaves out what it does
//! not have. One frame: `update`, then `pane`, `section` or `card`, then `run` for each command and `answer` for each request.

use backlit_formats::Footage;
use egui::Ui;

use crate::context::command::Command;
use crate::context::pane::Pane;
use crate::context::unavailable::Why;
use crate::context::{Context, FeatureRequest, Published, Requests};

pub(crate) trait Feature {
    /// Takes in what its tasks have done, and asks for what it lacks.
    fn update(&mut self, _: &Context<'_>, _: &mut Requests) {}

    /// Says what others draw of it. Called after its update.
    fn publish(&self, _: &mut Published) {}

    /// Does a command. Returns whether it was one of its own; the next feature is asked otherwise.
    fn run(&mut self, _: Command, _: &Context<'_>, _: &mut Requests) -> bool {
        false
    }

    /// Why one of its commands cannot be used now.
    fn unavailable(&self, _: Command, _: &Context<'_>) -> Why {
        None
    }

    /// Answers a request, if it is meant.
    fn answer(&mut self, _: &FeatureRequest, _: &Context<'_>, _: &mut Requests) {}

    fn fills(&self) -> Option<Pane> {
        None
    }

    /// Shows its pane; `siblings` are the panes that stand behind it.
    fn pane(&mut self, _: &mut Ui, _: &Context<'_>, _siblings: &[Pane], _: &mut Requests) {}

    /// Shows its sections at the end of the right panel.
    fn sections(&mut self, _: &mut Ui, _: &Context<'_>, _: &mut Requests) {}

    /// Shows its card over the window. Returns whether the card stays.
    fn card(&mut self, _: &Ui, _: &Context<'_>, _: &mut Requests) -> bool {
        false
    }

    /// What it does just now, for the status bar.
    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        None
    }

    /// Another take is open: what is about the old one goes.
    fn reset(&mut self, _: &Footage) {}

    /// Forgets how long things took, so that a picture is the same every time.
    fn freeze_times(&mut self) {}

    /// The same without any work that is going on, for a picture of it.
    fn at_rest(&self) -> Self
    where
        Self: Sized + Default,
    {
        Self::default()
    }
}
