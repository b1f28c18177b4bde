//! What the features do by themselves in every frame.

use std::path::Path;

use super::App;
use crate::context::command::Command;
use crate::context::{Context, Unavailable};
use crate::features::basin::{BasinSettings, FileKind};

impl App {
    /// Every feature takes in what its tasks have done, and asks for what it lacks.
    pub(crate) fn update_features(&mut self) {
        self.with(|features| &mut features.basin, |basin, context, requests| basin.update(context, requests));
        self.with(
            |features| &mut features.tracking,
            |tracking, context, requests| tracking.update(context, requests),
        );
        self.with(|features| &mut features.timeline, |timeline, context, _| timeline.update(context));
    }

    /// Asks the features why their commands cannot be used now.
    pub(crate) fn ask_what_is_unavailable(&mut self) {
        let context = self.context();
        self.state.unavailable = Unavailable::ask(|command| self.why_not(command, &context));
    }

    fn why_not(&self, command: Command, context: &Context<'_>) -> Option<&'static str> {
        match command {
            Command::Tracking(command) => self.features.tracking.unavailable(command, context),
            Command::Timeline(command) => self.features.timeline.unavailable(command, context),
            _ => None,
        }
    }

    /// Other settings of the basin.
    pub fn set_basin(&mut self, settings: BasinSettings) {
        self.features.basin.set(settings);
    }

    /// Writes what the basin's pane shows to a file.
    pub fn export_basin_to(&mut self, kind: FileKind, path: &Path) {
        self.with(
            |features| &mut features.basin,
            |basin, context, requests| {
                basin.write(kind, path, context.preferences.theme, requests);
            },
        );
    }
}
