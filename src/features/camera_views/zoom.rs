//! Zoom by the keyboard: of the active view, or of all views that are linked.

use egui::{Rect, pos2};

use crate::app::App;
use crate::features::camera_views::{TileEvent, stored_view};
use crate::widgets::Framing;

/// What one press magnifies by.
pub(crate) const STEP: f32 = 1.25;

impl App {
    /// Magnifies the active view about its middle, and the others with it where they are linked.
    pub(crate) fn zoom(&mut self, factor: f32) {
        let Some(take) = &self.state.session.take else { return };
        let active = self.state.selection.camera;
        let cameras = take.cameras.iter().enumerate();
        let zoomed = cameras.filter(|(index, _)| self.state.preferences.linked_zoom || *index == active);
        let framings: Vec<(usize, Framing)> = zoomed
            .filter_map(|(index, camera)| {
                let view = stored_view(&self.state.egui, index)?;
                let subject = self.state.session.subject.get(index).copied().flatten();
                let subject = subject.map(|[left, top, right, bottom]| {
                    Rect::from_min_max(pos2(left, top), pos2(right, bottom))
                });
                let view = view.zoomed_at(view.rect.center(), factor);
                Some((index, Framing::of(&view, [camera.width(), camera.height()], subject)))
            })
            .collect();
        for (index, framing) in framings {
            self.tile_event(index, TileEvent::SetFraming(framing));
        }
    }
}
