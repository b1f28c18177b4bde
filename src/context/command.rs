//! The commands of menus, toolbar, palette and keyboard, grouped by the feature that does them.
//!
//! | file | holds |
//! |---|---|
//! | `groups` | the commands of each feature |
//! | `table` | text, tooltip, menu and keys of every command |
//! | `menu` | the menus |
//! | `keys` | which keys were pressed, and how they are written |

/// Declares a group of commands. `every` lists them: a variant that carries something says what it may be.
macro_rules! group {
    ($(#[$meta:meta])* $name:ident { $($variant:ident $(($carried:ty) of $values:expr)?),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum $name { $($variant $(($carried))?),* }

        impl $name {
            #[cfg(test)]
            pub(super) fn every() -> Vec<Self> {
                let groups: Vec<Vec<Self>> = vec![$(group!(@values $variant $($values)?)),*];
                groups.concat()
            }
        }
    };
    (@values $variant:ident) => { vec![Self::$variant] };
    (@values $variant:ident $values:expr) => { $values.into_iter().map(Self::$variant).collect() };
}

mod groups;
mod keys;
mod menu;
mod table;

pub use groups::BasinView;
pub(crate) use groups::{
    BasinCommand, BeginningCommand, BodyPart, ConvergenceCommand, ExportCommand, FileCommand, FitCommand,
    HistoryCommand, LaboratoryCommand, Nudge, ObservabilityCommand, PoseCommand, RecoveryCommand,
    SceneCommand, TimelineCommand, TrackingCommand, Variants, ViewCommand, WindowCommand,
};
pub(crate) use keys::keys_text;
pub(crate) use menu::Menu;

use egui::KeyboardShortcut;

use backlit_take::demonstration::Demonstration;
use table::{CommandRow, TABLE};

group! {
    /// A command.
    Command {
        File(FileCommand) of FileCommand::every(),
        History(HistoryCommand) of HistoryCommand::every(),
        Recovery(RecoveryCommand) of RecoveryCommand::every(),
        Export(ExportCommand) of ExportCommand::every(),
        Pose(PoseCommand) of PoseCommand::every(),
        Window(WindowCommand) of WindowCommand::every(),
        View(ViewCommand) of ViewCommand::every(),
        Scene(SceneCommand) of SceneCommand::every(),
        Fit(FitCommand) of FitCommand::every(),
        Convergence(ConvergenceCommand) of ConvergenceCommand::every(),
        Basin(BasinCommand) of BasinCommand::every(),
        Beginning(BeginningCommand) of BeginningCommand::every(),
        Observability(ObservabilityCommand) of ObservabilityCommand::every(),
        Tracking(TrackingCommand) of TrackingCommand::every(),
        Timeline(TimelineCommand) of TimelineCommand::every(),
        Demonstration(Demonstration) of Demonstration::ALL,
        Laboratory(LaboratoryCommand) of LaboratoryCommand::every(),
        Offsets,
        Tour,
    }
}

impl Command {
    /// All commands, in the order of the menus.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.command)
    }

    /// The commands of a menu.
    pub(crate) fn in_menu(menu: Menu) -> impl Iterator<Item = Self> {
        TABLE.iter().filter(move |row| row.menu == menu).map(|row| row.command)
    }

    /// The command's name on buttons and in menus.
    pub(crate) fn text(self) -> &'static str {
        self.row().map_or("", |row| row.text)
    }

    /// One sentence about what it does, without its full stop.
    pub(crate) fn explanation(self) -> &'static str {
        self.row().map_or("", |row| row.tooltip)
    }

    /// The explanation and the keys, for a tooltip.
    pub(crate) fn tooltip(self) -> String {
        match self.keys_text() {
            Some(keys) => format!("{}   {keys}", self.explanation()),
            None => self.explanation().to_owned(),
        }
    }

    /// The menu it stands in.
    pub(crate) fn menu(self) -> Option<Menu> {
        self.row().map(|row| row.menu)
    }

    /// Its keys.
    pub(crate) fn shortcuts(self) -> &'static [KeyboardShortcut] {
        self.row().map_or(&[], |row| row.keys)
    }

    /// Its row of the table, where it has one: a ninth camera has none, nor has a tree of so many spheres.
    fn row(self) -> Option<&'static CommandRow> {
        TABLE.iter().find(|row| row.command == self)
    }
}
