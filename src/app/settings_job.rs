//! Writing the settings.

use std::path::PathBuf;

use crate::app::settings::Settings;
use crate::app::settings_file;
use crate::context::write_advice::remedy;
use crate::worker::{Event, Job, Outbox, Step};

/// Settings to be written.
#[derive(Debug)]
pub struct SettingsJob {
    /// How the window is arranged.
    pub settings: Settings,
    /// The data folder.
    pub folder: PathBuf,
}

impl Job<Event> for SettingsJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let written = settings_file::write(&self.folder, &self.settings);
        out.send(Event::SettingsWritten(written.map_err(|error| format!("{error}. {}", remedy(&error)))));
        Step::Done
    }
}
