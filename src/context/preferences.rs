//! How the window is arranged: kept from start to start, not in the document and not undone.

use std::path::PathBuf;

use backlit_ui::style::theme::{Theme, size};
use serde::{Deserialize, Serialize};

use crate::context::arrangement::{self, Kept};
use crate::context::pane::Pane;

/// What the window is arranged for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// Large views for setting a pose by hand.
    #[default]
    Pose,
    /// Views above the convergence plot and its steps.
    Debug,
    /// The laboratory: several ways to fit, from one start, side by side.
    Demonstrate,
}

impl Layout {
    /// The layouts with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Pose, "Pose"), (Self::Debug, "Debug"), (Self::Demonstrate, "Demonstrate")];

    /// Width of the right panel at first.
    pub(crate) const fn panel_width(self) -> f32 {
        match self {
            Self::Pose | Self::Demonstrate => size::RIGHT_PANEL,
            Self::Debug => size::RIGHT_PANEL_DEBUG,
        }
    }
}

/// Most recent takes that are offered.
const MAX_RECENT: usize = 5;

/// Megabytes that frames which were read may take at first, and may be chosen.
pub(crate) const FRAMES_MB: usize = 256;
pub(crate) const FRAMES_MB_CHOICES: std::ops::RangeInclusive<usize> = 64..=65_536;

/// The arrangement; what it is at first is said by the settings.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Preferences {
    pub(crate) theme: Theme,
    pub(crate) layout: Layout,
    pub(crate) panel: bool,
    pub(crate) frames_mb: usize,
    pub(crate) recent: Vec<PathBuf>,
    pub(crate) kept: Kept,
    pub(crate) used_commands: Vec<String>,
    pub(crate) generation: u32,
}

impl Preferences {
    /// Puts a take at the head of the recent ones.
    pub(crate) fn remember(&mut self, path: PathBuf) {
        put_first(&mut self.recent, path);
    }

    /// Puts a command at the head of those that were chosen last.
    pub(crate) fn use_command(&mut self, name: &str) {
        put_first(&mut self.used_commands, name.to_owned());
    }

    /// Whether a pane is open in the layout, for a take with this number of cameras.
    pub(crate) fn is_open(&self, pane: Pane, cameras: usize) -> bool {
        match self.kept.get(self.layout, cameras) {
            Some(tree) => arrangement::is_open(tree, pane),
            None => pane.is_open_at_first(self.layout),
        }
    }
}

fn put_first<T: PartialEq>(recent: &mut Vec<T>, newest: T) {
    recent.retain(|other| *other != newest);
    recent.insert(0, newest);
    recent.truncate(MAX_RECENT);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_takes_are_few_and_different() {
        let mut look = Preferences::default();
        for name in ["a", "b", "c", "a", "d", "e", "f"] {
            look.remember(PathBuf::from(name));
        }
        let names: Vec<_> = look.recent.iter().map(|path| path.to_string_lossy().into_owned()).collect();
        assert_eq!(names, ["f", "e", "d", "a", "c"]);
    }
}
