//! What lies over a picture beside the posed body: a body that sways, ellipses of joints, bodies in its place, what held
//! limbs that silhouettes did not, and 2-D keypoints of another tool.

use backlit_tracking::belief::{LimbTrust, Verdict};
use backlit_tracking::body::Model;
use backlit_tracking::cues::{Cue, JointKeypoint, LimbHold};
use backlit_ui::drawing::DEVIATIONS;
use backlit_ui::drawing::{
    GhostMarks, JointEllipse, JointId, JointMark, RivalMarks, SwayMarks, joined_outline, rival_opacity,
};
use backlit_ui::style::format;
use backlit_ui::style::theme::data_colours::{
    CASING, GHOST, HELD_BY_CUE, JOINT, LIKELIER, SELECTED, UNSURE, mark,
};
use backlit_ui::style::theme::run_style;
use backlit_ui::widgets::{Overlay, cased};
use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use glam::DVec2;

use super::TileInput;
use super::pointer::rotation_owner;
use crate::context::marks::whole_percent;

/// Points of an ellipse.
const POINTS: usize = 48;
/// Half axes are drawn no longer than this, points: what is longer is outside any view.
const LONGEST: f64 = 5000.0;
/// From the joint to the tip of an arrow along which nothing bounds it, points.
const ARROW: f32 = 46.0;
/// Its head.
const HEAD: f32 = 7.0;
/// Seams on the far side.
const FAR_SEAM: f32 = 0.35;
/// Opacity of paths and of casings.
const PATH: f32 = 0.75;
const CASING_OPACITY: f32 = 0.6;
/// Radius of the ring of a reference's joint.
const REFERENCE_RADIUS: f32 = 3.5;
/// Opacity of ellipses of an older pose.
const STALE: f32 = 0.4;
const WIDTH: f32 = 1.25;

/// Ellipses of joints.
#[derive(Clone, Debug, Default)]
pub struct Ellipses {
    /// One a joint; empty for none.
    pub joints: Vec<JointEllipse>,
    /// How much larger than life they are drawn; 0 counts as 1.
    pub factor: u32,
    /// They are of an older pose: pale, until there are new ones.
    pub is_stale: bool,
    /// Whether they are of other cameras than those in use.
    pub are_of_others: bool,
    /// Whether they are what a Kalman filter believes.
    pub are_believed: bool,
}

impl Ellipses {
    /// What they are, for the legend.
    pub(crate) fn words(&self) -> Option<String> {
        let of = match (self.are_of_others, self.are_believed) {
            (true, _) => "Uncertainty with the other cameras",
            (false, true) => "Uncertainty after the Kalman filter",
            (false, false) => "Uncertainty",
        };
        let sigmas = format!("{DEVIATIONS:.0}σ");
        match self.factor.max(1) {
            _ if self.joints.is_empty() => None,
            1 => Some(format!("{of}, {sigmas}")),
            factor => Some(format!("{of}, {sigmas}, drawn ×{factor}")),
        }
    }
}

/// Paints a body that sways: its outline, the ways of its joints, seams of limbs that twist.
pub(super) fn paint_sway(overlay: &Overlay, marks: &SwayMarks) {
    let painter = &overlay.painter;
    let casing = Stroke::new(mark::SELECTED_LIMB_WIDTH + 1.5, CASING.gamma_multiply(CASING_OPACITY));
    overlay.lines(&marks.outline, [casing, Stroke::new(mark::SELECTED_LIMB_WIDTH, SELECTED)], false);
    for (ends, is_before) in &marks.seams {
        let ends = overlay.points(ends);
        let opacity = if *is_before { 1.0 } else { FAR_SEAM };
        if *is_before {
            painter.add(Shape::line(ends.clone(), casing));
        }
        painter.add(Shape::line(ends, Stroke::new(WIDTH, SELECTED.gamma_multiply(opacity))));
    }
    for path in &marks.paths {
        let points = overlay.points(path);
        painter.add(Shape::line(points.clone(), thin_casing()));
        painter.add(Shape::line(points.clone(), Stroke::new(WIDTH, JOINT.gamma_multiply(PATH))));
        for end in points.first().into_iter().chain(points.last()) {
            painter.circle_filled(*end, 1.75, JOINT);
        }
    }
}

/// What lies under thin lines.
fn thin_casing() -> Stroke {
    Stroke::new(WIDTH + 2.0, CASING.gamma_multiply(CASING_OPACITY))
}

/// Paints the ellipses of joints, and arrows where nothing bounds them.
pub(crate) fn paint_ellipses(overlay: &Overlay, marks: &Ellipses, joints: &[JointMark]) {
    let mut painter = overlay.painter.clone();
    painter.multiply_opacity(if marks.is_stale { STALE } else { 1.0 });
    let painter = &painter;
    let colour = if marks.are_of_others { SELECTED } else { JOINT };
    for JointEllipse { joint, ellipse, .. } in &marks.joints {
        // They go along with a body that is dragged.
        let now = joints.iter().find(|mark| mark.id == *joint && marks.is_stale);
        let centre = overlay.at(now.map_or(ellipse.centre, |mark| mark.px));
        if !painter.clip_rect().expand(LONGEST as f32).contains(centre) {
            continue;
        }
        let scale = DEVIATIONS * f64::from(marks.factor.max(1)) * f64::from(overlay.view.points_per_px);
        let [long, short] = ellipse.half_axes.map(|axis| (axis * scale).clamp_length_max(LONGEST));
        let point = |index: usize| {
            let (sine, cosine) = (index as f64 / POINTS as f64 * std::f64::consts::TAU).sin_cos();
            let by = long * cosine + short * sine;
            centre + vec2(by.x as f32, by.y as f32)
        };
        let points: Vec<Pos2> = (0..POINTS).map(point).collect();
        if Rect::from_points(&points).intersects(painter.clip_rect()) {
            painter.add(Shape::closed_line(points.clone(), thin_casing()));
            painter.add(Shape::closed_line(points, Stroke::new(WIDTH, colour)));
        }
        for axis in &ellipse.unseen {
            let along = vec2(axis.x as f32, axis.y as f32);
            for tip in [along, -along] {
                arrow(painter, [centre, centre + tip * ARROW], tip, colour);
            }
        }
    }
}

/// Paints from limbs' ends to where a prior would have them. What is nearly there has no arrow.
pub(crate) fn paint_likelier(overlay: &Overlay, arrows: &[[DVec2; 2]]) {
    for arrow_px in arrows {
        let ends @ [from, to] = arrow_px.map(|px| overlay.at(px));
        let along = to - from;
        if along.length() > 1.5 * HEAD && along.length() < LONGEST as f32 {
            arrow(&overlay.painter, ends, along.normalized(), LIKELIER);
        }
    }
}

/// Paints where references have the joints: a ring, and a line to it from the joint.
pub(crate) fn paint_references(overlay: &Overlay, references: &[([DVec2; 2], usize)]) {
    for (ends_px, reference) in references {
        let ends = ends_px.map(|px| overlay.at(px));
        let colour = run_style(*reference).colour;
        for stroke in [thin_casing(), Stroke::new(WIDTH, colour)] {
            overlay.painter.line_segment(ends, stroke);
            overlay.painter.circle_stroke(ends[1], REFERENCE_RADIUS, stroke);
        }
    }
}

fn arrow(painter: &Painter, line: [Pos2; 2], along: Vec2, colour: Color32) {
    let tip = line[1];
    let back = tip - along * HEAD;
    let side = vec2(-along.y, along.x) * (0.5 * HEAD);
    let head = vec![back + side, tip, back - side];
    for stroke in [thin_casing(), Stroke::new(WIDTH, colour)] {
        painter.line_segment(line, stroke);
        painter.add(Shape::line(head.clone(), stroke));
    }
}

/// Width of a stick.
const STICK: f32 = 1.25;
/// The casing is so much wider than its line.
const CASING_MORE: f32 = 1.75;

/// What they are and what is marked, each with its colour.
pub(super) fn ghost_legend(marks: &GhostMarks) -> Vec<(&str, Color32)> {
    let marked = (!marks.marked.is_empty()).then_some(("this step", SELECTED));
    std::iter::once((marks.words.as_str(), GHOST)).chain(marked).collect()
}

/// Paints them: the faint ones first.
pub(super) fn paint_ghosts(overlay: &Overlay, marks: &GhostMarks) {
    for (sticks, opacity) in &marks.sticks {
        let stroke = Stroke::new(STICK, GHOST.gamma_multiply(*opacity));
        let lines = sticks.iter().map(|ends| ends.map(|px| overlay.at(px)));
        overlay.painter.extend(lines.map(|points| Shape::LineSegment { points, stroke }));
    }
    for (lines, colour, width) in [
        (&marks.outline, GHOST, mark::OUTLINE_WIDTH),
        (&marks.template, JOINT, mark::OUTLINE_WIDTH),
        (&marks.marked, SELECTED, mark::SELECTED_LIMB_WIDTH),
    ] {
        let casing = Stroke::new(width + CASING_MORE, CASING.gamma_multiply(CASING_OPACITY));
        overlay.lines(lines, [casing, Stroke::new(width, colour)], false);
    }
}

/// What the sticks of rivals mean, for the legend.
pub(crate) const RIVAL_LEGEND: &str = "Rival poses";

/// Paints what is elsewhere in a rival pose; where its weight stands.
pub(super) fn paint_rival(overlay: &Overlay, rival: &RivalMarks) -> Pos2 {
    let opacity = rival_opacity(rival.weight);
    for stick in &rival.sticks {
        let points = stick.map(|px| overlay.at(px));
        let casing = Stroke::new(STICK + CASING_MORE, CASING.gamma_multiply(CASING_OPACITY * opacity));
        for stroke in [casing, Stroke::new(STICK, GHOST.gamma_multiply(opacity))] {
            overlay.painter.line_segment(points, stroke);
        }
    }
    overlay.at(rival.farthest)
}

/// Dash and gap of a limb that nothing holds, points.
const UNSURE_DASH: [f32; 2] = [5.0, 4.0];

/// What the outlines mean, for the legend: those that are shown.
pub(crate) fn held_legend(held: &[LimbHold]) -> impl Iterator<Item = (&'static str, Color32)> {
    let by_cue = held.iter().any(|hold| !hold.by_silhouettes && !hold.is_unsure());
    let unsure = held.iter().any(LimbHold::is_unsure);
    let entries = [("Held by a cue", HELD_BY_CUE, by_cue), ("Unsure: nothing holds it", UNSURE, unsure)];
    entries.into_iter().filter(|entry| entry.2).map(|(text, colour, _)| (text, colour))
}

/// What the outlines of limbs that are not believed mean, for the legend.
pub(crate) fn doubts_legend(input: &TileInput<'_>) -> Option<(&'static str, Color32)> {
    outlined_doubts(input).next().map(|_| ("Doubtful limbs", UNSURE))
}

/// The same in sentences, limb by limb.
pub(crate) fn doubts_tooltip(input: &TileInput<'_>) -> String {
    let of_limb = |doubt: &LimbTrust| {
        let (limb, chance) = (format::capitalised(input.limb_name(doubt.limb)), whole_percent(doubt.wrong));
        let because = doubt.reason.map_or_else(String::new, |reason| format!(", because {}", reason.text()));
        format!("\n{limb}: {chance} likely to be wrong{because}")
    };
    let limbs: String = input.doubts.iter().map(of_limb).collect();
    format!(
        "Limbs that may be elsewhere. Dashed is doubtful; solid is wrong with at least one chance in four.{limbs}"
    )
}

/// The limbs that are not believed for another reason than that nothing holds them: those are outlined as unsure.
fn outlined_doubts<'a>(input: &TileInput<'a>) -> impl Iterator<Item = &'a LimbTrust> {
    let held = input.held;
    let is_unsure = move |limb: usize| held.iter().any(|hold| hold.limb == limb && hold.is_unsure());
    input.doubts.iter().filter(move |doubt| !is_unsure(doubt.limb))
}

/// How far the part that a limb belongs to is believed, in words; `None` where nothing speaks against it.
pub(crate) fn doubt_words(doubts: &[LimbTrust], body: &Model, limb: usize) -> Option<String> {
    let owner = rotation_owner(body, limb);
    let doubt = doubts.iter().find(|doubt| doubt.limb == owner)?;
    let because = doubt.reason.map_or("", |reason| reason.text());
    Some(format!("{}: {because}", doubt.verdict.name()))
}

/// What held the part that a limb belongs to, in words.
pub(crate) fn held_words(held: &[LimbHold], body: &Model, limb: usize) -> Option<String> {
    let owner = rotation_owner(body, limb);
    let hold = held.iter().find(|hold| hold.limb == owner)?;
    if hold.is_unsure() {
        return Some("nothing: unsure".to_owned());
    }
    let cues = hold.cues.iter().map(|cue| Cue::name(*cue));
    let words: Vec<&str> = hold.by_silhouettes.then_some("silhouettes").into_iter().chain(cues).collect();
    Some(words.join(", "))
}

/// Outlines the parts that are not believed, and those that silhouettes did not hold.
pub(crate) fn paint_held(overlay: &Overlay, input: &TileInput<'_>) {
    let painter = &overlay.painter;
    for doubt in outlined_doubts(input) {
        for line in joined_outline(&input.turning_with(doubt.limb)) {
            let line = overlay.points(&line);
            let [_, stroke] = cased(mark::SELECTED_LIMB_WIDTH, UNSURE);
            if doubt.verdict == Verdict::Wrong {
                painter.add(Shape::line(line, stroke));
            } else {
                painter.extend(Shape::dashed_line(&line, stroke, UNSURE_DASH[0], UNSURE_DASH[1]));
            }
        }
    }
    for hold in input.held.iter().filter(|hold| !hold.by_silhouettes) {
        for line in joined_outline(&input.turning_with(hold.limb)) {
            let line = overlay.points(&line);
            let colour = if hold.is_unsure() { UNSURE } else { HELD_BY_CUE };
            let [casing, stroke] = cased(mark::SELECTED_LIMB_WIDTH, colour);
            painter.add(Shape::line(line.clone(), casing));
            if hold.is_unsure() {
                painter.extend(Shape::dashed_line(&line, stroke, UNSURE_DASH[0], UNSURE_DASH[1]));
            } else {
                painter.add(Shape::line(line, stroke));
            }
        }
    }
}

/// Half of a cross, and the width of its strokes and of its line, points.
const CROSS_HALF: f32 = 4.0;
const CROSS_WIDTH: f32 = 1.5;
const KEYPOINT_LINE: f32 = 1.0;
/// What is left of the colour where the tool is not sure at all, and on the line.
const FAINTEST_KEYPOINT: f32 = 0.35;
const LINE_OPACITY: f32 = 0.6;

/// What the crosses mean, for the legend.
pub(crate) const KEYPOINT_LEGEND: &str = "2-D keypoint";

/// Draws them over a picture.
pub(crate) fn paint_keypoints(overlay: &Overlay, keypoints: &[JointKeypoint], joints: &[JointMark]) {
    let painter = &overlay.painter;
    for keypoint in keypoints {
        let at = overlay.at(keypoint.pixel);
        let strength = FAINTEST_KEYPOINT + (1.0 - FAINTEST_KEYPOINT) * keypoint.score.clamp(0.0, 1.0) as f32;
        let colour = HELD_BY_CUE.gamma_multiply(strength);
        if let Some(joint) = joints.iter().find(|joint| joint.id == JointId::End(keypoint.limb)) {
            let line = [at, overlay.at(joint.px)];
            painter.line_segment(line, Stroke::new(KEYPOINT_LINE, colour.gamma_multiply(LINE_OPACITY)));
        }
        for arm in [vec2(CROSS_HALF, CROSS_HALF), vec2(CROSS_HALF, -CROSS_HALF)] {
            painter.line_segment([at - arm, at + arm], Stroke::new(CROSS_WIDTH + 1.5, CASING));
            painter.line_segment([at - arm, at + arm], Stroke::new(CROSS_WIDTH, colour));
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    fn hold(limb: usize, by_silhouettes: bool, cues: &[Cue]) -> LimbHold {
        LimbHold { limb, cameras: 0, by_silhouettes, cues: cues.to_vec() }
    }

    #[test]
    fn a_limb_that_nothing_holds_is_said_to_be_unsure() {
        let body = builtin::full_body();
        let limb = |name: &str| body.limb_index(name).unwrap();
        let [upper, fore, thigh] = ["left upper arm", "left forearm", "left thigh"].map(limb);
        let held = [
            hold(upper, true, &[Cue::Keypoints]),
            hold(fore, false, &[]),
            hold(thigh, false, &[Cue::Flow, Cue::Stereo]),
        ];
        assert_eq!(held_words(&held, &body, upper).unwrap(), "silhouettes, keypoints");
        assert_eq!(held_words(&held, &body, fore).unwrap(), "nothing: unsure");
        assert_eq!(held_words(&held, &body, thigh).unwrap(), "flow, stereo");
        // The lower half of a thigh turns with the upper one.
        assert_eq!(held_words(&held, &body, limb("left lower thigh")).unwrap(), "flow, stereo");
        assert_eq!(held_words(&held, &body, limb("right forearm")), None);
        assert_eq!(held_legend(&held).count(), 2);
        assert_eq!(held_legend(&held[..1]).count(), 0, "silhouettes need no legend");
    }
}
