//! Left, right and face of a body in a picture.

use egui::{Align2, FontId, Painter, Rect, Stroke, vec2};

use super::ViewTransform;
use crate::drawing::SideMarks;
use crate::style::theme::data_colours::CASING;
use crate::style::theme::{Palette, size};

/// From a hand or a foot to the middle of its letter, in points.
const AWAY: f32 = 15.0;
/// Radius of a letter's ground, and of the nose's tip.
const GROUND: f32 = 7.5;
const TIP: f32 = 3.5;
/// Width of the nose's line.
const WIDTH: f32 = 1.5;
/// Opacity of a letter's ground.
const OPACITY: f32 = 0.75;

/// Paints letters beside hands and feet, and a nose: its tip is filled where the body faces the camera. A
/// letter that does not lie in what is free of the picture is left out.
pub fn paint_sides(
    painter: &Painter,
    view: &ViewTransform,
    marks: &SideMarks,
    free: Rect,
    palette: &Palette,
    font: &FontId,
) {
    for letter in &marks.letters {
        let away = vec2(letter.away.x as f32, letter.away.y as f32) * AWAY;
        let at = view.screen_from_px(letter.at) + away;
        if !free.shrink(GROUND).contains(at) {
            continue;
        }
        painter.circle_filled(at, GROUND, CASING.gamma_multiply(OPACITY));
        painter.text(at, Align2::CENTER_CENTER, letter.side.letter(), font.clone(), palette.text);
    }
    if let Some(face) = marks.face {
        let [from, tip] = [face.from, face.tip].map(|px| view.screen_from_px(px));
        // The line ends at the ring.
        let end = tip - (tip - from).normalized() * TIP.min(from.distance(tip));
        painter.line_segment([from, end], Stroke::new(WIDTH + 2.0 * size::CASING, CASING));
        painter.circle_filled(tip, TIP + size::CASING, CASING);
        painter.line_segment([from, end], Stroke::new(WIDTH, palette.text));
        if face.is_towards {
            painter.circle_filled(tip, TIP, palette.text);
        } else {
            painter.circle_stroke(tip, TIP - 0.5 * WIDTH, Stroke::new(WIDTH, palette.text));
        }
    }
}
