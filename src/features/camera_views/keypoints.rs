//! 2-D keypoints of another tool where it saw the joints: crosses, fainter the less sure the tool is, each with a line to the
//! joint of the body that it is about.

use backlit_tracking::cues::JointKeypoint;
use backlit_ui::drawing::{JointId, JointMark};
use backlit_ui::style::theme::data_colours::{CASING, HELD_BY_CUE};
use backlit_ui::widgets::ViewTransform;
use egui::{Painter, Stroke, vec2};

/// Half of a cross, and the width of its strokes and of its line, points.
const HALF: f32 = 4.0;
const STROKE: f32 = 1.5;
const LINE: f32 = 1.0;
/// What is left of the colour where the tool is not sure at all, and on the line.
const FAINTEST: f32 = 0.35;
const ON_LINE: f32 = 0.6;

/// What the crosses mean, for the legend.
pub(crate) const LEGEND: &str = "2-D keypoint";

/// Draws them over a picture.
pub(crate) fn paint(
    painter: &Painter,
    view: &ViewTransform,
    keypoints: &[JointKeypoint],
    joints: &[JointMark],
) {
    for keypoint in keypoints {
        let at = view.screen_from_px(keypoint.pixel);
        let strength = FAINTEST + (1.0 - FAINTEST) * keypoint.score.clamp(0.0, 1.0) as f32;
        let colour = HELD_BY_CUE.gamma_multiply(strength);
        if let Some(joint) = joints.iter().find(|joint| joint.id == JointId::End(keypoint.limb)) {
            let line = [at, view.screen_from_px(joint.px)];
            painter.line_segment(line, Stroke::new(LINE, colour.gamma_multiply(ON_LINE)));
        }
        for arm in [vec2(HALF, HALF), vec2(HALF, -HALF)] {
            painter.line_segment([at - arm, at + arm], Stroke::new(STROKE + 1.5, CASING));
            painter.line_segment([at - arm, at + arm], Stroke::new(STROKE, colour));
        }
    }
}
