//! All keys, searchable, and the gestures of the pointer.

use backlit_ui::style::theme::{self, size};
use backlit_ui::widgets::{Icon, hint, icon_button, search_card, search_field};
use egui::{Align, Label, RichText, ScrollArea, Ui, vec2};

use crate::context::command::{Command, Menu, keys_text};
use crate::features::scene::panel as scene;

/// Width of the card, and of the columns of keys and of names.
const WIDTH: f32 = 760.0;
const KEYS: f32 = 150.0;
const NAMES: f32 = 190.0;
/// Height of the list, as a share of the window's.
const HEIGHT: f32 = 0.6;

/// Gestures of the pointer: they have no command.
const GESTURES: [(&str, &str); 13] = [
    ("Drag a joint", "Move it parallel to the picture; the chain follows"),
    ("Shift + drag", "Move it in depth"),
    ("Ctrl + drag", "Twist the limb"),
    ("Ctrl + Shift + drag", "Move the whole body"),
    ("Drag a limb", "Turn it about its joint"),
    ("Wheel", "Zoom at the pointer"),
    ("Middle drag", "Pan"),
    ("Hold H", "Keep the numbers of the pixel under the pointer"),
    ("Drag in the timeline", "Go through the frames"),
    ("Shift + drag there", "Mark frames, to play or clear only these; Shift + click clears the marks"),
    ("Wheel there", "Zoom at the pointer; sideways, with Shift or by middle drag: move"),
    ("Double-click there", "Show the whole take"),
    ("Drop a file", "Open a take or a project, or use its cameras, silhouettes, pose or body"),
];

/// Shows the list and says whether it stays open.
pub(crate) fn ui(ui: &Ui, search: &mut String) -> bool {
    let mut close = false;
    let modal = search_card(ui.ctx(), "shortcuts").show(ui.ctx(), |ui| {
        ui.set_width(WIDTH);
        ui.horizontal(|ui| {
            ui.label(RichText::new("Keys").text_style(theme::title()));
            ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
                close = icon_button(ui, Icon::Close, "Close keys", "Close   Esc").clicked();
            });
        });
        search_field(ui, "Search keys", "Search keys", search);
        ui.add_space(4.0);
        let words: Vec<String> = search.to_lowercase().split_whitespace().map(str::to_owned).collect();
        ScrollArea::vertical()
            .max_height(ui.ctx().content_rect().height() * HEIGHT)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                let mut is_empty = true;
                for menu in Menu::ALL {
                    let rows = Command::in_menu(menu).filter(|command| !command.shortcuts().is_empty()).map(
                        |command| {
                            let keys: Vec<String> = command.shortcuts().iter().map(keys_text).collect();
                            (keys.join(", "), command.text(), command.explanation())
                        },
                    );
                    is_empty &= !group(ui, menu.text(), rows, &words);
                }
                let of_scene = scene::input::KEYS.iter().map(|(keys, text)| ((*keys).to_owned(), *text, ""));
                is_empty &= !group(ui, "Pointer over the scene", of_scene, &words);
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
    hint(ui, title);
    for (keys, text, explanation) in &rows {
        ui.horizontal(|ui| {
            ui.set_min_height(size::ROW);
            let cell = |ui: &mut Ui, width: f32, text: RichText| {
                let row = egui::Layout::left_to_right(Align::Center);
                ui.allocate_ui_with_layout(vec2(width, size::ROW), row, |ui| {
                    ui.set_width(width);
                    ui.add(Label::new(text).truncate());
                });
            };
            cell(ui, KEYS, RichText::new(keys).monospace().color(palette.text2));
            cell(ui, NAMES, RichText::new(*text));
            let rest = ui.available_width();
            // Cut off, it says the whole by itself when the pointer rests on it.
            cell(ui, rest, RichText::new(*explanation).small().color(palette.text2));
        });
    }
    true
}
