//! A box of a few choices.

use egui::{ComboBox, Ui};

/// A box of a few choices, named for screen readers. Says which one was chosen.
pub fn choice<T: PartialEq + Copy>(
    ui: &mut Ui,
    name: &str,
    width: f32,
    chosen: &str,
    choices: &[(T, &str, String)],
) -> Option<T> {
    let mut picked = None;
    ui.name_inputs(name, |ui| {
        ComboBox::from_id_salt(name).width(width).selected_text(chosen).show_ui(ui, |ui| {
            for (value, text, tooltip) in choices {
                if ui.selectable_label(*text == chosen, *text).on_hover_text(tooltip).clicked() {
                    picked = Some(*value);
                }
            }
        });
    });
    picked
}
