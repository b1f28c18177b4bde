//! The step that is looked at: played, in words, taken.

use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{Icon, ValueSlider, checkbox, icon_button};
use egui::{Button, Label, RichText, Ui};

use super::PaneAction;
use crate::features::beginnings::{AttemptIndex, Beginnings, Method};

/// Lines that are kept for the words about a step.
const LINES: f32 = 4.0;

/// The controls of the step and what it does.
pub(super) fn ui(ui: &mut Ui, beginnings: &Beginnings, actions: &mut Vec<PaneAction>) {
    let Some((at, outcome)) = beginnings.at.zip(beginnings.outcome()) else { return };
    let last = outcome.steps.len().saturating_sub(1);
    let Some(step) = outcome.steps.get(at.step) else { return };
    let go_to = |step: usize| PaneAction::LookAt(AttemptIndex { step, ..at });
    let palette = theme::palette(ui);
    ui.separator();
    ui.horizontal(|ui| {
        ui.add_enabled_ui(at.step > 0, |ui| {
            if icon_button(ui, Icon::Previous, "Previous step of the way", "Previous step").clicked() {
                actions.push(go_to(at.step - 1));
            }
        });
        let (icon, label) = match beginnings.plays {
            Some(_) => (Icon::Pause, "Pause the steps"),
            None => (Icon::Play, "Play the steps"),
        };
        ui.add_enabled_ui(last > 0, |ui| {
            if icon_button(ui, icon, label, label).clicked() {
                actions.push(PaneAction::Play);
            }
        });
        ui.add_enabled_ui(at.step < last, |ui| {
            if icon_button(ui, Icon::Next, "Next step of the way", "Next step").clicked() {
                actions.push(go_to(at.step + 1));
            }
        });
        let text = format!("Step {} of {}", at.step + 1, last + 1);
        ui.add(Label::new(RichText::new(text).color(palette.text)).truncate());
    });
    if last > 0 {
        let mut value = at.step as f64;
        let slider = ValueSlider::new(&mut value, 0.0..=last as f64, "Step of the way");
        let width = ui.available_width();
        let slider = ui.add(slider.width(width).held(true));
        let chosen = value.round() as usize;
        if slider.changed() && chosen != at.step {
            actions.push(go_to(chosen));
        }
    }
    let words = ui.add(Label::new(RichText::new(&step.words).color(palette.text)).wrap());
    // What is below stays where it is.
    let line = ui.text_style_height(&egui::TextStyle::Body) + space::ROW;
    ui.add_space((LINES * line - words.rect.height()).max(0.0));
    ui.horizontal_wrapped(|ui| {
        let (text, tooltip) = match at.method {
            Method::Body => (
                "Take this body",
                "The body gets the sizes of this step, and the frame its pose; one undo takes both back",
            ),
            _ => ("Take this pose", "The frame gets the pose of this step, as a key pose"),
        };
        let button = ui.add(Button::new(text).min_size(egui::vec2(0.0, size::BUTTON)));
        if button.on_hover_text(tooltip).clicked() {
            actions.push(PaneAction::Take);
        }
        let mut is_shown = beginnings.is_shown;
        let shown = checkbox(ui, &mut is_shown, "Show in the views").on_hover_text(
            "Draw the step in views and scene, in the place of the pose; Esc brings the pose back",
        );
        if shown.changed() {
            actions.push(PaneAction::Show(is_shown));
        }
    });
}
