//! The command palette: a few letters of any command.

use backlit_ui::style::theme;
use backlit_ui::style::theme::size;
use backlit_ui::widgets::{search_card, search_field};
use egui::{Button, Key, RichText, ScrollArea, Ui, vec2};

use crate::context::command::{Command, Menu, WindowCommand};
use crate::context::{Context, Requests, ShellRequest, unavailable};
use crate::shell::matching::fuzzy;

/// Width of the card.
const WIDTH: f32 = 580.0;
/// Rows that a page has.
const PAGE: usize = 12;
/// What is only in the explanation is worth less than what is in the name.
const ONLY_EXPLAINED: i32 = -1000;
/// A command that was used lately comes before one that fits about as well.
const USED_LATELY: i32 = 6;

/// What has been typed, and which row is marked.
#[derive(Debug, Default)]
pub(crate) struct Palette {
    text: String,
    marked: usize,
}

/// A command that fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Match {
    command: Command,
    /// Whether it stands among those that were used lately, above all others.
    is_recent: bool,
}

impl Palette {
    /// Shows the palette and says whether it stays open.
    pub(crate) fn ui(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let mut chosen = None;
        let modal = search_card(ui.ctx(), "palette").show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            let hint = "What do you want to do?";
            if search_field(ui, "Find a command", hint, &mut self.text).changed() {
                self.marked = 0;
            }
            let found = matching(&self.text, &context.preferences.used_commands);
            let has_moved = self.move_mark(ui, found.len());
            let enter = ui.input(|input| input.key_pressed(Key::Enter));
            ui.add_space(4.0);
            ScrollArea::vertical().max_height(360.0).show(ui, |ui| {
                ui.set_width(WIDTH);
                for (index, one) in found.iter().enumerate() {
                    if index > 0 && found[index - 1].is_recent && !one.is_recent {
                        ui.separator();
                    }
                    let is_marked = index == self.marked;
                    let clicked = row(ui, context, one.command, is_marked, has_moved);
                    if clicked || (enter && is_marked) {
                        chosen = Some(one.command);
                    }
                }
                if found.is_empty() {
                    ui.label(RichText::new("No command has these letters").color(theme::palette(ui).text3));
                }
            });
        });
        if let Some(command) = chosen.filter(|command| unavailable(*command, context).is_none()) {
            requests.request(ShellRequest::Used(command));
            requests.run(command);
            return false;
        }
        !modal.should_close()
    }

    /// Moves the mark by the keys, from the last row to the first too, and says whether it has moved.
    fn move_mark(&mut self, ui: &Ui, count: usize) -> bool {
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        let last = count.saturating_sub(1);
        let before = self.marked.min(last);
        self.marked = if pressed(Key::ArrowDown) {
            if before == last { 0 } else { before + 1 }
        } else if pressed(Key::ArrowUp) {
            if before == 0 { last } else { before - 1 }
        } else if pressed(Key::PageDown) {
            (before + PAGE).min(last)
        } else if pressed(Key::PageUp) {
            before.saturating_sub(PAGE)
        } else {
            before
        };
        self.marked != before
    }
}

/// A command with its keys, or with the reason why it cannot be used.
fn row(ui: &mut Ui, context: &Context<'_>, command: Command, is_marked: bool, scroll: bool) -> bool {
    let why_not = unavailable(command, context);
    let text = format!("{}: {}", command.menu().map_or("", Menu::text), command.text());
    let right = why_not.map_or_else(|| command.keys_text().unwrap_or_default(), str::to_owned);
    let button = Button::selectable(is_marked, text)
        .shortcut_text(RichText::new(right).small())
        .truncate()
        .min_size(vec2(ui.available_width(), size::BUTTON));
    let response = ui.add_enabled(why_not.is_none(), button);
    if is_marked && scroll {
        response.scroll_to_me(None);
    }
    let tooltip = match why_not {
        Some(why) => format!("{}\n{why}.", command.explanation()),
        None => command.explanation().to_owned(),
    };
    response.on_hover_text(&tooltip).on_disabled_hover_text(tooltip).clicked()
}

/// The commands that fit what was typed, the best first. Where nothing is typed: those that were used lately, then all
/// others in the order of the menus.
fn matching(text: &str, used: &[String]) -> Vec<Match> {
    let commands = || Command::all().filter(|command| *command != Command::Window(WindowCommand::Palette));
    let is_used = |command: Command| used.iter().any(|name| name == command.text());
    if text.trim().is_empty() {
        let recent = used.iter().filter_map(|name| commands().find(|command| command.text() == name));
        let recent = recent.map(|command| Match { command, is_recent: true });
        let rest = commands().filter(|command| !is_used(*command));
        return recent.chain(rest.map(|command| Match { command, is_recent: false })).collect();
    }
    let words: Vec<String> = text.to_lowercase().split_whitespace().map(str::to_owned).collect();
    let score = |command: Command| {
        let full = format!("{} {}", command.text(), command.menu().map_or("", Menu::text));
        let named = fuzzy(text, command.text()).into_iter().chain(fuzzy(text, &full)).max();
        let all = format!("{full} {}", command.explanation()).to_lowercase();
        let explained = || words.iter().all(|word| all.contains(word.as_str())).then_some(ONLY_EXPLAINED);
        let lately = if is_used(command) { USED_LATELY } else { 0 };
        Some(named.or_else(explained)? + lately)
    };
    let mut found: Vec<(i32, Match)> = commands()
        .filter_map(|command| Some((score(command)?, Match { command, is_recent: false })))
        .collect();
    // Letters that are scattered over a long name are chance, where others fit well.
    let best = found.iter().map(|(score, _)| *score).max().unwrap_or(0);
    found.retain(|(score, _)| *score <= ONLY_EXPLAINED + USED_LATELY || *score * 2 >= best);
    found.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
    found.into_iter().map(|(_, found)| found).collect()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::fit::Preset;

    use super::*;
    use crate::context::command::{ExportCommand, FitCommand, HistoryCommand, TrackingCommand, ViewCommand};

    fn commands(text: &str) -> Vec<Command> {
        matching(text, &[]).into_iter().map(|found| found.command).collect()
    }

    #[test]
    fn words_may_stand_in_any_order_and_the_best_come_first() {
        for (text, command) in [
            ("forward track", Command::Tracking(TrackingCommand::Forward)),
            ("step", Command::Fit(FitCommand::Step)),
            ("trf", Command::Tracking(TrackingCommand::Forward)),
            ("fs", Command::View(ViewCommand::FitSubject)),
            ("export ste", Command::Export(ExportCommand::Steps)),
            ("quaternions", Command::Fit(FitCommand::Preset(Preset::Report))),
        ] {
            assert_eq!(commands(text).first(), Some(&command), "{text}");
        }
        assert!(commands("xyzzy").is_empty());
        assert_eq!(commands("").len(), Command::all().count() - 1);
    }

    #[test]
    fn commands_that_were_used_lately_stand_first() {
        let used = ["Run", "Undo", "No longer a command"].map(str::to_owned);
        let found = matching("", &used);
        assert_eq!(
            (found[0].command, found[1].command),
            (Command::Fit(FitCommand::Run), Command::History(HistoryCommand::Undo))
        );
        assert!(found[1].is_recent && !found[2].is_recent);
        assert_eq!(found.len(), Command::all().count() - 1);
    }
}
