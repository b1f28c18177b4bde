//! All keys, searchable, and the gestures of the pointer.

use egui::{Grid, Id, Modal, RichText, ScrollArea, Ui, vec2};

use crate::action::{Action, Menu, keys_text};
use crate::theme::{self, size};
use crate::widgets::{Icon, icon_button, text_field};

/// Width of the card, and of the column of keys.
const WIDTH: f32 = 600.0;
const KEYS: f32 = 150.0;

/// Gestures of the pointer: they have no command.
const GESTURES: [(&str, &str); 9] = [
    ("Drag a joint", "Move it parallel to the picture; the chain follows"),
    ("Shift + drag", "Move it in depth"),
    ("Ctrl + drag", "Twist the limb"),
    ("Ctrl + Shift + drag", "Move the whole body"),
    ("Drag a limb", "Turn it about its joint"),
    ("Wheel", "Zoom at the pointer"),
    ("Middle drag", "Pan"),
    ("Hold H", "Keep the numbers of the pixel under the pointer"),
    ("Drop a file", "Open a take or a project, or take over cameras, silhouettes, a pose or a body"),
];

/// Shows the list and says whether it stays open.
pub(crate) fn ui(ui: &Ui, search: &mut String) -> bool {
    let mut close = false;
    let modal = Modal::new(Id::unique("shortcuts")).show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.horizontal(|ui| {
            ui.label(RichText::new("Keys").text_style(theme::title()));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                close = icon_button(ui, Icon::Close, "Close keys", "Close   Esc").clicked();
            });
        });
        text_field(ui, "Search keys", "Search keys", search).request_focus();
        ui.add_space(4.0);
        let words: Vec<String> = search.to_lowercase().split_whitespace().map(str::to_owned).collect();
        ScrollArea::vertical().max_height(460.0).auto_shrink([false, true]).show(ui, |ui| {
            let mut is_empty = true;
            for menu in Menu::ALL {
                let rows =
                    Action::in_menu(menu).filter(|action| !action.shortcuts().is_empty()).map(|action| {
                        let keys: Vec<String> = action.shortcuts().iter().map(keys_text).collect();
                        (keys.join(", "), action.text(), action.explanation())
                    });
                is_empty &= !group(ui, menu.text(), rows, &words);
            }
            let gestures = GESTURES.iter().map(|(keys, text)| ((*keys).to_owned(), *text, ""));
            is_empty &= !group(ui, "Pointer", gestures, &words);
            if is_empty {
                ui.label(RichText::new("No key does that").color(theme::palette(ui).text3));
            }
        });
    });
    !(close || modal.should_close())
}

/// The rows of one menu that have all words; whether there are any.
fn group(
    ui: &mut Ui,
    title: &str,
    rows: impl Iterator<Item = (String, &'static str, &'static str)>,
    words: &[String],
) -> bool {
    let fits = |(keys, text, explanation): &(String, &str, &str)| {
        let all = format!("{keys} {text} {title} {explanation}").to_lowercase();
        words.iter().all(|word| all.contains(word.as_str()))
    };
    let rows: Vec<_> = rows.filter(fits).collect();
    if rows.is_empty() {
        return false;
    }
    let palette = theme::palette(ui);
    ui.add_space(4.0);
    ui.label(RichText::new(title).small().color(palette.text3));
    Grid::new(("keys", title))
        .num_columns(2)
        .min_col_width(KEYS)
        .min_row_height(size::ROW)
        .spacing(vec2(16.0, 0.0))
        .show(ui, |ui| {
            for (keys, text, explanation) in &rows {
                ui.label(RichText::new(keys).monospace().color(palette.text2));
                let label = ui.label(*text);
                if !explanation.is_empty() {
                    label.on_hover_text(*explanation);
                }
                ui.end_row();
            }
        });
    true
}
