//! What is known of the frame under the pointer.

use backlit_document::{Estimate, Origin};
use backlit_tracking::track::LOST_BELOW_IOU;
use backlit_ui::style::{format, theme};
use egui::{Grid, PopupAnchor, Pos2, RichText, Tooltip, Ui, pos2};

use super::extra_lanes::doubtful_limbs;
use super::lanes::Lane;
use super::ranking::worst;
use super::transport::seconds;
use crate::context::Context;

/// Width that words may take.
const WIDTH: f32 = 210.0;

const KEY_POSE: &str = "Key pose: set by hand. The tracker starts again from it; K clears it.";

/// The card above the timeline, over a frame.
pub(crate) fn ui(ui: &Ui, context: &Context<'_>, frame: usize, at: Pos2) {
    let above = PopupAnchor::Position(pos2(at.x, at.y - 4.0));
    let id = ui.scope_id().with("read-out");
    Tooltip::always_open(ui.ctx().clone(), ui.layer_id(), id, above).gap(0.0).show(|ui| {
        ui.set_max_width(WIDTH);
        ui.spacing_mut().item_spacing.y = 2.0;
        let palette = theme::palette(ui);
        let title = format!("Frame {}, {} s", format::count(frame as i64), seconds(context, frame));
        ui.label(RichText::new(title).color(palette.text));
        let document = context.document();
        let estimate = document.estimates.get(&frame);
        Grid::new("values").num_columns(2).spacing([16.0, 2.0]).show(ui, |ui| {
            for lane in [Lane::Rms, Lane::Overlap, Lane::Steps] {
                let value = estimate.and_then(|estimate| lane.value(estimate));
                ui.label(RichText::new(lane.name()).small().color(palette.text2));
                ui.label(RichText::new(lane.text(value)).monospace().color(palette.text));
                ui.end_row();
            }
        });
        if let Some(stretch) = context.motions.at(frame) {
            ui.label(RichText::new(stretch.said()).small().color(palette.text));
        }
        if let Some(limbs) = doubtful_limbs(context, frame).filter(|limbs| !limbs.is_empty()) {
            let text = format!("Doubtful: {}", limbs.join(", "));
            ui.label(RichText::new(text).small().color(palette.text));
        }
        let mut note = |text: String, colour| ui.label(RichText::new(text).small().color(colour));
        match estimate {
            None if document.keys.contains_key(&frame) => {
                note("Key pose, not fitted yet".to_owned(), palette.text2);
            }
            None => {
                note("Not fitted: shows the nearest earlier pose".to_owned(), palette.text3);
            }
            Some(estimate) => {
                let origin = match estimate.origin {
                    Origin::Fit => "Fitted by itself",
                    Origin::Track => "Tracked",
                };
                let key = if document.keys.contains_key(&frame) { " from its key pose" } else { "" };
                note(format!("{origin}{key}"), palette.text2);
                if estimate.is_stale {
                    let text = "Found before the body’s sizes were changed: track or fit again";
                    note(text.to_owned(), palette.warn);
                }
                if estimate.lost {
                    note(lost_words(estimate), palette.warn);
                }
            }
        }
        if document.keys.contains_key(&frame) {
            note(KEY_POSE.to_owned(), palette.text3);
        }
        if worst(context) == Some(frame) {
            note("The worst frame: N goes here".to_owned(), palette.warn);
        }
    });
}

fn lost_words(estimate: &Estimate) -> String {
    match estimate.iou {
        _ if estimate.cost.is_none() => "Lost: nobody in the picture of any camera".to_owned(),
        Some(iou) if iou < LOST_BELOW_IOU => {
            let least = format::number(LOST_BELOW_IOU, 1);
            format!("Lost: hardly any overlap with the silhouettes (IoU below {least})")
        }
        Some(_) => "Lost: the residual is far above the usual one; a limb may be elsewhere".to_owned(),
        None => "Lost: no silhouettes".to_owned(),
    }
}
