//! The inspector on a desktop: the frame loop, files, settings, pictures without a display.
//!
//! | file | holds |
//! |---|---|
//! | `state` | [`App`]: the inspector on a desktop; what the context lends |
//! | `inspector` | [`Inspector`]: all that is shown and worked on, without a desktop |
//! | `screen` | what is shown where |
//! | `features` | what the features do by themselves in every frame |
//! | `requests`, `commands`, `unavailable` | what was asked for is done; or why it cannot be |
//! | `refresh` | what the screen lacks is made |
//! | `files`, `open_job`, `opened` | takes and projects: asked for, read, and what follows when one is open |
//! | `dropping`, `take_in_job` | files that are dropped on the window |
//! | `writes` | files that are made of results |
//! | `settings`, `settings_file`, `settings_writer`, `layout` | what is kept from start to start; the arrangement and back |
//! | `off_screen`, `headless` | pictures for exports and without a display |
//! | `state_dump` | the state as a file, for tests from outside |
//! | `open_with_system` | folders and pages in other programs |
//! | `window` | the window is opened |

pub(crate) mod calibrate_job;
pub(crate) mod commands;
pub(crate) mod dropping;
pub(crate) mod features;
pub(crate) mod files;
pub(crate) mod headless;
pub(crate) mod inspector;
pub(crate) mod layout;
pub(crate) mod off_screen;
pub(crate) mod open_job;
pub(crate) mod open_with_system;
pub(crate) mod opened;
pub(crate) mod playing;
pub(crate) mod refresh;
pub(crate) mod requests;
pub(crate) mod screen;
pub mod settings;
pub mod settings_file;
pub(crate) mod settings_writer;
pub(crate) mod state;
pub(crate) mod state_dump;
pub(crate) mod survey_job;
pub(crate) mod take_in_job;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod unavailable;
pub(crate) mod window;
pub(crate) mod writes;

pub use files::opening_of;
pub(crate) use headless::headless_export;
pub(crate) use headless::{PictureOptions, headless_picture};
pub use inspector::Inspector;
pub use state::{App, AppOptions, Opening};

use inspector::Errand;

use crate::context::Request;
use crate::context::command::Command;

impl App {
    /// One frame of the window.
    pub fn frame(&mut self, ui: &mut egui::Ui) {
        self.begin_frame(ui);
        self.take_in_files();
        self.take_in_dropped();
        self.take_in_settings();
        self.take_in_written();
        self.take_in_chosen_files();
        self.take_dropped_files(ui.ctx());
        self.inspector.frame(ui);
        self.do_errands();
        self.export_state();
    }

    /// Does a command, if it can be used now.
    pub(crate) fn run(&mut self, command: Command, ctx: &egui::Context) {
        self.inspector.run(command, ctx);
        self.do_errands();
    }

    /// Does what the inspector has left to the desktop.
    fn do_errands(&mut self) {
        for errand in std::mem::take(&mut self.errands) {
            match errand {
                Errand::Command(command) => self.file_command(command),
                Errand::Open(opening) => self.open(opening),
                Errand::Write(write) => self.write(write),
                Errand::Request(Request::OpenPath(path)) => self.open_path(&path),
                Errand::Request(Request::OpenOutside(address)) => self.open_outside(address),
                Errand::Request(Request::Export) => self.begin_export(),
                Errand::Request(_) => {}
            }
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.place_first_window(ui.ctx());
        self.frame(ui);
    }

    /// The storage itself keeps the window's place and egui's memory.
    fn save(&mut self, _storage: &mut dyn eframe::Storage) {
        self.write_settings();
    }

    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        // What goes wrong was said when the window was asked to close.
        let _ = self
            .with(|features| &mut features.recovery, |recovery, context, all| recovery.keep(context, all));
    }
}
