//! The Refit section: fit one limb, its chain, or the whole body from the pose on the screen; and what that has done to the
//! cost, in words that stay.

use backlit_ui::style::theme::space;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::section;
use egui::{RichText, Ui};

use super::Fit;
use crate::context::command::{BodyPart, Command, FitCommand};
use crate::context::command_button::named_button;
use crate::context::{Context, Requests};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Refitted {
    /// What was fitted: "Refit right forearm".
    pub(crate) what: String,
    /// Mismatch before, squared grey levels.
    pub(crate) before: f64,
    pub(crate) after: f64,
    /// Accepted and rejected steps.
    pub(crate) steps: usize,
    /// How it ended, without its full stop.
    pub(crate) ending: String,
}

impl Refitted {
    /// Whether the pose that it found fits worse than the one before.
    pub(crate) fn is_worse(&self) -> bool {
        self.after > self.before
    }

    /// "Refit right forearm: cost fell by 3.1 %, from 1.84e7 to 1.78e7, in 12 steps."
    pub(crate) fn sentence(&self) -> String {
        let change = 100.0 * (self.after / self.before - 1.0);
        let how = match change {
            change if !change.is_finite() || change.abs() < 0.05 => "cost stayed".to_owned(),
            change if change < 0.0 => format!("cost fell by {} %", format::number(-change, 1)),
            change => {
                let share = format::number(change, 1);
                return format!(
                    "{}: no better pose was found (cost {share} % higher), so the body stays.",
                    self.what
                );
            }
        };
        let (before, after) = (format::cost(self.before), format::cost(self.after));
        let steps = format::counted(self.steps, "step");
        format!("{}: {how}, from {before} to {after}, in {steps}.", self.what)
    }
}

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
            let said = last.map(|last| (last.sentence(), palette.text2));
            let ending = last
                .map_or_else(|| "No refit of this frame yet".to_owned(), |last| format!("{}.", last.ending));
            for (text, colour) in said.into_iter().chain([(ending, palette.text3)]) {
                ui.add(egui::Label::new(RichText::new(text).small().color(colour)).wrap());
            }
            more(ui, requests);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fall_a_rise_and_neither_are_said() {
        let refit = |after: f64| Refitted {
            what: "Refit right forearm".to_owned(),
            before: 2e7,
            after,
            steps: 12,
            ending: String::new(),
        };
        let said = refit(1.5e7).sentence();
        assert_eq!(said, "Refit right forearm: cost fell by 25.0 %, from 2.0e7 to 1.5e7, in 12 steps.");
        assert!(refit(2.2e7).sentence().contains("no better pose was found (cost 10.0 % higher)"));
        assert!(refit(2.2e7).is_worse() && !refit(2e7).is_worse());
        assert!(refit(2e7).sentence().contains("cost stayed, from"));
    }
}
