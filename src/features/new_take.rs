//! A take made of footage and a calibration: what lies in a folder, what is missing, and the take file that says so.
//!
//! | file | holds |
//! |---|---|
//! | `card` | the card on which a take is put together |
//! | `job` | looking at folders, learning backgrounds and writing the take |
//! | `update` | asked for, found, written, opened |

mod card;
mod job;
mod update;

use std::path::PathBuf;

use backlit_formats::import::ImportOptions;
use backlit_jobs::Task;

use crate::context::file_dialog::FileDialogs;
use crate::context::priority;

/// The feature.
#[derive(Debug)]
pub(crate) struct NewTake {
    /// Where the footage lies: folders, or files.
    paths: Vec<PathBuf>,
    options: ImportOptions,
    /// The frame rate as it is typed.
    rate: String,
    /// Folder of the take.
    out: String,
    state: State,
    look: Task<(Vec<PathBuf>, ImportOptions), Result<job::Looked, String>>,
    write: Task<(), job::Written>,
    dialogs: FileDialogs<Asked>,
}

/// What a dialog asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Asked {
    Footage,
    Calibration,
    Out,
}

/// How far it is.
#[derive(Debug, Default)]
enum State {
    /// Nothing is chosen yet.
    #[default]
    Empty,
    /// Folders are looked through.
    Looking,
    /// This was found.
    Found(Box<job::Looked>),
    /// It cannot be used; why not.
    Unusable(String),
    /// The take is being written; what is done just now.
    Writing(Box<job::Looked>, String),
}

impl Default for NewTake {
    fn default() -> Self {
        Self {
            paths: Vec::new(),
            options: ImportOptions::default(),
            rate: String::new(),
            out: String::new(),
            state: State::Empty,
            look: Task::new(priority::OPEN),
            write: Task::new(priority::EXPORT),
            dialogs: FileDialogs::default(),
        }
    }
}
