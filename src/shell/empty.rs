//! The window before a take is open.

use backlit_ui::style::theme::{self, title};
use backlit_ui::widgets::hint;
use egui::{Align, CentralPanel, Frame, Layout as Direction, RichText, Ui, vec2};

use super::recent;
use crate::context::command::{Command, FileCommand};
use crate::context::command_button::{button, named_button, primary};
use crate::context::{Context, Requests};
use crate::features::recovery::Recovery;

/// The empty state, or work that an earlier start left unsaved, if there is any.
pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, recovery: &Recovery, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let is_offered = recovery.is_offered();
    CentralPanel::default().frame(Frame::NONE.fill(palette.panel)).show(ui, |ui| {
        ui.with_layout(Direction::top_down(Align::Center), |ui| {
            let above = if is_offered { 0.06 } else { 0.30 };
            ui.add_space((ui.available_height() * above).max(16.0));
            if context.busy.opening {
                ui.label(RichText::new("Opening the take…").text_style(title()).color(palette.text));
                return;
            }
            if is_offered {
                let _ = recovery.ui(ui, context, requests);
            }
            let text = "Open a take, or look around in the built-in one";
            if is_offered {
                ui.label(RichText::new(text).color(palette.text2));
                ui.add_space(8.0);
            } else {
                ui.label(RichText::new(text).text_style(title()).color(palette.text));
                ui.add_space(16.0);
            }
            ui.allocate_ui_with_layout(vec2(282.0, 28.0), Direction::left_to_right(Align::Center), |ui| {
                // The likely next act is to go on with what was left.
                let open = if is_offered { button } else { primary };
                open(ui, context, requests, Command::File(FileCommand::OpenTake));
                button(ui, context, requests, Command::File(FileCommand::NewTake));
                named_button(ui, context, requests, Command::File(FileCommand::OpenBuiltIn), "Built-in take");
            });
            if is_offered {
                return;
            }
            ui.add_space(16.0);
            if !context.preferences.recent.is_empty() {
                hint(ui, "Recent takes and projects");
                recent::rows(ui, context, requests, false);
                ui.add_space(8.0);
            }
            let text = "A take is a folder with a take.toml: drop one anywhere to open it, or drop footage to make one.";
            hint(ui, text);
        });
    });
}
