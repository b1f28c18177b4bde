//! The settings file follows the arrangement of the window.

use std::path::PathBuf;

use backlit_formats::FileError;
use backlit_jobs::{News, Priority, Task, once};

use super::App;
use crate::app::settings::Settings;
use crate::app::settings_file;
use crate::context::write_advice::write_advice;

/// What is in the settings file.
#[derive(Debug)]
pub(crate) struct SettingsWriter {
    /// `None` without a folder for it.
    folder: Option<PathBuf>,
    written: Settings,
    failed: bool,
    task: Task<(), Result<(), FileError>>,
}

impl SettingsWriter {
    /// They are in the file as they are.
    pub(crate) fn new(folder: Option<PathBuf>, settings: &Settings) -> Self {
        Self { folder, written: settings.clone(), failed: false, task: Task::new(Priority::SETTINGS) }
    }
}

impl App {
    /// Says what of the settings could not be read.
    pub(crate) fn complain(&mut self, unread: Option<String>) {
        if let Some(unread) = unread {
            self.inspector.state.notices.error(unread);
        }
    }

    /// Writes the settings, if they are others than in the file.
    pub(crate) fn write_settings(&mut self) {
        let settings = self.settings();
        let Some(folder) = self.settings_writer.folder.clone() else { return };
        if self.settings_writer.failed || self.settings_writer.written != settings {
            self.settings_writer.written = settings.clone();
            let write = move |_: &_| settings_file::write(&folder, &settings);
            self.settings_writer.task.begin(&self.inspector.state.pool, (), |()| once(write));
        }
    }

    /// Hears whether the settings were written. A failure is said once, until it works again.
    pub(crate) fn take_in_settings(&mut self) {
        for news in self.settings_writer.task.poll() {
            match news {
                News::Output(result) => self.settings_written(result),
                News::Ended => {}
                News::Failed(failure) => self.failed("Keeping the settings", &failure),
            }
        }
    }

    fn settings_written(&mut self, result: Result<(), FileError>) {
        match result {
            Ok(()) => self.settings_writer.failed = false,
            Err(why) if !std::mem::replace(&mut self.settings_writer.failed, true) => {
                let advice = write_advice(&why);
                let text =
                    format!("The window’s settings were not saved for the next start: {why}. {advice}");
                self.inspector.state.notices.error(text);
            }
            Err(_) => {}
        }
    }
}
