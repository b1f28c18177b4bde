//! Tiles of the centre: arranging them, opening and closing, one alone in the window.

use egui::Vec2;

use crate::app::App;
use crate::app::settings::Settings;
use crate::context::PaneEvent;
use crate::context::arrangement;
use crate::context::arrangement::{Arrangement, Centre};
use crate::context::command::{Command, WindowCommand};
use crate::context::pane::Pane;

/// What belongs to the tiles and is not kept for the next start.
#[derive(Debug)]
pub(crate) struct Docking {
    /// The pane that fills the centre.
    pub(crate) alone: Option<Pane>,
    /// The two cameras that are shown where there is room for two.
    pub(crate) pair: [usize; 2],
    /// Size of the centre in the last frame, in points.
    pub(crate) size: Vec2,
    /// How it looked before the layout was reset.
    pub(crate) before: Option<Box<Settings>>,
}

impl Default for Docking {
    fn default() -> Self {
        Self { alone: None, pair: [0, 1], size: Vec2::ZERO, before: None }
    }
}

impl App {
    fn centre(&self) -> Centre {
        Centre {
            layout: self.state.preferences.layout,
            cameras: self.state.session.camera_count(),
            pair: self.shell.docking.pair,
            size: self.shell.docking.size,
        }
    }

    /// The user's arrangement of this layout, else the automatic one.
    fn arrangement(&self) -> Arrangement {
        let centre = self.centre();
        let kept = self.state.preferences.kept.get(centre.layout, centre.cameras);
        kept.cloned().unwrap_or_else(|| arrangement::automatic(&centre))
    }

    /// The user has arranged the tiles.
    pub(crate) fn arrange(&mut self, tree: Arrangement) {
        let cameras = self.state.session.camera_count();
        self.state.preferences.kept.set(self.state.preferences.layout, cameras, tree);
    }

    pub(crate) fn pane_event(&mut self, pane: Pane, event: PaneEvent) {
        match event {
            PaneEvent::ToggleAlone => {
                self.shell.docking.alone =
                    if self.shell.docking.alone == Some(pane) { None } else { Some(pane) };
                if let Pane::Camera(camera) = pane {
                    self.make_active(camera);
                }
            }
            PaneEvent::Open => {
                let mut tree = self.arrangement();
                arrangement::open(&mut tree, pane);
                self.arrange(tree);
                self.shell.docking.alone = None;
            }
            PaneEvent::Close => {
                let mut tree = self.arrangement();
                arrangement::close(&mut tree, pane);
                self.arrange(tree);
                self.shell.docking.alone = self.shell.docking.alone.filter(|alone| *alone != pane);
            }
        }
    }

    /// Makes a camera's tile the active one, and shows it where it was hidden.
    pub(crate) fn make_active(&mut self, camera: usize) {
        if !self.shell.docking.pair.contains(&camera) {
            let other = usize::from(self.shell.docking.pair[0] == self.state.selection.camera);
            self.shell.docking.pair[other] = camera;
        }
        if matches!(self.shell.docking.alone, Some(Pane::Camera(_))) {
            self.shell.docking.alone = Some(Pane::Camera(camera));
        }
        self.state.selection.camera = camera;
        let cameras = self.state.session.camera_count();
        if let Some(kept) = self.state.preferences.kept.get(self.state.preferences.layout, cameras) {
            let mut tree = kept.clone();
            arrangement::open(&mut tree, Pane::Camera(camera));
            if tree != *kept {
                self.arrange(tree);
            }
        }
    }

    /// Shows another camera in the tile of one.
    pub(crate) fn switch_camera(&mut self, from: usize, to: usize) {
        if let Some(place) = self.shell.docking.pair.iter().position(|camera| *camera == from)
            && !self.shell.docking.pair.contains(&to)
        {
            self.shell.docking.pair[place] = to;
        }
        self.make_active(to);
    }

    /// Puts the tiles where they give the largest pictures, in this layout.
    pub(crate) fn arrange_tiles(&mut self) {
        self.shell.docking.before = Some(Box::new(self.settings()));
        self.shell.docking.alone = None;
        self.state.preferences.kept.forget(self.state.preferences.layout, self.state.session.camera_count());
        self.offer_layout_back("Arranged the tiles.");
    }

    /// Tiles, sizes and sections as they were at first.
    pub(crate) fn reset_layout(&mut self) {
        self.shell.docking.before = Some(Box::new(self.settings()));
        self.shell.docking.alone = None;
        let mut settings = self.settings();
        settings.reset();
        self.apply_settings(settings);
        self.offer_layout_back("Reset the layout.");
    }

    fn offer_layout_back(&mut self, text: &str) {
        let back = Command::Window(WindowCommand::RestoreLayout);
        self.state.notices.info(self.state.now, text, Some(back));
    }

    /// Takes back the last of the two.
    pub(crate) fn restore_layout(&mut self) {
        if let Some(before) = self.shell.docking.before.take() {
            let settings = before.with_memory_of(self.settings());
            self.apply_settings(settings);
            self.state.status = Some("The layout is as it was.".to_owned());
        }
    }

    pub(crate) fn toggle_pane(&mut self, pane: Pane) {
        let is_open = self.state.preferences.is_open(pane, self.state.session.camera_count());
        self.pane_event(pane, if is_open { PaneEvent::Close } else { PaneEvent::Open });
    }

    /// Whether a tile is being dragged: Esc is its own then.
    pub(crate) fn is_moving_tile(&self, ctx: &egui::Context) -> bool {
        let is_dragging = ctx.dragged_id().is_some() || ctx.drag_stopped_id().is_some();
        is_dragging && self.state.session.take.is_some() && self.arrangement().dragged_id(ctx).is_some()
    }
}
