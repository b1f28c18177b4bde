//! The command palette: a few letters of any command.

use backlit_ui::style::theme::{self, size};
use backlit_ui::widgets::{search_card, search_field};
use egui::{Button, Key, RichText, ScrollArea, Ui, vec2};

use crate::context::command::{Command, Menu, WindowCommand};
use crate::context::{Context, Requests, ShellRequest, unavailable};

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

/// A letter at the beginning of a word, right after the one before, and anywhere else.
const AT_WORD: i32 = 12;
const AFTER_LAST: i32 = 8;
const ANYWHERE: i32 = 1;
/// A word begins with all of what was typed.
const WHOLE: i32 = 40;
/// The name begins with what was typed; a letter that was skipped; a letter that is left.
const AT_START: i32 = 20;
const SKIPPED: i32 = -1;
const LONGER: i32 = 4;

/// How well `typed` fits `name`: more is better, `None` if it does not. Every word that was typed must be found, in any
/// order, its letters one after the other: "trf" and "for tra" both find "Track forward". Case does not matter.
pub(crate) fn fuzzy(typed: &str, name: &str) -> Option<i32> {
    let name: Vec<char> = name.to_lowercase().chars().collect();
    let typed = typed.to_lowercase();
    let mut sum = 0;
    for word in typed.split_whitespace() {
        let word: Vec<char> = word.chars().collect();
        let begins = |place: usize| place == 0 || !name[place - 1].is_alphanumeric();
        let is_whole = (0..name.len()).any(|place| begins(place) && name[place..].starts_with(&word));
        sum += best(&word, &name)? + if is_whole { WHOLE } else { 0 };
    }
    // Of two names that fit alike the shorter one is meant.
    Some(sum - name.len() as i32 / LONGER)
}

/// The best way to find the letters of one word.
fn best(word: &[char], name: &[char]) -> Option<i32> {
    // By place of the letter found last: the best sum so far.
    let mut sums: Vec<Option<i32>> = Vec::new();
    for (index, letter) in word.iter().enumerate() {
        let mut next: Vec<Option<i32>> = vec![None; name.len()];
        for (place, _) in name.iter().enumerate().filter(|(_, found)| *found == letter) {
            let begins = place == 0 || !name[place - 1].is_alphanumeric();
            let here = if begins { AT_WORD } else { ANYWHERE };
            next[place] = if index == 0 {
                Some(here + if place == 0 { AT_START } else { 0 })
            } else {
                let from = |before: usize| {
                    let adjacent = before + 1 == place;
                    let way = if adjacent { AFTER_LAST } else { SKIPPED * (place - before).min(10) as i32 };
                    sums[before].map(|sum| sum + way + here)
                };
                (0..place).filter_map(from).max()
            };
        }
        sums = next;
    }
    sums.into_iter().flatten().max()
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

    fn first<'a>(typed: &str, names: &[&'a str]) -> &'a str {
        let scored = names.iter().filter_map(|name| Some((fuzzy(typed, name)?, *name)));
        scored.max_by_key(|(score, _)| *score).map_or("", |(_, name)| name)
    }

    #[test]
    fn letters_of_words_find_them() {
        let names =
            ["Track forward", "Track back", "Step", "Step back", "Earlier step", "Reset layout", "Robust"];
        for (typed, expected) in [
            ("trf", "Track forward"),
            ("for tra", "Track forward"),
            ("tb", "Track back"),
            ("step", "Step"),
            ("STEP B", "Step back"),
            ("es", "Earlier step"),
            ("rl", "Reset layout"),
            ("rob", "Robust"),
            ("xyzzy", ""),
        ] {
            assert_eq!(first(typed, &names), expected, "{typed}");
        }
    }

    #[test]
    fn a_word_that_is_there_beats_its_letters_strewn_about() {
        let strewn = ["Stop export", "Paste pose", "Set or clear key pose"];
        for name in strewn {
            assert!(fuzzy("step", name) < fuzzy("step", "Earlier step"), "{name}");
        }
    }

    #[test]
    fn nothing_typed_fits_everything_and_odd_letters_are_no_harm() {
        assert!(fuzzy("", "Step").is_some());
        assert_eq!(fuzzy("stepx", "Step"), None);
        assert!(fuzzy("λ", "Prediction Λ").is_some());
        assert_eq!(fuzzy("a", ""), None);
    }
}
