//! Lanes that are there only where they have something to show: motions by name, and limbs that are not believed. Clicks mean
//! frames, as everywhere in the timeline.

use backlit_tracking::belief::Verdict;
use backlit_ui::style::theme::data_colours::UNSURE;
use backlit_ui::style::theme::{self, motion_colours, size};
use backlit_ui::widgets::paint_text;
use egui::{
    Align2, Id, Painter, Rect, Response, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo, pos2,
};

use super::span::TimeScale;
use crate::context::Context;

/// Space about a motion's name.
const BESIDE: f32 = 5.0;
/// How much of its colour a stretch of an older track keeps.
const STALE: f32 = 0.45;
/// From this many limbs on that are wrong in the mean the colour has its full strength, and the least that it has.
const MANY: f64 = 1.0;
const FAINTEST: f64 = 0.4;
/// How much of the lane a frame fills in which no limb is wrong.
const DOUBTFUL: f32 = 0.5;

/// What the lane of motions is, under the pointer.
const MOTIONS: &str = "Motions: what the tracked motion is called, by what its joints do over time. Grey is like no \
                           motion that was learnt. The stretch of this frame has an edge; the Motions tile (View › \
                           Tiles) shows why it is called so.";

/// What the lane of doubtful limbs is, under the pointer.
const DOUBTFUL_LIMBS: &str = "Doubtful limbs: those that silhouettes, likely poses or rival poses speak against, and those \
                             that nothing holds. A tall bar: one of them has at least one chance in four to be wrong. The \
                             stronger the colour, the more limbs are likely to be; empty is none.";

/// Height of the lane of motions: none where nothing is recognised.
pub(super) fn motions_height(context: &Context<'_>) -> f32 {
    if context.motions.stretches.is_empty() { 0.0 } else { size::MOTION_LANE }
}

/// Height of the lane of doubtful limbs: none where all limbs of all frames are believed.
pub(super) fn doubts_height(context: &Context<'_>) -> f32 {
    if context.document().doubted().next().is_some() { size::MOTION_LANE } else { 0.0 }
}

/// The name and the ground of a lane.
fn ground<'a>(ui: &'a Ui, text: &str, names: Rect, lane: Rect) -> &'a Painter {
    let (palette, at) = (theme::palette(ui), pos2(names.left() + 4.0, lane.center().y));
    paint_text(ui, at, Align2::LEFT_CENTER, text, TextStyle::Small, palette.text2);
    ui.painter().rect_filled(lane, 0.0, palette.plot);
    ui.painter()
}

/// What the name of a lane says to those who point at it.
fn label(ui: &Ui, id: &str, names: Rect, lane: Rect, text: &str) -> Response {
    let name = Rect::from_x_y_ranges(names.x_range(), lane.y_range());
    let name = ui.interact(name, Id::unique(id), Sense::hover());
    name.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
    name
}

/// Weaker colours than that have text of the window's colour.
const FAINT: f32 = 0.75;

/// How strong the colour of a name is that is so likely: full from nine in ten on.
fn sureness(confidence: f64) -> f32 {
    (0.3 + 0.7 * ((confidence - 0.5) / 0.4).clamp(0.0, 1.0)) as f32
}

/// The lane of motions: a stretch has the colour of its motion, and its name where there is room.
pub(super) fn motions(ui: &Ui, context: &Context<'_>, names: Rect, lane: Rect, scale: &TimeScale) {
    let (palette, frame) = (theme::palette(ui), context.selection.frame);
    let small = TextStyle::Small.resolve(ui.style());
    let painter = ground(ui, "Motions", names, lane);
    let half = 0.5 * scale.step();
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
        let strength = if context.motions.is_stale { STALE } else { sureness(stretch.confidence) };
        inside.rect_filled(place.shrink2(egui::vec2(0.5, 0.0)), 2.0, colours.fill.gamma_multiply(strength));
        let text = if strength < FAINT { palette.text } else { colours.text };
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
    let now = context.motions.at(frame).map_or_else(|| "not named".to_owned(), |stretch| stretch.said());
    label(ui, "motions' lane", names, lane, &format!("Motions: {now}")).on_hover_text(MOTIONS);
}

/// The limbs that are not believed in a frame, by name; `None` where nothing is known of its pose.
pub(super) fn doubtful_limbs<'a>(context: &Context<'a>, frame: usize) -> Option<Vec<&'a str>> {
    let document = context.document();
    let trust = document.trust_of(frame, document.pose_at(frame))?;
    let limbs = document.model.limbs();
    let names = trust.doubts().iter().filter_map(|doubt| Some(limbs.get(doubt.limb)?.name.as_str()));
    Some(names.collect())
}

/// The lane of limbs that are not believed.
pub(super) fn doubts(ui: &Ui, context: &Context<'_>, names: Rect, lane: Rect, scale: &TimeScale) {
    let painter = ground(ui, "Doubtful limbs", names, lane);
    let inside = painter.with_clip_rect(lane);
    let half = 0.5 * scale.step().max(1.0);
    for (at, trust) in context.document().doubted() {
        let x = scale.x(at as f64);
        if x + half < lane.left() || x - half > lane.right() {
            continue;
        }
        let strength = FAINTEST + (1.0 - FAINTEST) * (trust.expected_wrong() / MANY).min(1.0);
        let colour = UNSURE.gamma_multiply(strength as f32);
        let is_wrong = trust.doubts().iter().any(|doubt| doubt.verdict == Verdict::Wrong);
        let height = if is_wrong { 1.0 } else { DOUBTFUL } * lane.height();
        let bar = Rect::from_x_y_ranges(x - half..=x + half, lane.bottom() - height..=lane.bottom());
        inside.rect_filled(bar, 0.0, colour);
    }
    let here = doubtful_limbs(context, context.selection.frame);
    let now = match &here {
        None => "not known".to_owned(),
        Some(limbs) if limbs.is_empty() => "none".to_owned(),
        Some(limbs) => limbs.join(", "),
    };
    if let Some(limbs) = here {
        let at = pos2(names.right() - 10.0, lane.center().y);
        let colour = theme::palette(ui).text;
        paint_text(ui, at, Align2::RIGHT_CENTER, limbs.len(), TextStyle::Monospace, colour);
    }
    let label = label(ui, "doubtful limbs’ lane", names, lane, &format!("Doubtful limbs: {now}"));
    label.on_hover_text(format!("{DOUBTFUL_LIMBS}\nIn this frame: {now}."));
}
