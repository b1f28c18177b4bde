//! The Refit section: fit one limb, its chain, or the whole body from the pose on the screen.

use backlit_ui::style::theme;
use backlit_ui::style::theme::space;
use backlit_ui::widgets::section;
use egui::{RichText, Ui};

use super::Fit;
use crate::context::command::{BodyPart, Command, FitCommand};
use crate::context::command_button::named_button;
use crate::context::{Context, Requests};

impl Fit {
    /// The Refit section, with what else it holds at its end.
    pub(crate) fn refit_section(
        &self,
        ui: &mut Ui,
        context: &Context<'_>,
        requests: &mut Requests,
        open: bool,
        more: impl FnOnce(&mut Ui, &mut Requests),
    ) {
        let last = self.refits.get(&context.selection.frame);
        let summary = last.map_or("the rest stays", |last| last.what.as_str());
        section(ui, "Refit", if open { "the rest stays" } else { summary }, open, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                let parts = [
                    (BodyPart::Limb, "Refit limb"),
                    (BodyPart::Chain, "Refit chain"),
                    (BodyPart::Body, "Refit body"),
                ];
                for (part, text) in parts {
                    named_button(ui, context, requests, Command::Fit(FitCommand::Refit(part)), text);
                }
            });
            ui.add_space(space::ROW);
            let palette = theme::palette(ui);
            let small =
                |text: String, colour| egui::Label::new(RichText::new(text).small().color(colour)).wrap();
            match last {
                Some(last) => {
                    ui.add(small(last.sentence(), palette.text2));
                    ui.add(small(format!("{}.", last.ending), palette.text3));
                }
                None => {
                    ui.add(small("No refit of this frame yet".to_owned(), palette.text3));
                }
            }
            more(ui, requests);
        });
    }
}
