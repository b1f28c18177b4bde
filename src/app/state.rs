//! The document with its history, and all that is around it.

use std::ops::{Deref, DerefMut};
use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_document::history::{History, Version};
use backlit_document::project::ProjectError;
use backlit_formats::Take;
use backlit_jobs::{Pool, Priority, Task};
use backlit_take::source::TakeSource;
use backlit_ui::drawing::Ghosts;

use super::inspector::Inspector;
use super::settings::Settings;
use super::settings_writer::SettingsWriter;
use crate::app::open_job::Opened;
use crate::app::writes::Writes;
use crate::context::Unavailable;
use crate::context::clock::Clock;
use crate::context::file_dialog::FileDialogs;
use crate::context::motions::MotionMarks;
use crate::context::notices::Notices;
use crate::context::observability::ObservabilityMarks;
use crate::context::preferences::Preferences;
use crate::features::recovery::Recovery;
use crate::session::Session;
use crate::session::playback::Playback;
use crate::session::selection::Selection;

/// What the window begins with.
#[derive(Debug, Default)]
pub struct AppOptions {
    /// The arrangement of the last time.
    pub settings: Settings,
    /// Folder for the copy of unsaved work and the settings; without one nothing is kept for the next start.
    pub data_folder: Option<PathBuf>,
    /// What is opened at once.
    pub opening: Option<Opening>,
    /// File that the state is written to after each frame in which it changed, for tests from outside.
    pub state_file: Option<PathBuf>,
    /// Whether the tour is offered, if it never was.
    pub offers_tour: bool,
    /// What time it is.
    pub clock: Clock,
    /// Whether no window was ever open before: its place is not known.
    pub is_first_window: bool,
    /// Whether jobs have no threads, and do a step of each kind in every frame: a test is the same every time then.
    pub is_inline: bool,
}

/// Something to open.
#[derive(Debug)]
pub enum Opening {
    /// A take.
    Take(TakeSource),
    /// A take that has been read.
    Ready(Box<Take>),
    /// A project file.
    Project(PathBuf),
    /// A project file whose take has moved.
    Moved {
        /// The project file.
        project: PathBuf,
        /// Where its take is now.
        take: PathBuf,
    },
}

/// What a file dialog was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    Take,
    FindTake,
    Project,
    SaveAs,
}

/// What the context lends to features and shell.
#[derive(Debug)]
pub(crate) struct State {
    pub(crate) history: History,
    pub(crate) selection: Selection,
    pub(crate) session: Session,
    /// How frames are played: neither saved nor undone.
    pub(crate) playback: Playback,
    pub(crate) preferences: Preferences,
    pub(crate) notices: Notices,
    /// What views and scene draw of what the cameras see.
    pub(crate) observability: ObservabilityMarks,
    /// What the tracked motion is called.
    pub(crate) motions: MotionMarks,
    /// Bodies that views and scene draw in the place of the posed one.
    pub(crate) ghosts: Option<Arc<Ghosts>>,
    /// What cannot be used in the frame that is shown.
    pub(crate) unavailable: Unavailable,
    /// The sentence of the status bar about what was just done.
    pub(crate) status: Option<String>,
    /// The project file, if there is one.
    pub(crate) project: Option<PathBuf>,
    /// Whether a take is being opened, or is about to be.
    pub(crate) is_opening: bool,
    /// The project that was not opened since its take was not there.
    pub(crate) lost_take: Option<PathBuf>,
    /// What time it is.
    pub(crate) clock: Clock,
    /// Seconds since the window was opened.
    pub(crate) now: f64,
    /// Time that the last frame of the window took, in seconds.
    pub(crate) frame_seconds: f64,
    pub(crate) pool: Pool,
    pub(crate) egui: egui::Context,
}

/// Takes and projects that are opened, and the dialogs that ask for files.
#[derive(Debug)]
pub(crate) struct Files {
    pub(crate) open: Task<(), Opened>,
    pub(crate) save: Task<PathBuf, Result<Version, ProjectError>>,
    pub(crate) take_in: Task<(), anyhow::Result<(Edit, String)>>,
    pub(crate) dialogs: FileDialogs<Asked>,
}

impl Default for Files {
    fn default() -> Self {
        Self {
            open: Task::new(Priority::OPEN),
            save: Task::new(Priority::SAVE),
            take_in: Task::new(Priority::TAKE_IN),
            dialogs: FileDialogs::default(),
        }
    }
}

/// The inspector in its window, on a desktop: with files, dialogs and other programs.
#[derive(Debug)]
pub struct App {
    pub(crate) inspector: Inspector,
    pub(crate) files: Files,
    pub(crate) writes: Writes,
    pub(crate) state_file: Option<PathBuf>,
    pub(crate) settings_writer: SettingsWriter,
    /// Whether the window is still to be placed on the screen.
    pub(crate) is_first_window: bool,
}

impl Deref for App {
    type Target = Inspector;

    fn deref(&self) -> &Inspector {
        &self.inspector
    }
}

impl DerefMut for App {
    fn deref_mut(&mut self) -> &mut Inspector {
        &mut self.inspector
    }
}

impl App {
    /// The window's state. `egui` is woken when a job has news.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(egui: egui::Context, options: AppOptions) -> anyhow::Result<Self> {
        let settings_writer = SettingsWriter::new(options.data_folder.clone(), &options.settings);
        let wake = egui.clone();
        let pool =
            if options.is_inline { Pool::inline() } else { Pool::start(move || wake.request_repaint())? };
        let mut inspector = Inspector::new(egui, pool, options.clock);
        inspector.features.recovery = Recovery::new(options.data_folder);
        inspector.apply_settings(options.settings);
        if options.offers_tour {
            inspector.features.tour.offer();
        }
        inspector.with(|features| &mut features.recovery, |recovery, _, requests| recovery.look(requests));
        let mut app = Self {
            inspector,
            files: Files::default(),
            writes: Writes::default(),
            state_file: options.state_file,
            settings_writer,
            is_first_window: options.is_first_window,
        };
        if let Some(opening) = options.opening {
            app.open(opening);
        }
        Ok(app)
    }
}
