//! The document with its history, and all that is around it.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use backlit_formats::Take;
use backlit_tracking::body::builtin;

use super::failure::Broken;
use super::refresh::Refresh;
use super::settings::Settings;
use super::settings_writer::SettingsWriter;
use crate::app::open_job::Opened;
use crate::app::writes::Writes;
use crate::context::Unavailable;
use crate::context::clock::Clock;
use crate::context::notices::Notices;
use crate::context::observability::ObservabilityMarks;
use crate::context::pane::Pane;
use crate::context::preferences::{Layout, Preferences};
use crate::document::Document;
use crate::document::edit::Edit;
use crate::document::history::{Gesture, History};
use crate::document::project::ProjectError;
use crate::features::Features;
use crate::features::basin::Basin;
use crate::features::laboratory::Laboratory;
use crate::features::observability::Observability;
use crate::features::recovery::Recovery;
use crate::features::scene::Scene;
use crate::jobs::{Pool, Priority, Task};
use crate::session::Session;
use crate::session::playback::Playback;
use crate::session::selection::Selection;
use crate::shell::Shell;
use crate::take::source::TakeSource;
use crate::worker::{Event, Worker};

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

impl Opening {
    /// What it is called, in a sentence.
    fn name(&self) -> String {
        match self {
            Self::Take(TakeSource::Path(path)) | Self::Project(path) | Self::Moved { project: path, .. } => {
                path.file_name().map_or_else(|| "the take".into(), |name| name.to_string_lossy().into_owned())
            }
            Self::Take(TakeSource::Demonstration(_)) => "the demonstration".to_owned(),
            Self::Take(TakeSource::BuiltIn) => "the built-in take".to_owned(),
            Self::Ready(take) => take.name().to_owned(),
        }
    }
}

/// What a file dialog was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DialogKind {
    Take,
    FindTake,
    Project,
    SaveAs,
    Curves,
    Plot,
}

/// What a file dialog was asked for, and the file that was chosen.
pub(crate) type DialogAnswer = (DialogKind, PathBuf);

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
    /// What cannot be used in the frame that is shown.
    pub(crate) unavailable: Unavailable,
    /// The sentence of the status bar about what was just done.
    pub(crate) status: Option<String>,
    /// The project file, if there is one.
    pub(crate) project: Option<PathBuf>,
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
    /// The project that was not opened since its take was not there.
    pub(crate) lost_take: Option<PathBuf>,
    /// What is opened when the unsaved work is left.
    pub(crate) postponed: Option<Opening>,
    pub(crate) open: Task<(), Opened>,
    pub(crate) save: Task<PathBuf, Result<u64, ProjectError>>,
    pub(crate) take_in: Task<(), anyhow::Result<(Edit, String)>>,
    pub(crate) dialog_sender: Sender<DialogAnswer>,
    pub(crate) dialog_answers: Receiver<DialogAnswer>,
}

impl Default for Files {
    fn default() -> Self {
        let (dialog_sender, dialog_answers) = channel();
        Self {
            lost_take: None,
            postponed: None,
            open: Task::new(Priority::OPEN),
            save: Task::new(Priority::SAVE),
            take_in: Task::new(Priority::TAKE_IN),
            dialog_sender,
            dialog_answers,
        }
    }
}

/// The inspector.
#[derive(Debug)]
pub struct App {
    pub(crate) state: State,
    pub(crate) features: Features,
    pub(crate) shell: Shell,
    pub(crate) files: Files,
    pub(crate) refresh: Refresh,
    pub(crate) worker: Worker<Event>,
    pub(crate) writes: Writes,
    pub(crate) broken: Broken,
    pub(crate) state_file: Option<PathBuf>,
    /// How the window was arranged before its layout was reset.
    pub(crate) layout_before: Option<Box<Settings>>,
    pub(crate) settings_writer: SettingsWriter,
    pub(crate) clock: Clock,
    pub(crate) next_gesture: u64,
}

impl App {
    /// The window's state. `egui` is woken when a job has news.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(egui: egui::Context, options: AppOptions) -> anyhow::Result<Self> {
        let wake = |egui: &egui::Context| {
            let egui = egui.clone();
            move || egui.request_repaint()
        };
        let settings_writer = SettingsWriter::new(options.data_folder.clone(), &options.settings);
        let state = State {
            history: History::new(Document::new(builtin::full_body())),
            selection: Selection::default(),
            session: Session::default(),
            playback: Playback::default(),
            preferences: Preferences::default(),
            notices: Notices::default(),
            observability: ObservabilityMarks::default(),
            unavailable: Unavailable::default(),
            status: None,
            project: None,
            now: 0.0,
            frame_seconds: 0.0,
            pool: Pool::start(wake(&egui))?,
            egui: egui.clone(),
        };
        let mut app = Self {
            state,
            features: Features { recovery: Recovery::new(options.data_folder), ..Features::default() },
            shell: Shell::default(),
            files: Files::default(),
            refresh: Refresh::default(),
            worker: Worker::start(wake(&egui))?,
            writes: Writes::default(),
            broken: Broken::default(),
            state_file: options.state_file,
            layout_before: None,
            settings_writer,
            clock: options.clock,
            next_gesture: 1,
        };
        app.apply_settings(options.settings);
        if options.offers_tour {
            app.features.tour.offer();
        }
        app.with(|features| &mut features.recovery, |recovery, _, requests| recovery.look(requests));
        match options.opening {
            Some(opening) if !app.features.recovery.is_offered() => app.open(opening),
            // First the unsaved work: once something else is open, its own copy would take that one's place.
            opening => {
                app.features.recovery.let_wait(opening.as_ref().map(Opening::name));
                app.files.postponed = opening;
            }
        }
        Ok(app)
    }

    /// The document as it is.
    #[must_use]
    pub fn document(&self) -> &Document {
        self.state.history.document()
    }

    /// What is selected.
    #[must_use]
    pub fn selection(&self) -> &Selection {
        &self.state.selection
    }

    /// The derived data.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.state.session
    }

    /// Whether a pane is open.
    #[must_use]
    pub fn is_open(&self, pane: Pane) -> bool {
        self.state.preferences.is_open(pane, self.state.session.camera_count())
    }

    /// Whether there is work that is in no file.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.state.history.is_dirty()
    }

    /// The laboratory.
    #[must_use]
    pub fn laboratory(&self) -> &Laboratory {
        &self.features.laboratory
    }

    /// What was said.
    #[must_use]
    pub fn notices(&self) -> &Notices {
        &self.state.notices
    }

    /// What was tried of the basin.
    #[must_use]
    pub fn basin(&self) -> &Basin {
        &self.features.basin
    }

    /// What the cameras see of the pose.
    #[must_use]
    pub fn observability(&self) -> &Observability {
        &self.features.observability
    }

    /// The 3-D scene.
    #[must_use]
    pub fn shown_scene(&self) -> &Scene {
        &self.features.scene
    }

    /// Closes the cards of notices; they stay among the messages.
    pub fn close_notices(&mut self) {
        self.state.notices.close_all();
    }

    /// Whether nothing is being read, fitted or drawn anew: what is on the screen is whole.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        // A body that sways never comes to rest, and neither does its picture.
        let is_at_rest = match self.features.observability.is_playing() {
            true => self.features.scene.is_all_that_works(&self.state.pool),
            false => self.state.pool.is_idle(),
        };
        self.worker.is_idle()
            && is_at_rest
            && !(self.state.session.is_stale && !self.refresh.has_failed_to_predict())
            && !self.features.demonstrations.is_running()
            && self.features.laboratory.is_settled(&self.context())
    }

    /// Goes to a frame.
    pub fn go_to_frame(&mut self, frame: usize) {
        if self.state.selection.frame != frame {
            self.state.selection.go_to_frame(frame, self.state.session.frame_count());
        }
    }

    /// A gesture that was not used before.
    pub(crate) fn new_gesture(&mut self) -> Gesture {
        // Far from those of the panels, which count from one.
        self.next_gesture += 1;
        Gesture(u64::MAX - self.next_gesture)
    }

    /// Hands the theme to egui when it has changed.
    pub(crate) fn apply_theme(&mut self, ui: &mut egui::Ui) {
        if self.shell.shown_theme != Some(self.state.preferences.theme) {
            crate::style::theme::apply(ui.ctx(), self.state.preferences.theme);
            // This frame has begun in the old one.
            let style = ui.ctx().style_of(self.state.preferences.theme.to_egui());
            ui.set_style(style);
            self.shell.shown_theme = Some(self.state.preferences.theme);
        }
    }
}
