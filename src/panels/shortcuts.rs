//! All keys, searchable, and the gestures of the pointer.

use egui::{Grid, Id, Modal, RichText, ScrollArea, TextEdit, Ui};

use crate::action::{Action, keys_text};
use crate::theme;

/// Gestures of the pointer: they have no command.
const GESTURES: [(&str, &str); 7] = [
    ("Drag a joint", "Move it parallel to the picture; the chain follows"),
    ("Shift + drag", "Move it in depth"),
    ("Ctrl + drag", "Twist the limb"),
    ("Ctrl + Shift + drag", "Move the whole body"),
    ("Drag a limb", "Turn it about its joint"),
    ("Wheel", "Zoom at the pointer"),
    ("Middle drag", "Pan"),
];

/// Shows the list and says whether it stays open.
pub(crate) fn ui(ui: &Ui, search: &mut String) -> bool {
    let modal = Modal::new(Id::unique("shortcuts")).show(ui.ctx(), |ui| {
        ui.set_width(560.0);
        ui.heading("Keys");
        ui.add(TextEdit::singleline(search).hint_text("Search keys").desired_width(f32::INFINITY));
        ui.add_space(4.0);
        let words = search.to_lowercase();
        ScrollArea::vertical().max_height(460.0).auto_shrink(false).show(ui, |ui| {
            Grid::new("keys").num_columns(2).spacing([24.0, 5.0]).show(ui, |ui| {
                for action in Action::all().filter(|action| !action.shortcuts().is_empty()) {
                    let keys: Vec<String> = action.shortcuts().iter().map(keys_text).collect();
                    row(ui, &keys.join(", "), action.text(), &words);
                }
                for (keys, text) in GESTURES {
                    row(ui, keys, text, &words);
                }
            });
        });
    });
    !modal.should_close()
}

fn row(ui: &mut Ui, keys: &str, text: &str, words: &str) {
    if keys.to_lowercase().contains(words) || text.to_lowercase().contains(words) {
        ui.label(RichText::new(keys).monospace().color(theme::palette(ui).text2));
        ui.label(text);
        ui.end_row();
    }
}
