//! Posing by hand: drags in the cameras' views, nudges, numbers, the clipboard.

mod clipboard;
mod commands;
mod drag;
mod dragged;
mod joint;
mod panel;
mod placement;
mod sizes;
#[cfg(test)]
mod tests;

use backlit_tracking::posing::LimitedAngle;
use clipboard::Clipboard;
use drag::{Dragging, NUDGE_SECONDS, Nudging};
use egui::Ui;

use crate::context::marks::{DragMarks, Placement};
use crate::context::{Context, Requests};

/// The feature.
#[derive(Debug, Default)]
pub(crate) struct Posing {
    dragging: Option<Dragging>,
    nudging: Option<Nudging>,
    placement: Option<Placement>,
    clipboard: Clipboard,
}

impl Posing {
    /// What others must know of the drag.
    pub(crate) fn marks(&self, now: f64) -> DragMarks {
        let nudging = self.nudging.as_ref().filter(|nudging| now - nudging.at < NUDGE_SECONDS);
        match &self.dragging {
            Some(dragging) => dragging.marks(),
            None => {
                let from = nudging.map(|nudging| nudging.base.clone());
                DragMarks { from, placement: self.placement.clone(), ..DragMarks::default() }
            }
        }
    }

    /// The sections of limbs and joint, open at first where posing is what the layout is for; the joint's angle that is
    /// looked at.
    pub(crate) fn limbs(
        ui: &mut Ui,
        context: &Context<'_>,
        requests: &mut Requests,
        open: bool,
    ) -> Option<LimitedAngle> {
        panel::ui(ui, context, requests, open);
        joint::ui(ui, context, requests, open)
    }

    /// The section of the selected limb's size.
    pub(crate) fn sizes(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        sizes::ui(ui, context, requests, false);
    }
}
