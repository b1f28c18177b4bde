//! The keys of commands: which were pressed, and how they are written.

use backlit_ui::widgets::focus_holds_arrows_only;
use egui::{Key, KeyboardShortcut, ModifierNames, Modifiers};

use super::table::TABLE;
use super::{Command, PoseCommand};

pub(super) const fn key(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

pub(super) const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

pub(super) const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

pub(super) const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

impl Command {
    /// Its first keys as they are written: "Ctrl+K".
    pub(crate) fn keys_text(self) -> Option<String> {
        self.shortcuts().first().map(keys_text)
    }

    /// The commands whose keys were pressed since the last frame; the key events are used up. While text is
    /// typed only commands with Ctrl and function keys act; while a button has the focus, its keys are its own.
    pub(crate) fn pressed(ctx: &egui::Context) -> Vec<Self> {
        let typing = ctx.text_edit_focused();
        let focused = ctx.egui_wants_keyboard_input();
        let arrows_only = focus_holds_arrows_only(ctx);
        let commands: Vec<Self> = ctx.input_mut(|input| {
            // Longer combinations first, or Ctrl+Shift+Z would be taken for Ctrl+Z.
            let mut rows: Vec<(&KeyboardShortcut, Self)> =
                TABLE.iter().flat_map(|row| row.keys.iter().map(move |keys| (keys, row.command))).collect();
            rows.sort_by_key(|(keys, _)| std::cmp::Reverse(modifier_count(keys.modifiers)));
            rows.retain(|(keys, _)| !typing || acts_while_typing(keys));
            rows.retain(|(keys, _)| !focused || !belongs_to_focus(keys, arrows_only));
            rows.retain(|(keys, _)| input.consume_shortcut(keys));
            rows.into_iter().map(|(_, command)| command).collect()
        });
        let tab = |command: &Self| {
            matches!(command, Self::Pose(PoseCommand::NextJoint | PoseCommand::PreviousJoint))
        };
        if commands.iter().any(tab) {
            // The same Tab would move the focus.
            ctx.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
        }
        commands
    }
}

/// Keys as they are written.
pub(crate) fn keys_text(keys: &KeyboardShortcut) -> String {
    match keys.logical_key {
        Key::Questionmark => "?".to_owned(),
        Key::OpenBracket => "[".to_owned(),
        Key::CloseBracket => "]".to_owned(),
        Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown => {
            keys.format(&ModifierNames::NAMES, false).replace("Arrow", "")
        }
        _ => keys.format(&ModifierNames::NAMES, false),
    }
}

fn modifier_count(modifiers: Modifiers) -> usize {
    usize::from(modifiers.shift)
        + usize::from(modifiers.command || modifiers.ctrl)
        + usize::from(modifiers.alt)
}

fn acts_while_typing(keys: &KeyboardShortcut) -> bool {
    let is_text_command =
        keys.modifiers.command && matches!(keys.logical_key, Key::C | Key::V | Key::Z | Key::Y | Key::A);
    (keys.modifiers.command && !is_text_command) || matches!(keys.logical_key, Key::F1 | Key::F2 | Key::F3)
}

fn belongs_to_focus(keys: &KeyboardShortcut, arrows_only: bool) -> bool {
    use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Enter, Space, Tab};
    let own = [ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Tab, Enter, Space];
    let own = if arrows_only { &own[..5] } else { &own };
    !keys.modifiers.command && own.contains(&keys.logical_key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::command::{FitCommand, HistoryCommand, TimelineCommand, WindowCommand};

    #[test]
    fn keys_are_written_plainly() {
        let text = |command: Command| command.keys_text();
        assert_eq!(text(Command::History(HistoryCommand::Redo)).as_deref(), Some("Ctrl+Shift+Z"));
        assert_eq!(text(Command::Fit(FitCommand::EarlierStep)).as_deref(), Some("Comma"));
        assert_eq!(text(Command::Timeline(TimelineCommand::NextFrame)).as_deref(), Some("Right"));
        assert!(Command::Window(WindowCommand::Palette).tooltip().ends_with("Ctrl+K"));
    }
}
