//! Writing the settings.

use std::path::PathBuf;

use super::{Event, Job, Outbox, Step};
use crate::look::Look;
use crate::remedy::remedy;
use crate::settings;

/// Settings to be written.
#[derive(Debug)]
pub struct SettingsJob {
    /// How the window is arranged.
    pub look: Look,
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
