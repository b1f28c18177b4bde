//! The basin of the frame on the screen: how far off a start may be, and still end where it should.
//!
//! The experiment itself is the lab's (`backlit_lab::experiment::{frame_basin, basin_map}`), the same that
//! `backlit experiment basin` runs, and so are its results and their files (`backlit_results::basin`). Here is what the window adds: settings as they are typed, results as they
//! arrive, and files of both.
//!
//! | file | holds |
//! |---|---|
//! | `settings` | [`BasinSettings`]: what is typed and chosen, and the options that follow |
//! | `preferences` | `BasinPreferences`: the settings and what is shown, kept from start to start |
//! | `results` | `BasinResults`: what came of it |
//! | `update` | begun, stopped, its starts taken, its files written |
//! | `job` | the fits, one a step |
//! | `panel` | the pane and the section of the right panel |

mod job;
mod panel;
pub(crate) mod preferences;
pub(crate) mod results;
pub(crate) mod settings;
#[cfg(test)]
mod tests;
mod update;

use backlit_jobs::Task;
use job::Fitted;
pub(crate) use preferences::{BasinPreferences, MapColour};
pub(crate) use results::{BasinResults, Running, ShownMap};
pub use settings::{BasinProblem, BasinSettings, MapDirection, Reference};
use std::time::Instant;

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

/// The feature.
#[derive(Debug)]
pub struct Basin {
    /// What is chosen, kept from start to start.
    pub(crate) preferences: BasinPreferences,
    /// What came of it.
    pub results: BasinResults,
    /// Why nothing could be begun, until something else is tried.
    pub problem: Option<BasinProblem>,
    task: Task<(), Fitted>,
    began: Option<Instant>,
    dialogs: FileDialogs<FileKind>,
}

impl Default for Basin {
    fn default() -> Self {
        Self {
            preferences: BasinPreferences::default(),
            results: BasinResults::default(),
            problem: None,
            task: Task::new(priority::BASIN),
            began: None,
            dialogs: FileDialogs::default(),
        }
    }
}

impl Basin {
    /// Whether fits are being made.
    pub(crate) fn is_running(&self) -> bool {
        self.results.running.is_some()
    }
}
