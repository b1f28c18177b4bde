//! The marks of a calibration on a picture. White and thin, with the casing: what they are is said by shape and letter.

use egui::{Align2, FontId, Painter, Shape, Stroke, Vec2, vec2};
use glam::DVec2;

use super::ViewTransform;
use super::picture_marks::{MARGIN, clipped};
use crate::drawing::CalibrationMarks;
use crate::style::theme::data_colours::{CASING, JOINT};
use crate::style::theme::size;

/// Opacity of the grid.
const GRID_OPACITY: f32 = 0.3;
/// Half the width of the principal point's cross, in points.
const CROSS: f32 = 9.0;
/// Its ring.
const RING: f32 = 5.0;
/// Width of axes and cross.
const WIDTH: f32 = 1.25;
/// Dash and gap of the lens edge.
const DASH: [f32; 2] = [6.0, 4.0];
/// Size of the axes' letters.
const LETTER: f32 = 12.0;
/// From an axis' end to its letter.
const LETTER_AWAY: f32 = 9.0;

/// Paints the grid under the axes, the lens edge, and the principal point.
pub fn paint_calibration(painter: &Painter, view: &ViewTransform, marks: &CalibrationMarks) {
    let bounds = view.rect.expand(MARGIN);
    let on_screen = |ends: [DVec2; 2]| clipped(ends.map(|px| view.screen_from_px(px)), bounds);
    let stroke = Stroke::new(WIDTH, JOINT);
    let casing = Stroke::new(WIDTH + 2.0 * size::CASING, CASING);
    for line in marks.grid_px.iter().filter_map(|ends| on_screen(*ends)) {
        painter.line_segment(line, Stroke::new(size::HAIRLINE, JOINT.gamma_multiply(GRID_OPACITY)));
    }
    if let Some(first) = marks.lens_edge_px.first() {
        let edge = marks.lens_edge_px.iter().chain([first]);
        let edge: Vec<_> = edge.map(|px| view.screen_from_px(*px)).collect();
        painter.add(Shape::line(edge.clone(), Stroke::new(casing.width, CASING.gamma_multiply(0.5))));
        painter.extend(Shape::dashed_line(&edge, stroke, DASH[0], DASH[1]));
    }
    for (name, ends) in ["x", "y", "z"].into_iter().zip(marks.axes_px) {
        let Some(ends) = ends else { continue };
        let Some(line) = on_screen(ends) else { continue };
        painter.line_segment(line, casing);
        painter.line_segment(line, stroke);
        let [from, to] = ends.map(|px| view.screen_from_px(px));
        letter(painter, to + (to - from).normalized() * LETTER_AWAY, name);
    }
    let at = view.screen_from_px(marks.principal_px);
    for stroke in [casing, stroke] {
        for arm in [vec2(CROSS, 0.0), vec2(0.0, CROSS)] {
            painter.line_segment([at - arm, at + arm], stroke);
        }
        painter.circle_stroke(at, RING, stroke);
    }
}

fn letter(painter: &Painter, at: egui::Pos2, text: &str) {
    let font = FontId::proportional(LETTER);
    for away in [vec2(-1.0, 0.0), vec2(1.0, 0.0), vec2(0.0, -1.0), vec2(0.0, 1.0), Vec2::ZERO] {
        let colour = if away == Vec2::ZERO { JOINT } else { CASING };
        painter.text(at + away, Align2::CENTER_CENTER, text, font.clone(), colour);
    }
}
