//! Tiles of the centre: arranging them, opening and closing, one alone in the tiles.

use egui::Vec2;

use crate::context::arrangement::{Arrangement, Centre};
use crate::context::pane::Pane;
use crate::context::preferences::Preferences;
use crate::context::{PaneEvent, arrangement};
use crate::session::Session;
use crate::session::selection::Selection;

/// What belongs to the tiles and is not kept for the next start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Docking {
    pub(crate) alone: Option<Pane>,
    pub(crate) pair: [usize; 2],
    /// Size of the centre in the last frame, in points.
    pub(crate) size: Vec2,
}

impl Default for Docking {
    fn default() -> Self {
        Self { alone: None, pair: [0, 1], size: Vec2::ZERO }
    }
}

/// What the docking changes besides itself.
pub(crate) struct Tiles<'a> {
    pub(crate) preferences: &'a mut Preferences,
    pub(crate) selection: &'a mut Selection,
    pub(crate) session: &'a Session,
}

impl Docking {
    /// The user's arrangement of this layout, else the automatic one.
    fn arrangement(&self, preferences: &Preferences, session: &Session) -> Arrangement {
        let (layout, cameras) = (preferences.layout, session.camera_count());
        let centre = Centre { layout, cameras, pair: self.pair, size: self.size, aspect: session.aspect() };
        let kept = preferences.kept.get(layout, cameras);
        kept.cloned().unwrap_or_else(|| arrangement::automatic(&centre))
    }

    /// Does what the user asked of a tile.
    pub(crate) fn pane_event(&mut self, tiles: &mut Tiles<'_>, pane: Pane, event: PaneEvent) {
        let mut tree = self.arrangement(tiles.preferences, tiles.session);
        match event {
            PaneEvent::ToggleAlone => {
                self.alone = if self.alone == Some(pane) { None } else { Some(pane) };
                if let Pane::Camera(camera) = pane {
                    self.make_active(tiles, camera);
                }
            }
            PaneEvent::Open => {
                arrangement::open(&mut tree, pane);
                tiles.arrange(tree);
                self.alone = None;
            }
            PaneEvent::Close => {
                arrangement::close(&mut tree, pane);
                tiles.arrange(tree);
                self.alone = self.alone.filter(|alone| *alone != pane);
            }
        }
    }

    /// Opens a pane, or closes it.
    pub(crate) fn toggle_pane(&mut self, tiles: &mut Tiles<'_>, pane: Pane) {
        let is_open = tiles.preferences.is_open(pane, tiles.session.camera_count());
        self.pane_event(tiles, pane, if is_open { PaneEvent::Close } else { PaneEvent::Open });
    }

    /// Makes a camera's tile the active one, and shows it where it was hidden.
    pub(crate) fn make_active(&mut self, tiles: &mut Tiles<'_>, camera: usize) {
        if !self.pair.contains(&camera) {
            let other = usize::from(self.pair[0] == tiles.selection.camera);
            self.pair[other] = camera;
        }
        if matches!(self.alone, Some(Pane::Camera(_))) {
            self.alone = Some(Pane::Camera(camera));
        }
        tiles.selection.camera = camera;
        let kept = tiles.preferences.kept.get(tiles.preferences.layout, tiles.session.camera_count());
        if let Some(kept) = kept {
            let mut tree = kept.clone();
            arrangement::open(&mut tree, Pane::Camera(camera));
            if tree != *kept {
                tiles.arrange(tree);
            }
        }
    }

    /// Shows another camera in the tile of one.
    pub(crate) fn switch_camera(&mut self, tiles: &mut Tiles<'_>, from: usize, to: usize) {
        if let Some(place) = self.pair.iter().position(|camera| *camera == from)
            && !self.pair.contains(&to)
        {
            self.pair[place] = to;
        }
        self.make_active(tiles, to);
    }

    /// Whether a tile is being dragged: Esc is its own then.
    pub(crate) fn is_moving_tile(
        &self,
        ctx: &egui::Context,
        preferences: &Preferences,
        session: &Session,
    ) -> bool {
        let is_dragging = ctx.dragged_id().is_some() || ctx.drag_stopped_id().is_some();
        is_dragging
            && session.take.is_some()
            && self.arrangement(preferences, session).dragged_id(ctx).is_some()
    }
}

impl Tiles<'_> {
    /// The user has arranged the tiles.
    pub(crate) fn arrange(&mut self, tree: Arrangement) {
        self.preferences.kept.set(self.preferences.layout, self.session.camera_count(), tree);
    }
}
