//! The inspector on a desktop: the frame loop, files, settings, pictures without a display.

pub(crate) mod dropping;
pub(crate) mod files;
pub(crate) mod headless;
pub(crate) mod inspector;
pub(crate) mod off_screen;
pub(crate) mod open_job;
pub(crate) mod opened;
pub(crate) mod place;
pub(crate) mod refresh;
pub(crate) mod requests;
pub mod settings;
pub mod settings_file;
pub(crate) mod state;
pub(crate) mod state_dump;
pub(crate) mod survey_job;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod window;

pub(crate) use headless::{PictureOptions, headless_export, headless_picture};
pub use inspector::Inspector;
pub use open_job::Opening;
pub use place::Place;
pub use state::State;

use std::path::{Path, PathBuf};

use backlit_jobs::Pool;

use crate::context::DesktopRequest;
use crate::context::clock::Clock;
use crate::context::command::Command;
use crate::features::recovery::Recovery;
use files::Files;
use settings::Settings;
use settings_file::SettingsWriter;

/// What the window begins with.
#[derive(Debug, Default)]
pub struct AppOptions {
    /// The arrangement of the last time.
    pub settings: Settings,
    /// Folder for the copy of unsaved work and the settings; without one nothing is kept for the next start.
    pub data_folder: Option<PathBuf>,
    /// What is opened at once.
    pub opening: Option<Opening>,
    /// Where to go once that is open.
    pub place: Option<Place>,
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

/// The inspector in its window, on a desktop: with files, dialogs and other programs.
#[derive(Debug)]
pub struct App {
    /// All that is shown and worked on.
    pub inspector: Inspector,
    pub(crate) files: Files,
    settings_writer: SettingsWriter,
    state_file: Option<PathBuf>,
    /// Whether the window is still without its place on the screen.
    is_first_window: bool,
}

impl App {
    /// The window's state. `egui` is woken when a job has an event.
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
        inspector.ask(|features, _, requests| features.recovery.check(requests));
        let (state_file, is_first_window) = (options.state_file, options.is_first_window);
        let files = Files::default();
        let mut app = Self { inspector, files, settings_writer, state_file, is_first_window };
        app.inspector.state.place = options.place;
        if let Some(opening) = options.opening {
            app.open(opening);
        }
        Ok(app)
    }

    /// One frame of the window.
    pub fn frame(&mut self, ui: &mut egui::Ui) {
        let Self { inspector, files, settings_writer, .. } = self;
        inspector.begin_frame(ui);
        files.take_in(inspector);
        settings_writer.take_in(&mut inspector.state.notices);
        files.take_dropped(inspector, ui.ctx());
        inspector.frame(ui);
        self.do_errands();
        if let Some(path) = &self.state_file {
            state_dump::export(self, path);
        }
    }

    /// Opens a take or a project. What is not saved is kept as a copy.
    pub fn open(&mut self, opening: Opening) {
        self.files.open(&mut self.inspector, opening);
    }

    /// Opens the project whose take was not there with the take in this folder.
    pub fn find_take(&mut self, take: &Path) {
        self.files.find_take(&mut self.inspector, take);
    }

    /// Writes the project to a file.
    pub fn save_to(&mut self, path: &Path) {
        self.files.save_to(&self.inspector.state, path);
    }

    /// Does a command, if it can be used now.
    pub(crate) fn run(&mut self, command: Command) {
        self.inspector.run(command);
        self.do_errands();
    }

    /// Does what the inspector has left to the desktop.
    fn do_errands(&mut self) {
        for errand in std::mem::take(&mut self.inspector.errands) {
            match errand {
                DesktopRequest::File(command) => self.files.command(&mut self.inspector, command),
                DesktopRequest::Open(source) => self.open(Opening::Take(source)),
                DesktopRequest::OpenPath(path) => self.open(Opening::of(&path)),
                DesktopRequest::OpenOutside(address) => {
                    files::open_outside(&mut self.inspector.state, address);
                }
                DesktopRequest::Export => off_screen::begin_export(&mut self.inspector),
                DesktopRequest::Write(write) => self.files.write(&self.inspector.state, write),
            }
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        if self.is_first_window {
            self.is_first_window = !window::place_first(ui.ctx());
        }
        self.frame(ui);
    }

    /// The storage itself keeps the window's place and egui's memory.
    fn save(&mut self, _storage: &mut dyn eframe::Storage) {
        self.settings_writer.write(self.inspector.kept_settings(), &self.inspector.state.pool);
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        // What goes wrong was said when the window was asked to close.
        let _ = self.inspector.ask(|features, context, all| features.recovery.keep(context, all));
    }
}
