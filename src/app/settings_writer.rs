//! The settings file follows the arrangement of the window.

use std::path::PathBuf;

use super::App;
use crate::app::settings::Settings;
use crate::app::settings_job::SettingsJob;
use crate::worker::Lane;

/// What is in the settings file.
#[derive(Debug)]
pub(crate) struct SettingsWriter {
    /// `None` without a folder for it.
    folder: Option<PathBuf>,
    written: Settings,
    failed: bool,
}

impl SettingsWriter {
    /// They are in the file as they are.
    pub(crate) fn new(folder: Option<PathBuf>, settings: &Settings) -> Self {
        Self { folder, written: settings.clone(), failed: false }
    }
}

impl App {
    /// Says what of the settings could not be read.
    pub fn complain(&mut self, unread: Option<String>) {
        if let Some(unread) = unread {
            self.state.notices.error(unread);
        }
    }

    /// Writes the settings, if they are others than in the file.
    pub(crate) fn write_settings(&mut self) {
        let settings = self.settings();
        let Some(folder) = self.settings_writer.folder.clone() else { return };
        if self.settings_writer.failed || self.settings_writer.written != settings {
            self.settings_writer.written = settings.clone();
            self.worker.request(Lane::Settings, SettingsJob { settings, folder });
        }
    }

    /// A failure is said once, until it works again.
    pub(crate) fn settings_written(&mut self, result: Result<(), String>) {
        match result {
            Ok(()) => self.settings_writer.failed = false,
            Err(why) if !std::mem::replace(&mut self.settings_writer.failed, true) => {
                let text = format!("The arrangement of the window is not kept for the next start: {why}");
                self.state.notices.error(text);
            }
            Err(_) => {}
        }
    }
}
