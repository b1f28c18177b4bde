//! The lane of motions by name: a stretch has the colour of its motion, and its name where there is room.

use backlit_ui::style::theme;
use backlit_ui::style::theme::{motion_colours, size};
use egui::{Align2, Id, Rect, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, pos2};

use super::span::Scale;
use crate::context::Context;

/// Space about a name.
const BESIDE: f32 = 5.0;
/// How much of its colour a stretch of an older track keeps.
const STALE: f32 = 0.45;

/// What the lane is, under the pointer.
const EXPLANATION: &str = "Motions: what the tracked motion is called, by what its joints do over time. Grey is like no \
                           motion that was learnt. The stretch of this frame has an edge; the Motions tile (View › \
                           Tiles) shows why it is called so.";

/// Height of the lane: none where nothing is recognised.
pub(super) fn height(context: &Context<'_>) -> f32 {
    if context.motions.stretches.is_empty() { 0.0 } else { size::MOTION_LANE }
}

/// The lane with its name. Clicks mean frames, as everywhere in the timeline.
pub(super) fn ui(ui: &Ui, context: &Context<'_>, names: Rect, lane: Rect, scale: &Scale) {
    let (palette, frame) = (theme::palette(ui), context.selection.frame);
    let small = TextStyle::Small.resolve(ui.style());
    let painter = ui.painter();
    let half = 0.5 * scale.step();
    let left = names.left() + 4.0;
    painter.text(pos2(left, lane.center().y), Align2::LEFT_CENTER, "Motions", small.clone(), palette.text2);
    painter.rect_filled(lane, 0.0, palette.plot);
    let inside = painter.with_clip_rect(lane.expand(1.0));
    for (index, stretch) in context.motions.stretches.iter().enumerate() {
        let [first, last] = [stretch.frames.start(), stretch.frames.end()].map(|at| scale.x(*at as f64));
        let place =
            Rect::from_x_y_ranges(first - half..=(last + half).max(first - half + 1.0), lane.y_range());
        let place = place.intersect(lane);
        if place.width() <= 0.0 {
            continue;
        }
        let colours = motion_colours(stretch.class);
        let strength = if context.motions.is_stale { STALE } else { 1.0 };
        inside.rect_filled(place.shrink2(egui::vec2(0.5, 0.0)), 2.0, colours.fill.gamma_multiply(strength));
        let text = if context.motions.is_stale { palette.text } else { colours.text };
        let name = painter.layout_no_wrap(stretch.name.clone(), small.clone(), text);
        if name.size().x + 2.0 * BESIDE <= place.width() {
            inside.galley(Align2::CENTER_CENTER.anchor_size(place.center(), name.size()).min, name, text);
        }
        if stretch.frames.contains(&frame) {
            inside.rect_stroke(place, 2.0, Stroke::new(1.5, palette.text), StrokeKind::Inside);
        }
        let mark = ui.interact(place, Id::unique(("motion's stretch", index)), Sense::hover());
        mark.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, stretch.said()));
    }
    let name = Rect::from_x_y_ranges(names.x_range(), lane.y_range());
    let name = ui.interact(name, Id::unique("motions' lane"), Sense::hover());
    let now = context.motions.at(frame).map_or_else(|| "not named".to_owned(), |stretch| stretch.said());
    name.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Motions: {now}")));
    name.on_hover_text(EXPLANATION);
}
