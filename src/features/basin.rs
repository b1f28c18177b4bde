//! The basin of the frame on the screen: how far off a start may be, and still end where it should.
//!
//! The experiment, its results and their files are [`backlit_runs::basin`]'s, the same that `backlit experiment basin` runs.
//! Here is what the window adds: settings as they are typed, results as they arrive.

mod panel;
pub(crate) mod settings;
#[cfg(test)]
mod tests;
mod update;

use std::time::Instant;

use backlit_jobs::Task;
use backlit_runs::basin::{BasinError, BasinResult, StartGrid, Trial};
use serde::{Deserialize, Serialize};
pub use settings::{BasinSettings, MapDirection, Reference};

use crate::context::command::BasinView;
use crate::context::file_dialog::FileDialogs;
use crate::context::priority;

/// What a result is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A table.
    Csv,
    /// A picture.
    Png,
    /// All numbers and options.
    Json,
}

impl FileKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Png, Self::Json];

    /// The endings of its files, and what is in them, on the menu.
    const fn words(self) -> (&'static [&'static str], &'static str) {
        match self {
            Self::Csv => (&["csv"], "Table as CSV…"),
            Self::Png => (&["png"], "Picture as PNG…"),
            Self::Json => (&["json"], "Numbers as JSON…"),
        }
    }

    /// The ending of its files.
    pub const fn extension(self) -> &'static str {
        self.words().0[0]
    }
}

/// What the cells of the map are coloured by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum MapColour {
    /// How far from the target the fit ended.
    #[default]
    Error,
    /// Whether it found it.
    Success,
}

/// What is chosen, kept from start to start.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BasinPreferences {
    /// What is tried.
    pub settings: BasinSettings,
    /// What is shown.
    pub view: BasinView,
    /// What cells are coloured by.
    pub(crate) colour: MapColour,
}

/// How far an experiment is that is going on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BasinProgress {
    pub(crate) view: BasinView,
    /// Fits done.
    pub done: usize,
    pub(crate) total: usize,
    /// Seconds that are left, as far as can be told.
    pub seconds_left: Option<f64>,
}

/// What came of the experiments, and what is shown of it.
#[derive(Debug, Clone, Default)]
pub struct BasinResults {
    /// Success over angle.
    pub angles: Option<BasinResult>,
    /// The map.
    pub map: Option<BasinResult>,
    /// The one choice whose map is shown; `None` shows those of all, side by side.
    shown_choice: Option<usize>,
    /// The cell of the map whose start was taken.
    taken: Option<[usize; 2]>,
    /// What is going on.
    pub running: Option<BasinProgress>,
}

impl BasinResults {
    /// What came of a view's experiment.
    fn of(&self, view: BasinView) -> Option<&BasinResult> {
        match view {
            BasinView::Angles => self.angles.as_ref(),
            BasinView::Map => self.map.as_ref(),
        }
    }

    fn of_mut(&mut self, view: BasinView) -> &mut Option<BasinResult> {
        match view {
            BasinView::Angles => &mut self.angles,
            BasinView::Map => &mut self.map,
        }
    }

    fn map_and_grid(&self) -> Option<(&BasinResult, &StartGrid)> {
        let map = self.map.as_ref()?;
        Some((map, map.grid()?))
    }
}

/// The feature.
#[derive(Debug, Default)]
pub struct Basin {
    /// What is chosen, kept from start to start.
    pub(crate) preferences: BasinPreferences,
    /// What came of it.
    pub results: BasinResults,
    /// Why nothing could be begun, a sentence without its full stop, until something else is tried.
    pub problem: Option<String>,
    task: Task<(), Result<Trial, BasinError>, { priority::BASIN }>,
    began: Option<Instant>,
    dialogs: FileDialogs<FileKind>,
}

impl Basin {
    pub(crate) fn is_running(&self) -> bool {
        self.results.running.is_some()
    }
}
