//! The commands of menus, toolbar, palette and keyboard, grouped by the feature that does them.

/// Declares groups of commands. `every` lists those of a group: a variant that carries something says what it may be.
macro_rules! groups {
    (@values $variant:ident) => { vec![Self::$variant] };
    (@values $variant:ident $values:expr) => { $values.into_iter().map(Self::$variant).collect() };
    ($($(#[$meta:meta])* $name:ident {
        $($variant:ident $(($carried:ty) of $values:expr)?),* $(,)?
    })*) => {
        $($(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum $name { $($variant $(($carried))?),* }

        impl $name {
            #[cfg(test)]
            pub(super) fn every() -> Vec<Self> {
                let groups: Vec<Vec<Self>> = vec![$(groups!(@values $variant $($values)?)),*];
                groups.concat()
            }
        })*
    };
}

mod groups;
mod keys;
mod table;

pub use groups::BasinView;
pub(crate) use groups::{
    BasinCommand, BeginningCommand, BodyPart, CompareCommand, ConvergenceCommand, ExportCommand, FileCommand,
    FitCommand, HistoryCommand, LaboratoryCommand, Nudge, ObservabilityCommand, PoseCommand, RecoveryCommand,
    SceneCommand, SilhouetteCommand, TimelineCommand, TrackingCommand, Variants, ViewCommand, WindowCommand,
};
pub(crate) use keys::keys_text;

use egui::KeyboardShortcut;

use backlit_take::demonstration::Demonstration;
use table::{CommandRow, TABLE};

groups! {
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
        Silhouettes(SilhouetteCommand) of SilhouetteCommand::every(),
        Compare(CompareCommand) of CompareCommand::every(),
        Tracking(TrackingCommand) of TrackingCommand::every(),
        Timeline(TimelineCommand) of TimelineCommand::every(),
        Demonstration(Demonstration) of Demonstration::ALL,
        Laboratory(LaboratoryCommand) of LaboratoryCommand::every(),
        Bookmarks,
        Offsets,
        CameraCheck,
        CameraPlan,
        CameraRefinement,
        Tour,
    }
}

impl Command {
    /// All commands, in the order of the menus.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|row| row.command)
    }

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

    pub(crate) fn menu(self) -> Option<Menu> {
        self.row().map(|row| row.menu)
    }

    pub(crate) fn shortcuts(self) -> &'static [KeyboardShortcut] {
        self.row().map_or(&[], |row| row.keys)
    }

    /// Its row of the table. A ninth camera has none, nor has a sphere tree with a fixed number of spheres.
    fn row(self) -> Option<&'static CommandRow> {
        TABLE.iter().find(|row| row.command == self)
    }
}

/// The menus, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Menu {
    File,
    Edit,
    View,
    Fit,
    Track,
    Demonstrate,
    Help,
}

impl Menu {
    pub(crate) const ALL: [Self; 7] =
        [Self::File, Self::Edit, Self::View, Self::Fit, Self::Track, Self::Demonstrate, Self::Help];

    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Fit => "Fit",
            Self::Track => "Track",
            Self::Demonstrate => "Demonstrate",
            Self::Help => "Help",
        }
    }
}
