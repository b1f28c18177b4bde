//! Other poses that fit the frame, as a search has found them or as the tracker carried them: a click gives the frame one of
//! them.

use backlit_document::edit::Edit;
use backlit_document::frame_trust::are_same;
use backlit_tracking::body::Kinematics;
use backlit_tracking::search::Origin;
use backlit_ui::drawing::{farthest_limb, limbs_elsewhere};
use backlit_ui::style::{format, theme};
use egui::{RichText, TextStyle, Ui};

use super::{Tracking, TrackingWork};
use crate::context::command::{Command, FitCommand, TrackingCommand};
use crate::context::command_button::button;
use crate::context::marks::whole_percent;
use crate::context::{Context, Requests};

impl Tracking {
    /// The button of the search, and what it found.
    pub(crate) fn other_poses(&self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let palette = theme::palette(ui);
        let frame = context.selection.frame;
        ui.horizontal(|ui| {
            button(ui, context, requests, Command::Fit(FitCommand::SearchPoses));
            let hint = |text: &str| RichText::new(text.to_owned()).small().color(palette.text3);
            if matches!(self.work, Some(TrackingWork::Search(searched)) if searched == frame) {
                ui.label(hint("Looking for other poses…"));
            } else if !self.other_poses.contains_key(&frame) {
                ui.label(hint("for other poses that fit"));
            }
        });
        rivals(ui, context, requests);
        let Some(poses) = self.other_poses.get(&frame) else { return };
        ui.label(RichText::new("Poses that fit, best first").small().color(palette.text2));
        let shown = context.shown_pose();
        for (index, found) in poses.found.iter().enumerate() {
            let is_shown = are_same(&found.pose, shown);
            let rms = found.rms.map_or_else(|| format::MISSING.to_owned(), |rms| format::number(rms, 1));
            let best = if index == 0 { ", best" } else { "" };
            let name = format!("Pose {}: {}, RMS {rms}{best}", index + 1, origin_text(&found.origin));
            let row = egui::Button::selectable(is_shown, (name, egui::Atom::grow())).truncate();
            let response = ui.add_sized([ui.available_width(), theme::size::ROW], row);
            let hover = "Give the frame this pose, as a key pose.\nRMS is in grey levels, as in the timeline. The order is by the \
                         fit’s last cost, priors and limits included";
            if response.on_hover_text(hover).clicked() {
                let what = "Choose pose".to_owned();
                requests.edit(Edit::SetPose { frame, pose: found.pose.clone(), what });
            }
        }
        if !std::sync::Arc::ptr_eq(&poses.fit, &context.document().fit) {
            let text = RichText::new("The fit’s choices have changed since this was measured")
                .text_style(TextStyle::Small);
            ui.label(text.color(palette.text3));
        }
    }
}

/// The poses that the tracker carried in the frame, each with how likely it is; one that was taken can be tracked on from.
fn rivals(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let (frame, shown) = (context.selection.frame, context.document().pose_at(context.selection.frame));
    let modes = context.document().modes(frame, shown);
    let (Some((tracked, _)), model) = (modes.first(), &context.document().model) else { return };
    let leading = Kinematics::new(model, tracked);
    ui.label(RichText::new("Poses that the tracker carried").small().color(theme::palette(ui).text2));
    for (index, (pose, weight)) in modes.iter().enumerate() {
        let other = Kinematics::new(model, pose);
        let most = farthest_limb(&limbs_elsewhere(&other, &leading), &other, &leading);
        let deviation = |limb| context.document().trust.get(&frame)?.deviation_m(pose, limb);
        let off = most.map(|(limb, apart)| {
            let give_or_take =
                deviation(limb).map_or_else(String::new, |m| format!(" ± {}", format::length(m)));
            format!(": {} {}{give_or_take} off", model.limbs()[limb].name, format::length(apart))
        });
        let which = if index == 0 { "Tracked" } else { "Rival" };
        let name = format!("{which}, {}{}", whole_percent(*weight), off.unwrap_or_default());
        let is_shown = are_same(pose, shown);
        let row = egui::Button::selectable(is_shown, (name, egui::Atom::grow())).truncate();
        let response = ui.add_sized([ui.available_width(), theme::size::ROW], row);
        let hover = "Give the frame this pose, as a key pose. The number is how likely the tracker held it to be among those \
                     that it carried";
        if response.on_hover_text(hover).clicked() && !is_shown {
            requests.take_rival(frame, pose);
        }
    }
    if context.document().keys.contains_key(&frame) {
        ui.horizontal(|ui| {
            for command in [TrackingCommand::Forward, TrackingCommand::Back] {
                button(ui, context, requests, Command::Tracking(command));
            }
        });
    }
}

/// Where a pose comes from, for the middle of a line.
fn origin_text(origin: &Origin) -> String {
    match origin {
        Origin::Start => "the start".to_owned(),
        Origin::Trunk => "trunk turned or moved".to_owned(),
        Origin::TurnedRound => "turned round".to_owned(),
        Origin::Hull => "from the visual hull".to_owned(),
        Origin::Chain { limb } => format!("{limb} searched"),
        Origin::Pair { limbs: [one, other] } => format!("{one} and {other} searched"),
    }
}
