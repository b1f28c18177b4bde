//! Lines on pictures: the body's outline, the edges of its limbs, sight rays. All with a casing.

use egui::{Painter, Pos2, Rect, Shape, Stroke};
use glam::DVec2;

use super::ViewTransform;
use crate::drawing::{ProjectedLimb, SightRay};
use crate::style::theme::data_colours::{
    BODY_OUTLINE, BODY_OUTLINE_CASING, CASING, INNER_EDGE, RAY_CASING, SELECTED, mark,
};

/// Lines are cut this far outside the view, in points.
pub(super) const MARGIN: f32 = 12.0;

/// Paints the outline of the body: closed polylines in pixel coordinates.
pub fn paint_body_outline(painter: &Painter, view: &ViewTransform, outlines: &[Vec<DVec2>]) {
    let casing = Stroke::new(mark::OUTLINE_CASING_WIDTH, CASING.gamma_multiply(BODY_OUTLINE_CASING));
    for stroke in [casing, Stroke::new(mark::OUTLINE_WIDTH, BODY_OUTLINE)] {
        for outline in outlines {
            let points = outline.iter().map(|px| view.screen_from_px(*px)).collect();
            painter.add(Shape::closed_line(points, stroke));
        }
    }
}

/// Paints the limbs' own outline: polylines in pixel coordinates, until the body's is there.
pub fn paint_quick_outline(painter: &Painter, view: &ViewTransform, lines: &[Vec<DVec2>]) {
    let casing = Stroke::new(mark::OUTLINE_CASING_WIDTH, CASING.gamma_multiply(BODY_OUTLINE_CASING));
    for stroke in [casing, Stroke::new(mark::OUTLINE_WIDTH, BODY_OUTLINE)] {
        for line in lines {
            let points = line.iter().map(|px| view.screen_from_px(*px)).collect();
            painter.add(Shape::line(points, stroke));
        }
    }
}

/// Paints the faint edges of limbs inside the outline.
pub fn paint_limb_edges(painter: &Painter, view: &ViewTransform, limbs: &[Option<ProjectedLimb>]) {
    let stroke = Stroke::new(mark::INNER_EDGE_WIDTH, BODY_OUTLINE.gamma_multiply(INNER_EDGE));
    for limb in limbs.iter().flatten() {
        let points = limb.outline().into_iter().map(|px| view.screen_from_px(px)).collect();
        painter.add(Shape::closed_line(points, stroke));
    }
}

/// Paints a sight ray: dashed, and solid near the joint's depth.
pub fn paint_sight_ray(painter: &Painter, view: &ViewTransform, ray: &SightRay) {
    let bounds = view.rect.expand(MARGIN);
    let on_screen = |ends: [DVec2; 2]| clipped(ends.map(|px| view.screen_from_px(px)), bounds);
    let Some(line) = on_screen(ray.line_px) else { return };
    let casing = Stroke::new(mark::RAY_CASING_WIDTH, CASING.gamma_multiply(RAY_CASING));
    painter.line_segment(line, casing);
    let stroke = Stroke::new(mark::RAY_WIDTH, SELECTED);
    let [dash, gap] = mark::RAY_DASH;
    painter.extend(Shape::dashed_line(&line, stroke, dash, gap));
    if let Some(solid) = ray.solid_px.and_then(on_screen) {
        painter.line_segment(solid, stroke);
    }
}

/// The part of a segment inside a rectangle (Liang and Barsky).
pub(super) fn clipped([from, to]: [Pos2; 2], bounds: Rect) -> Option<[Pos2; 2]> {
    let along = to - from;
    let (mut start, mut end) = (0.0_f32, 1.0_f32);
    for (step, room) in [
        (-along.x, from.x - bounds.left()),
        (along.x, bounds.right() - from.x),
        (-along.y, from.y - bounds.top()),
        (along.y, bounds.bottom() - from.y),
    ] {
        let share = room / step;
        if step < 0.0 {
            start = start.max(share);
        } else if step > 0.0 {
            end = end.min(share);
        } else if room < 0.0 {
            return None;
        }
    }
    (start < end).then(|| [from + along * start, from + along * end])
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn segments_are_cut_to_the_view() {
        let bounds = Rect::from_min_max(pos2(0.0, 0.0), pos2(10.0, 10.0));
        let cut = clipped([pos2(-1e6, 5.0), pos2(1e6, 5.0)], bounds).unwrap();
        assert!(cut[0].distance(pos2(0.0, 5.0)) < 0.1 && cut[1].distance(pos2(10.0, 5.0)) < 0.1);
        let inside = [pos2(1.0, 2.0), pos2(3.0, 4.0)];
        assert_eq!(clipped(inside, bounds), Some(inside));
        assert_eq!(clipped([pos2(-5.0, -1.0), pos2(20.0, -1.0)], bounds), None);
        assert_eq!(clipped([pos2(-5.0, 20.0), pos2(-1.0, 5.0)], bounds), None);
    }
}
