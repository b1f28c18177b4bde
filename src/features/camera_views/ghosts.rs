//! Bodies in the place of the posed one, drawn in a view: the faint ones as sticks, one whole.

use backlit_ui::drawing::GhostMarks;
use backlit_ui::style::theme::data_colours::{CASING, GHOST, JOINT, SELECTED, mark};
use backlit_ui::widgets::ViewTransform;
use egui::{Color32, Painter, Pos2, Shape, Stroke};
use glam::DVec2;

/// Width of a stick.
const STICK: f32 = 1.25;
/// The casing is so much wider than its line, and as opaque as this.
const CASING_MORE: f32 = 1.75;
const CASING_OPACITY: f32 = 0.6;

/// What they are and what is marked, each with its colour.
pub(super) fn legend(marks: &GhostMarks) -> Vec<(&str, Color32)> {
    let marked = (!marks.marked.is_empty()).then_some(("this step", SELECTED));
    std::iter::once((marks.words.as_str(), GHOST)).chain(marked).collect()
}

/// Paints them: the faint ones first.
pub(super) fn paint_ghosts(painter: &Painter, view: &ViewTransform, marks: &GhostMarks) {
    let on_screen = |px: DVec2| view.screen_from_px(px);
    for (sticks, opacity) in &marks.sticks {
        let colour = GHOST.gamma_multiply(*opacity);
        let lines = sticks.iter().map(|ends| ends.map(on_screen));
        painter.extend(lines.map(|points| Shape::LineSegment { points, stroke: Stroke::new(STICK, colour) }));
    }
    let parts: [(&[Vec<DVec2>], Color32, f32); 3] = [
        (&marks.outline, GHOST, mark::OUTLINE_WIDTH),
        (&marks.template, JOINT, mark::OUTLINE_WIDTH),
        (&marks.marked, SELECTED, mark::SELECTED_LIMB_WIDTH),
    ];
    for (lines, colour, width) in parts {
        let casing = Stroke::new(width + CASING_MORE, CASING.gamma_multiply(CASING_OPACITY));
        for stroke in [casing, Stroke::new(width, colour)] {
            for line in lines {
                let points: Vec<Pos2> = line.iter().map(|px| on_screen(*px)).collect();
                painter.add(Shape::line(points, stroke));
            }
        }
    }
}
