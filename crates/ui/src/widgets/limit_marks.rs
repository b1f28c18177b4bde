//! The limits of a joint in a picture: a wedge of what is allowed, a bar where it stops, and words.

use egui::{Align2, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};

use super::ViewTransform;
use crate::drawing::LimitMark;
use crate::style::theme::Palette;
use crate::style::theme::data_colours::{CASING, SELECTED, mark};
use crate::style::theme::size;

/// Opacity of the wedge, and of its sides.
const WEDGE: f32 = 0.14;
const SIDES: f32 = 0.6;
/// Half the bar's length across the limb at its limit, and the bar's width, in points.
const BAR: f32 = 9.0;
const BAR_WIDTH: f32 = 3.0;
/// From the arc to the words.
const AWAY: f32 = 14.0;
/// Around the words.
const MARGIN: Vec2 = vec2(5.0, 2.0);
/// Opacity of the words' ground.
const GROUND: f32 = 0.82;

/// Paints arcs and bars: under the joints.
pub fn paint_limits(painter: &Painter, view: &ViewTransform, marks: &[LimitMark], palette: &Palette) {
    for limit in marks {
        let pivot = view.screen_from_px(limit.pivot);
        let arc: Vec<Pos2> = limit.arc.iter().map(|px| view.screen_from_px(*px)).collect();
        let mut wedge = Mesh::default();
        let colour = SELECTED.gamma_multiply(WEDGE);
        wedge.colored_vertex(pivot, colour);
        for (index, at) in arc.iter().enumerate() {
            wedge.colored_vertex(*at, colour);
            if index > 0 {
                wedge.add_triangle(0, index as u32, index as u32 + 1);
            }
        }
        painter.add(Shape::mesh(wedge));
        let width = mark::SELECTED_LIMB_WIDTH;
        painter.add(Shape::line(arc.clone(), Stroke::new(width + 2.0 * size::CASING, CASING)));
        painter.add(Shape::line(arc.clone(), Stroke::new(width, SELECTED)));
        for end in [arc.first(), arc.last()].into_iter().flatten() {
            painter.line_segment([pivot, *end], Stroke::new(1.0, SELECTED.gamma_multiply(SIDES)));
        }
        if let Some(reached) = limit.reached.map(|px| view.screen_from_px(px)) {
            let along = (reached - pivot).normalized();
            let bar = [reached - along * BAR, reached + along * BAR];
            painter.line_segment(bar, Stroke::new(BAR_WIDTH + 2.0 * size::CASING, CASING));
            painter.line_segment(bar, Stroke::new(BAR_WIDTH, palette.warn));
            painter.circle_filled(reached, BAR_WIDTH + size::CASING, CASING);
            painter.circle_filled(reached, BAR_WIDTH, palette.warn);
        }
    }
}

/// Paints the words over everything else, inside the picture and beside each other; their places with what they say.
pub fn paint_limit_words<'a>(
    painter: &Painter,
    view: &ViewTransform,
    marks: &'a [LimitMark],
    palette: &Palette,
    font: &FontId,
) -> Vec<(Rect, &'a str)> {
    let mut placed: Vec<(Rect, &str)> = Vec::new();
    let bounds = painter.clip_rect().shrink(4.0);
    for limit in marks {
        let colour = if limit.reached.is_some() { palette.warn } else { palette.text };
        let galley = painter.layout_no_wrap(limit.words.clone(), font.clone(), colour);
        let size = galley.size() + 2.0 * MARGIN;
        let pivot = view.screen_from_px(limit.pivot);
        let tip = view.screen_from_px(limit.reached.unwrap_or(limit.now));
        let outwards = (tip - pivot).normalized() * AWAY;
        let align = if outwards.x < 0.0 { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
        let mut rect = within(align.anchor_size(tip + outwards, size), bounds);
        while let Some((other, _)) = placed.iter().find(|(other, _)| other.intersects(rect)) {
            let below = other.bottom() + 1.0;
            rect = rect.translate(vec2(0.0, below - rect.top()));
        }
        painter.rect_filled(rect, f32::from(size::FIELD_RADIUS), CASING.gamma_multiply(GROUND));
        painter.galley(rect.min + MARGIN, galley, colour);
        placed.push((rect, &limit.words));
    }
    placed
}

/// Moved by as little as puts it inside, where it fits.
fn within(rect: Rect, bounds: Rect) -> Rect {
    let x = rect.left().min(bounds.right() - rect.width()).max(bounds.left());
    let y = rect.top().min(bounds.bottom() - rect.height()).max(bounds.top());
    Rect::from_min_size(Pos2::new(x, y), rect.size())
}
