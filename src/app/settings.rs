//! The settings file follows the arrangement of the window.

use std::path::PathBuf;

use super::App;
use crate::app::settings_job::SettingsJob;
use crate::context::preferences::Preferences;
use crate::worker::Lane;

/// What is in the settings file.
#[derive(Debug)]
pub(crate) struct Settings {
    /// `None` without a folder for it.
    folder: Option<PathBuf>,
    written: Preferences,
    failed: bool,
}

impl Settings {
    /// They are in the file as they are.
    pub(crate) fn new(folder: Option<PathBuf>, look: &Preferences) -> Self {
        Self { folder, written: look.clone(), failed: false }
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
        let Some(folder) = self.settings.folder.clone() else { return };
        if self.settings.failed || self.settings.written != self.state.preferences {
            self.settings.written = self.state.preferences.clone();
            self.worker.request(Lane::Settings, SettingsJob { look: self.state.preferences.clone(), folder });
        }
    }

    /// A failure is said once, until it works again.
    pub(crate) fn settings_written(&mut self, result: Result<(), String>) {
        match result {
            Ok(()) => self.settings.failed = false,
            Err(why) if !std::mem::replace(&mut self.settings.failed, true) => {
                let text = format!("The arrangement of the window is not kept for the next start: {why}");
                self.state.notices.error(text);
            }
            Err(_) => {}
        }
    }
}
