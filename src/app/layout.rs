//! The arrangement of the window: tiles, and back to how it was at first.

use super::Inspector;
use crate::context::PaneEvent;
use crate::context::command::{Command, WindowCommand};
use crate::context::pane::Pane;
use crate::shell::docking::{Docking, Window};

impl Inspector {
    /// Lets the docking work on what the tiles are arranged in.
    pub(crate) fn dock<Answer>(
        &mut self,
        work: impl FnOnce(&mut Docking, &mut Window<'_>) -> Answer,
    ) -> Answer {
        let state = &mut self.state;
        let mut window = Window {
            preferences: &mut state.preferences,
            selection: &mut state.selection,
            session: &state.session,
        };
        work(&mut self.shell.docking, &mut window)
    }

    /// Does what the user asked of a tile.
    pub(crate) fn pane_event(&mut self, pane: Pane, event: PaneEvent) {
        self.dock(|docking, window| docking.pane_event(window, pane, event));
    }

    /// Puts the tiles where they give the largest pictures, in this layout.
    pub(crate) fn arrange_tiles(&mut self) {
        self.remember_layout();
        let cameras = self.state.session.camera_count();
        self.state.preferences.kept.forget(self.state.preferences.layout, cameras);
        self.offer_layout_back("Arranged the tiles.");
    }

    /// Tiles, sizes and sections as they were at first.
    pub(crate) fn reset_layout(&mut self) {
        self.remember_layout();
        let mut settings = self.settings();
        settings.reset();
        self.apply_settings(settings);
        self.offer_layout_back("Reset the layout.");
    }

    fn remember_layout(&mut self) {
        self.layout_before = Some(Box::new(self.settings()));
        self.shell.docking.alone = None;
    }

    fn offer_layout_back(&mut self, text: &str) {
        let back = Command::Window(WindowCommand::RestoreLayout);
        self.state.notices.info(self.state.now, text, Some(back));
    }

    /// Takes back the last of the two.
    pub(crate) fn restore_layout(&mut self) {
        if let Some(before) = self.layout_before.take() {
            let settings = before.with_memory_of(self.settings());
            self.apply_settings(settings);
            self.state.status = Some("The layout is as it was.".to_owned());
        }
    }
}
