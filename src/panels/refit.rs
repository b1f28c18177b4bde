//! The Refit section: fit one limb, its chain, or the whole body from the pose on the screen.

use egui::{RichText, Ui};

use super::command::button;
use crate::action::Action;
use crate::format;
use crate::showing::{Intents, Showing};
use crate::theme;
use crate::widgets::section;

/// The Refit section.
pub(super) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, open: bool) {
    section(ui, "Refit", "the rest stays", open, |ui| {
        ui.horizontal(|ui| {
            for action in [Action::RefitLimb, Action::RefitChain, Action::RefitBody] {
                button(ui, showing, intents, action);
            }
        });
        let last = showing.session.runs.iter().rfind(|run| run.frame == showing.selection.frame);
        let text = match last.and_then(|run| Some((run, run.steps.first()?, run.steps.last()?))) {
            Some((run, first, last)) => {
                let (from, to) = (format::cost(first.mismatch), format::cost(last.mismatch));
                format!("{}: cost {from} to {to}", run.name)
            }
            None => "No run on this frame yet".to_owned(),
        };
        ui.label(RichText::new(text).small().color(theme::palette(ui).text3));
    });
}
