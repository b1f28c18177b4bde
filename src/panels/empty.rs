//! The window before a take is open.

use egui::{Align, CentralPanel, Frame, Layout as Direction, RichText, Ui, vec2};

use super::command::{named_button, primary};
use super::recent;
use crate::action::Action;
use crate::showing::{Intents, Request, Showing};
use crate::theme::{self, title};

/// The empty state, with work that an earlier start left unsaved, if there is any.
pub(crate) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, recovery: Option<&str>) {
    let palette = theme::palette(ui);
    CentralPanel::default().frame(Frame::NONE.fill(palette.panel)).show(ui, |ui| {
        ui.with_layout(Direction::top_down(Align::Center), |ui| {
            ui.add_space((ui.available_height() * 0.30).max(40.0));
            if showing.busy.opening {
                ui.label(RichText::new("Opening the take…").text_style(title()).color(palette.text));
                return;
            }
            if let Some(text) = recovery {
                offer(ui, intents, text);
            }
            let text = "Open a take, or look around in the built-in one";
            ui.label(RichText::new(text).text_style(title()).color(palette.text));
            ui.add_space(16.0);
            ui.allocate_ui_with_layout(vec2(182.0, 28.0), Direction::left_to_right(Align::Center), |ui| {
                primary(ui, showing, intents, Action::OpenTake);
                named_button(ui, showing, intents, Action::OpenBuiltIn, "Built-in take");
            });
            ui.add_space(16.0);
            if recent::has_any(showing) {
                ui.label(RichText::new("Recent takes and projects").small().color(palette.text3));
                recent::rows(ui, showing, intents, false);
                ui.add_space(8.0);
            }
            let text = "A take is a folder with a take.toml. Drop one anywhere to open it.";
            ui.label(RichText::new(text).small().color(palette.text3));
        });
    });
}

fn offer(ui: &mut Ui, intents: &mut Intents, text: &str) {
    ui.label(text);
    ui.add_space(6.0);
    ui.allocate_ui_with_layout(vec2(130.0, 28.0), Direction::left_to_right(Align::Center), |ui| {
        if ui.button("Restore").clicked() {
            intents.request(Request::Recover(true));
        }
        if ui.button("Leave it").clicked() {
            intents.request(Request::Recover(false));
        }
    });
    ui.add_space(24.0);
}
