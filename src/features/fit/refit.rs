//! The Refit section: fit one limb, its chain, or the whole body from the pose on the screen.

use egui::{RichText, Ui};

use crate::context::command::{Command, FitCommand, Part};
use crate::context::command_button::named_button;
use crate::context::{Context, Requests};
use crate::style::theme;
use crate::style::theme::space;
use crate::widgets::section;

/// The Refit section, with what a search for other poses has found.
pub(crate) fn ui(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    open: bool,
    other_poses: impl FnOnce(&mut Ui, &mut Requests),
) {
    let last = context.session.refits.get(&context.selection.frame);
    let summary = last.map_or("the rest stays", |last| last.what.as_str());
    section(ui, "Refit", if open { "the rest stays" } else { summary }, open, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            let parts =
                [(Part::Limb, "Refit limb"), (Part::Chain, "Refit chain"), (Part::Body, "Refit body")];
            for (part, text) in parts {
                named_button(ui, context, requests, Command::Fit(FitCommand::Refit(part)), text);
            }
        });
        ui.add_space(space::ROW);
        let palette = theme::palette(ui);
        let small = |text: String, colour| egui::Label::new(RichText::new(text).small().color(colour)).wrap();
        match last {
            Some(last) => {
                ui.add(small(last.sentence(), palette.text2));
                ui.add(small(format!("{}.", last.ending), palette.text3));
            }
            None => {
                ui.add(small("No refit of this frame yet".to_owned(), palette.text3));
            }
        }
        other_poses(ui, requests);
    });
}
