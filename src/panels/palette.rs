//! The command palette: a few letters of any command.

use egui::{Button, Id, Key, Modal, RichText, ScrollArea, TextEdit, Ui, vec2};

use crate::action::Action;
use crate::showing::{Intents, Showing, unavailable};
use crate::theme::{self, size};

/// What has been typed, and which row is marked.
#[derive(Debug, Default)]
pub(crate) struct Palette {
    text: String,
    marked: usize,
}

impl Palette {
    /// Shows the palette and says whether it stays open.
    pub(crate) fn ui(&mut self, ui: &Ui, showing: &Showing<'_>, intents: &mut Intents) -> bool {
        let mut chosen = None;
        let modal = Modal::new(Id::unique("palette")).show(ui.ctx(), |ui| {
            ui.set_width(460.0);
            let hint = "What do you want to do?";
            let field =
                ui.add(TextEdit::singleline(&mut self.text).hint_text(hint).desired_width(f32::INFINITY));
            field.request_focus();
            if field.changed() {
                self.marked = 0;
            }
            let found = matching(&self.text);
            let (down, up, enter) = ui.input(|input| {
                (
                    input.key_pressed(Key::ArrowDown),
                    input.key_pressed(Key::ArrowUp),
                    input.key_pressed(Key::Enter),
                )
            });
            if down {
                self.marked += 1;
            }
            if up {
                self.marked = self.marked.saturating_sub(1);
            }
            self.marked = self.marked.min(found.len().saturating_sub(1));
            ui.add_space(4.0);
            ScrollArea::vertical().max_height(360.0).show(ui, |ui| {
                for (index, action) in found.iter().enumerate() {
                    let clicked = row(ui, showing, *action, index == self.marked, down || up);
                    if clicked || (enter && index == self.marked) {
                        chosen = Some(*action);
                    }
                }
                if found.is_empty() {
                    ui.label(RichText::new("No command has these letters").color(theme::palette(ui).text3));
                }
            });
        });
        if let Some(action) = chosen.filter(|action| unavailable(*action, showing).is_none()) {
            intents.act(action);
            return false;
        }
        !modal.should_close()
    }
}

fn row(ui: &mut Ui, showing: &Showing<'_>, action: Action, is_marked: bool, scroll: bool) -> bool {
    let why_not = unavailable(action, showing);
    let text = format!("{}: {}", action.menu().text(), action.text());
    let keys = action.keys_text().unwrap_or_default();
    let button = Button::selectable(is_marked, text)
        .shortcut_text(keys)
        .min_size(vec2(ui.available_width(), size::BUTTON));
    let response = ui.add_enabled(why_not.is_none(), button);
    if is_marked && scroll {
        response.scroll_to_me(None);
    }
    let tooltip = why_not.unwrap_or_else(|| action.explanation());
    response.on_hover_text(tooltip).on_disabled_hover_text(tooltip).clicked()
}

/// The commands that contain all typed words, those that begin with them first.
fn matching(text: &str) -> Vec<Action> {
    let text = text.to_lowercase();
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut found: Vec<(bool, Action)> = Action::all()
        .filter(|action| *action != Action::Palette)
        .filter_map(|action| {
            let name = format!("{} {}", action.menu().text(), action.text()).to_lowercase();
            let all = format!("{name} {}", action.explanation().to_lowercase());
            let begins = words.first().is_none_or(|word| action.text().to_lowercase().starts_with(word));
            words.iter().all(|word| all.contains(word)).then_some((!begins, action))
        })
        .collect();
    found.sort_by_key(|(later, _)| *later);
    found.into_iter().map(|(_, action)| action).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_may_stand_in_any_order_and_beginnings_come_first() {
        assert_eq!(matching("forward track"), [Action::TrackForward]);
        assert_eq!(matching("step").first(), Some(&Action::Step));
        assert!(matching("xyzzy").is_empty());
        assert_eq!(matching("").len(), Action::all().count() - 1);
    }
}
