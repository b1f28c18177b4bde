//! The presets of the fit as a box, for all who have room for it.

use backlit_document::fit_words::preset_like;
use backlit_tracking::fit::Preset;
use backlit_ui::widgets::choice;
use egui::Ui;

use crate::context::command::{Command, FitCommand};
use crate::context::{Context, Requests};

/// A box of the presets.
pub(crate) fn show(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, width: f32) {
    let chosen = preset_like(&context.document().fit).map_or("Custom", Preset::label);
    let choices = [Preset::Robust, Preset::Report].map(|preset| {
        let command = Command::Fit(FitCommand::Preset(preset));
        (command, command.text(), command.tooltip())
    });
    if let Some(command) = choice(ui, "Preset", width, chosen, &choices) {
        requests.run(command);
    }
}
