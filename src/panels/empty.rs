//! The window before a take is open.

use egui::{Align, CentralPanel, Frame, Layout as Direction, RichText, Ui, vec2};

use super::command::{named_button, primary};
use super::recent;
use crate::action::Action;
use crate::recovery::Left;
use crate::showing::{Intents, Request, Showing};
use crate::theme::{self, title};

/// Rows of unsaved work that are offered at once.
const MOST_OFFERED: usize = 6;
/// Width of such a row.
const ROW: f32 = 520.0;

/// The empty state, with work that an earlier start left unsaved, if there is any.
pub(crate) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, left: &[Left]) {
    let palette = theme::palette(ui);
    CentralPanel::default().frame(Frame::NONE.fill(palette.panel)).show(ui, |ui| {
        ui.with_layout(Direction::top_down(Align::Center), |ui| {
            ui.add_space((ui.available_height() * 0.30).max(40.0));
            if showing.busy.opening {
                ui.label(RichText::new("Opening the take…").text_style(title()).color(palette.text));
                return;
            }
            if !left.is_empty() {
                offer(ui, intents, left);
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

fn offer(ui: &mut Ui, intents: &mut Intents, left: &[Left]) {
    let palette = theme::palette(ui);
    let now = std::time::SystemTime::now();
    ui.label(RichText::new("Backlit ended with unsaved work").text_style(title()).color(palette.text));
    ui.add_space(8.0);
    for (index, left) in left.iter().enumerate().take(MOST_OFFERED) {
        ui.allocate_ui_with_layout(vec2(ROW, 28.0), Direction::right_to_left(Align::Center), |ui| {
            let button = ui.button("Restore").on_hover_text(left.path.display().to_string());
            if button.clicked() {
                intents.request(Request::Recover(Some(index)));
            }
            ui.with_layout(Direction::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(left.text(now)).color(palette.text)).truncate());
            });
        });
    }
    if left.len() > MOST_OFFERED {
        let text = format!("and {} older ones", left.len() - MOST_OFFERED);
        ui.label(RichText::new(text).small().color(palette.text3));
    }
    ui.add_space(4.0);
    let hover = "It is put aside, and can be opened as a project later";
    if ui.button("Leave it").on_hover_text(hover).clicked() {
        intents.request(Request::Recover(None));
    }
    ui.add_space(24.0);
}
