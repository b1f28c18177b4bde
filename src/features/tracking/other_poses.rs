//! Other poses that fit the frame, as a search has found them: a click gives the frame one of them.

use backlit_document::edit::Edit;
use backlit_ui::style::format;
use backlit_ui::style::theme;
use egui::{RichText, TextStyle, Ui};

use super::{Tracking, Work};
use crate::context::command::{Command, FitCommand};
use crate::context::command_button::button;
use crate::context::{Context, Requests};
use crate::features::tracking::pose_words;

/// Two poses whose rotations differ by less are the same, radians and metres.
const SAME: f64 = 1e-6;

impl Tracking {
    /// The button of the search, and what it found.
    pub(crate) fn other_poses(&self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let palette = theme::palette(ui);
        let frame = context.selection.frame;
        ui.horizontal(|ui| {
            button(ui, context, requests, Command::Fit(FitCommand::SearchPoses));
            let hint = |text: &str| RichText::new(text.to_owned()).small().color(palette.text3);
            if matches!(self.work, Some(Work::Search(searched)) if searched == frame) {
                ui.label(hint("Looking for other poses…"));
            } else if !self.other_poses.contains_key(&frame) {
                ui.label(hint("for other poses that fit"));
            }
        });
        let Some(poses) = self.other_poses.get(&frame) else { return };
        ui.label(RichText::new("Poses that fit, best first").small().color(palette.text2));
        let shown = context.shown_pose();
        let best = poses.found.first().map_or(0.0, |found| found.cost);
        for (index, found) in poses.found.iter().enumerate() {
            let is_shown = found.pose.root.distance(shown.root) < SAME
                && found.pose.local(shown).iter().all(|value| value.abs() < SAME);
            let cost = format::cost(found.cost);
            let more = if index == 0 || best <= 0.0 {
                "best".to_owned()
            } else {
                format!("+{}", format::percent(found.cost / best - 1.0))
            };
            let name = format!("Pose {}: {}, {cost}, {more}", index + 1, pose_words::origin(&found.origin));
            let row = egui::Button::selectable(is_shown, (name, egui::Atom::grow())).truncate();
            let response = ui.add_sized([ui.available_width(), theme::size::ROW], row);
            let hover =
                "Give the frame this pose, as a key pose. Cost by the last stage of the fit, priors included";
            if response.on_hover_text(hover).clicked() {
                let what = "Choose pose".to_owned();
                requests.edit(Edit::SetPose { frame, pose: found.pose.clone(), what });
            }
        }
        if !std::sync::Arc::ptr_eq(&poses.fit, &context.document().fit) {
            let text = RichText::new("The fit’s choices have changed since these costs")
                .text_style(TextStyle::Small);
            ui.label(text.color(palette.text3));
        }
    }
}
