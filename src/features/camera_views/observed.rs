//! What the cameras see and do not see, drawn in a view: a body that sways along a direction, and ellipses of its joints.

use backlit_ui::drawing::ellipse_factor::DEVIATIONS;
use backlit_ui::drawing::{GhostMarks, JointEllipse, JointMark, SwayMarks};
use backlit_ui::style::theme::data_colours::{CASING, JOINT, LIKELIER, SELECTED, mark};
use backlit_ui::widgets::ViewTransform;
use egui::{Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2};
use glam::DVec2;

use super::ghosts::paint_ghosts;

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
/// Opacity of ellipses of an older pose.
const STALE: f32 = 0.4;
const WIDTH: f32 = 1.25;

/// What is drawn over a picture.
#[derive(Clone, Copy, Debug, Default)]
pub struct ObservedMarks<'a> {
    /// The body on its way, if it sways.
    pub sway: Option<&'a SwayMarks>,
    /// Bodies in the place of the posed one.
    pub ghosts: Option<&'a GhostMarks>,
    /// Ellipses of joints; empty for none.
    pub ellipses: &'a [JointEllipse],
    /// They are drawn so many times as large as they are; 0 counts as 1.
    pub factor: u32,
    /// They are of an older pose: pale, until there are new ones.
    pub is_stale: bool,
    /// Whether the ellipses are of other cameras than those in use.
    pub are_of_others: bool,
    /// Whether the ellipses are what a Kalman filter believes.
    pub are_believed: bool,
}

impl ObservedMarks<'_> {
    /// What the ellipses are, for the legend.
    pub(crate) fn words(&self) -> Option<String> {
        let of = match (self.are_of_others, self.are_believed) {
            (true, _) => "Uncertainty with the other cameras",
            (false, true) => "Uncertainty after the Kalman filter",
            (false, false) => "Uncertainty",
        };
        let sigmas = format!("{DEVIATIONS:.0}σ");
        match self.factor.max(1) {
            _ if self.ellipses.is_empty() => None,
            1 => Some(format!("{of}, {sigmas}")),
            factor => Some(format!("{of}, {sigmas}, drawn ×{factor}")),
        }
    }
}

/// Paints bodies beside or in the place of the posed one.
pub(crate) fn paint_bodies(painter: &Painter, view: &ViewTransform, marks: &ObservedMarks<'_>) {
    if let Some(sway) = marks.sway {
        paint_sway(painter, view, sway);
    }
    if let Some(ghosts) = marks.ghosts {
        paint_ghosts(painter, view, ghosts);
    }
}

/// Paints a body that sways: its outline, the ways of its joints, seams of limbs that twist.
fn paint_sway(painter: &Painter, view: &ViewTransform, marks: &SwayMarks) {
    let on_screen =
        |points: &[DVec2]| -> Vec<Pos2> { points.iter().map(|px| view.screen_from_px(*px)).collect() };
    let casing = Stroke::new(mark::SELECTED_LIMB_WIDTH + 1.5, CASING.gamma_multiply(CASING_OPACITY));
    for stroke in [casing, Stroke::new(mark::SELECTED_LIMB_WIDTH, SELECTED)] {
        for line in &marks.outline {
            painter.add(Shape::line(on_screen(line), stroke));
        }
    }
    for (ends, is_before) in &marks.seams {
        let ends = on_screen(ends);
        let opacity = if *is_before { 1.0 } else { FAR_SEAM };
        if *is_before {
            painter.add(Shape::line(ends.clone(), casing));
        }
        painter.add(Shape::line(ends, Stroke::new(WIDTH, SELECTED.gamma_multiply(opacity))));
    }
    for path in &marks.paths {
        let points = on_screen(path);
        painter.add(Shape::line(
            points.clone(),
            Stroke::new(WIDTH + 2.0, CASING.gamma_multiply(CASING_OPACITY)),
        ));
        painter.add(Shape::line(points.clone(), Stroke::new(WIDTH, JOINT.gamma_multiply(PATH))));
        for end in points.first().into_iter().chain(points.last()) {
            painter.circle_filled(*end, 1.75, JOINT);
        }
    }
}

/// Paints the ellipses of joints, and arrows where nothing bounds them.
pub(crate) fn paint_ellipses(
    painter: &Painter,
    view: &ViewTransform,
    marks: &ObservedMarks<'_>,
    joints: &[JointMark],
) {
    let mut painter = painter.clone();
    painter.multiply_opacity(if marks.is_stale { STALE } else { 1.0 });
    let painter = &painter;
    let colour = if marks.are_of_others { SELECTED } else { JOINT };
    for JointEllipse { joint, ellipse, .. } in marks.ellipses {
        // They go along with a body that is dragged.
        let now = joints.iter().find(|mark| mark.id == *joint && marks.is_stale);
        let centre = view.screen_from_px(now.map_or(ellipse.centre, |mark| mark.px));
        if !painter.clip_rect().expand(LONGEST as f32).contains(centre) {
            continue;
        }
        let scale = DEVIATIONS * f64::from(marks.factor.max(1)) * f64::from(view.points_per_px);
        let [long, short] = ellipse.half_axes.map(|axis| (axis * scale).clamp_length_max(LONGEST));
        let point = |index: usize| {
            let (sine, cosine) = (index as f64 / POINTS as f64 * std::f64::consts::TAU).sin_cos();
            let by = long * cosine + short * sine;
            centre + vec2(by.x as f32, by.y as f32)
        };
        let points: Vec<Pos2> = (0..POINTS).map(point).collect();
        if Rect::from_points(&points).intersects(painter.clip_rect()) {
            let casing = Stroke::new(WIDTH + 2.0, CASING.gamma_multiply(CASING_OPACITY));
            painter.add(Shape::closed_line(points.clone(), casing));
            painter.add(Shape::closed_line(points, Stroke::new(WIDTH, colour)));
        }
        for axis in &ellipse.unseen {
            let along = vec2(axis.x as f32, axis.y as f32);
            for tip in [along, -along] {
                arrow(painter, centre, tip, colour);
            }
        }
    }
}

/// Paints from limbs' ends to where a prior would have them. What is nearly there has no arrow.
pub(crate) fn paint_likelier(painter: &Painter, view: &ViewTransform, arrows: &[[DVec2; 2]]) {
    for &[from, to] in arrows {
        let [from, to] = [from, to].map(|px| view.screen_from_px(px));
        let along = to - from;
        if along.length() > 1.5 * HEAD && along.length() < LONGEST as f32 {
            arrow_to(painter, from, to, along.normalized(), LIKELIER);
        }
    }
}

fn arrow(painter: &Painter, from: Pos2, along: Vec2, colour: egui::Color32) {
    arrow_to(painter, from, from + along * ARROW, along, colour);
}

fn arrow_to(painter: &Painter, from: Pos2, tip: Pos2, along: Vec2, colour: egui::Color32) {
    let back = tip - along * HEAD;
    let side = vec2(-along.y, along.x) * (0.5 * HEAD);
    let head = [back + side, tip, back - side].map(|at| pos2(at.x, at.y)).to_vec();
    let casing = CASING.gamma_multiply(CASING_OPACITY);
    painter.line_segment([from, tip], Stroke::new(WIDTH + 2.0, casing));
    painter.add(Shape::line(head.clone(), Stroke::new(WIDTH + 2.0, casing)));
    painter.line_segment([from, tip], Stroke::new(WIDTH, colour));
    painter.add(Shape::line(head, Stroke::new(WIDTH, colour)));
}
