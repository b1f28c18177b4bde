//! The lane of limbs that nothing holds, where the track has cues: neither silhouettes nor a cue say where they are.

use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::UNSURE;
use backlit_ui::style::theme::size;
use egui::{Align2, Id, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2};

use super::span::Scale;
use crate::context::Context;

/// From so many limbs on the colour has its full strength, and how much it has of one.
const MANY: usize = 4;
const OF_ONE: f32 = 0.45;

/// What the lane is, under the pointer.
const EXPLANATION: &str = "Unsure: limbs that neither silhouettes nor a cue held in a frame. Their pose is what motion \
                           and priors make of it. The stronger the colour, the more limbs; empty is none.";

/// Height of the lane: none where no frame on the screen was tracked with cues.
pub(super) fn height(context: &Context<'_>) -> f32 {
    let document = context.document();
    let mut held = context.session.held.iter();
    let is_known = held.any(|(frame, held)| !held.holds.is_empty() && held.pose == *document.pose_at(*frame));
    if is_known { size::MOTION_LANE } else { 0.0 }
}

/// The limbs that nothing held in a frame, by name; `None` where the frame was not tracked with cues.
fn limbs<'a>(context: &Context<'a>, frame: usize) -> Option<Vec<&'a str>> {
    let document = context.document();
    let held = context.session.held(frame, document.pose_at(frame));
    let limbs = document.model.limbs();
    let unsure = held.iter().filter(|hold| hold.is_unsure());
    let names = unsure.filter_map(|hold| Some(limbs.get(hold.limb)?.name.as_str()));
    (!held.is_empty()).then(|| names.collect())
}

/// The lane with its name. Clicks mean frames, as everywhere in the timeline.
pub(super) fn ui(ui: &Ui, context: &Context<'_>, names: Rect, lane: Rect, scale: &Scale) {
    let (palette, frame) = (theme::palette(ui), context.selection.frame);
    let painter = ui.painter();
    let small = TextStyle::Small.resolve(ui.style());
    let left = names.left() + 4.0;
    painter.text(pos2(left, lane.center().y), Align2::LEFT_CENTER, "Unsure", small.clone(), palette.text2);
    painter.rect_filled(lane, 0.0, palette.plot);
    let inside = painter.with_clip_rect(lane);
    let half = 0.5 * scale.step().max(1.0);
    for (&at, held) in &context.session.held {
        let count = held.holds.iter().filter(|hold| hold.is_unsure()).count();
        let x = scale.x(at as f64);
        if count == 0 || x + half < lane.left() || x - half > lane.right() {
            continue;
        }
        if held.pose == *context.document().pose_at(at) {
            let more = (count.min(MANY) - 1) as f32 / (MANY - 1) as f32;
            let colour = UNSURE.gamma_multiply(OF_ONE + (1.0 - OF_ONE) * more);
            inside.rect_filled(Rect::from_x_y_ranges(x - half..=x + half, lane.y_range()), 0.0, colour);
        }
    }
    let here = limbs(context, frame);
    let now = match &here {
        None => "not known".to_owned(),
        Some(limbs) if limbs.is_empty() => "none".to_owned(),
        Some(limbs) => limbs.join(", "),
    };
    if let Some(limbs) = here {
        let at = pos2(names.right() - 6.0, lane.center().y);
        painter.text(at, Align2::RIGHT_CENTER, limbs.len().to_string(), small, palette.text);
    }
    let name = Rect::from_x_y_ranges(names.x_range(), lane.y_range());
    let name = ui.interact(name, Id::unique("unsure limbs’ lane"), Sense::hover());
    name.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Unsure limbs: {now}")));
    name.on_hover_text(format!("{EXPLANATION}\nIn this frame: {now}."));
}
