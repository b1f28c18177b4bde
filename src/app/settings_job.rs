//! Writing the settings.

use std::path::PathBuf;

use crate::app::settings_file as settings;
use crate::context::preferences::Preferences;
use crate::context::write_advice::remedy;
use crate::worker::{Event, Job, Outbox, Step};

/// Settings to be written.
#[derive(Debug)]
pub struct SettingsJob {
    /// How the window is arranged.
    pub look: Preferences,
    /// The data folder.
    pub folder: PathBuf,
}

impl Job<Event> for SettingsJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        let written = settings::write(&self.folder, &self.look);
        out.send(Event::SettingsWritten(written.map_err(|error| format!("{error}. {}", remedy(&error)))));
        Step::Done
    }
}
