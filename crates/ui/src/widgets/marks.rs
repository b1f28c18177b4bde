//! Marks over a picture: the body's outline, the edges of its limbs, sight rays, a calibration, sides, and limits of joints.
//! All lie on a casing, so that nothing relies on its own contrast.

use egui::epaint::PathShape;
use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use glam::DVec2;

use super::ViewTransform;
use crate::drawing::{CalibrationMarks, LimitMark, ProjectedLimb, SideMarks, SightRay};
use crate::style::theme::data_colours::{
    BODY_OUTLINE, BODY_OUTLINE_CASING, CASING, INNER_EDGE, JOINT, RAY_CASING, SELECTED, mark,
};
use crate::style::theme::{self, Theme, size};

/// Lines are cut this far outside the view, in points.
const MARGIN: f32 = 12.0;

/// A painter over a picture: what it is given is in pixel coordinates.
#[derive(Clone)]
#[expect(missing_debug_implementations, reason = "egui has none for painters")]
pub struct Overlay {
    /// Paints in points of the screen, within the picture.
    pub painter: Painter,
    /// How the picture lies on the screen.
    pub view: ViewTransform,
}

/// A line with a casing under it: the strokes in the order in which they are painted.
pub fn cased(width: f32, colour: Color32) -> [Stroke; 2] {
    [Stroke::new(width + 2.0 * size::CASING, CASING), Stroke::new(width, colour)]
}

impl Overlay {
    /// The point of the screen at a pixel coordinate.
    pub fn at(&self, px: DVec2) -> Pos2 {
        self.view.screen_from_px(px)
    }

    /// The points of the screen along a line.
    pub fn points(&self, line: &[DVec2]) -> Vec<Pos2> {
        line.iter().map(|px| self.at(*px)).collect()
    }

    /// What of a line is in view, or nearly.
    fn in_view(&self, ends: [DVec2; 2]) -> Option<[Pos2; 2]> {
        clipped(ends.map(|px| self.at(px)), self.view.rect.expand(MARGIN))
    }

    /// Paints lines with one stroke after the other; of closed ones the last point joins the first.
    pub fn lines(&self, lines: &[Vec<DVec2>], strokes: [Stroke; 2], are_closed: bool) {
        for stroke in strokes {
            for points in lines.iter().map(|line| self.points(line)) {
                self.painter.add(PathShape { closed: are_closed, ..PathShape::line(points, stroke) });
            }
        }
    }

    /// Paints the outline of the body: closed polylines, or those of its limbs until the body's are there.
    pub fn body_outline(&self, lines: &[Vec<DVec2>], are_closed: bool) {
        let casing = Stroke::new(mark::OUTLINE_CASING_WIDTH, CASING.gamma_multiply(BODY_OUTLINE_CASING));
        self.lines(lines, [casing, Stroke::new(mark::OUTLINE_WIDTH, BODY_OUTLINE)], are_closed);
    }

    /// Paints the faint edges of limbs inside the outline.
    pub fn limb_edges(&self, limbs: &[Option<ProjectedLimb>]) {
        let stroke = Stroke::new(mark::INNER_EDGE_WIDTH, BODY_OUTLINE.gamma_multiply(INNER_EDGE));
        for limb in limbs.iter().flatten() {
            self.painter.add(Shape::closed_line(self.points(&limb.outline()), stroke));
        }
    }

    /// Paints a sight ray: dashed, and solid near the joint's depth.
    pub fn sight_ray(&self, ray: &SightRay) {
        let Some(line) = self.in_view(ray.line_px) else { return };
        let casing = Stroke::new(mark::RAY_CASING_WIDTH, CASING.gamma_multiply(RAY_CASING));
        self.painter.line_segment(line, casing);
        let stroke = Stroke::new(mark::RAY_WIDTH, SELECTED);
        let [dash, gap] = mark::RAY_DASH;
        self.painter.extend(Shape::dashed_line(&line, stroke, dash, gap));
        if let Some(solid) = ray.solid_px.and_then(|ends| self.in_view(ends)) {
            self.painter.line_segment(solid, stroke);
        }
    }
}

/// The part of a segment inside a rectangle (Liang and Barsky).
fn clipped([from, to]: [Pos2; 2], bounds: Rect) -> Option<[Pos2; 2]> {
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

/// Opacity of the grid.
const GRID_OPACITY: f32 = 0.3;
/// Half the width of the principal point's cross, in points.
const CROSS: f32 = 9.0;
/// Its ring.
const RING: f32 = 5.0;
/// Width of axes and cross.
const AXIS_WIDTH: f32 = 1.25;
/// Dash and gap of the lens edge.
const EDGE_DASH: [f32; 2] = [6.0, 4.0];
/// Size of the axes' letters.
const LETTER: f32 = 12.0;
/// From an axis' end to its letter.
const LETTER_AWAY: f32 = 9.0;

impl Overlay {
    /// Paints the grid under the axes, the lens edge, and the principal point.
    pub fn calibration(&self, marks: &CalibrationMarks) {
        let painter = &self.painter;
        let [casing, stroke] = cased(AXIS_WIDTH, JOINT);
        for line in marks.grid_px.iter().filter_map(|ends| self.in_view(*ends)) {
            painter.line_segment(line, Stroke::new(size::HAIRLINE, JOINT.gamma_multiply(GRID_OPACITY)));
        }
        if let Some(first) = marks.lens_edge_px.first() {
            let mut edge = self.points(&marks.lens_edge_px);
            edge.push(self.at(*first));
            painter.add(Shape::line(edge.clone(), Stroke::new(casing.width, CASING.gamma_multiply(0.5))));
            painter.extend(Shape::dashed_line(&edge, stroke, EDGE_DASH[0], EDGE_DASH[1]));
        }
        for (name, ends) in ["x", "y", "z"].into_iter().zip(marks.axes_px) {
            let Some(ends) = ends else { continue };
            let Some(line) = self.in_view(ends) else { continue };
            painter.line_segment(line, casing);
            painter.line_segment(line, stroke);
            let [from, to] = ends.map(|px| self.at(px));
            letter(painter, to + (to - from).normalized() * LETTER_AWAY, name);
        }
        let at = self.at(marks.principal_px);
        for stroke in [casing, stroke] {
            for arm in [vec2(CROSS, 0.0), vec2(0.0, CROSS)] {
                painter.line_segment([at - arm, at + arm], stroke);
            }
            painter.circle_stroke(at, RING, stroke);
        }
    }
}

fn letter(painter: &Painter, at: Pos2, text: &str) {
    let font = FontId::proportional(LETTER);
    for away in [vec2(-1.0, 0.0), vec2(1.0, 0.0), vec2(0.0, -1.0), vec2(0.0, 1.0), Vec2::ZERO] {
        let colour = if away == Vec2::ZERO { JOINT } else { CASING };
        painter.text(at + away, Align2::CENTER_CENTER, text, font.clone(), colour);
    }
}

/// From a hand or a foot to the middle of its letter, in points.
const LETTER_FROM_LIMB: f32 = 15.0;
/// Radius of a letter's ground, and of the nose's tip.
const LETTER_GROUND: f32 = 7.5;
const TIP: f32 = 3.5;
/// Width of the nose's line.
const NOSE_WIDTH: f32 = 1.5;
/// Opacity of a letter's ground.
const LETTER_OPACITY: f32 = 0.75;

impl Overlay {
    /// Paints letters beside hands and feet, and a nose: its tip is filled where the body faces the camera. A
    /// letter that does not lie in what is free of the picture is left out.
    pub fn sides(&self, marks: &SideMarks, free: Rect, font: &FontId) {
        let (painter, palette) = (&self.painter, theme::colours(Theme::Dark));
        for letter in &marks.letters {
            let away = vec2(letter.away.x as f32, letter.away.y as f32) * LETTER_FROM_LIMB;
            let at = self.at(letter.at) + away;
            if !free.shrink(LETTER_GROUND).contains(at) {
                continue;
            }
            painter.circle_filled(at, LETTER_GROUND, CASING.gamma_multiply(LETTER_OPACITY));
            painter.text(at, Align2::CENTER_CENTER, letter.side.letter(), font.clone(), palette.text);
        }
        if let Some(face) = marks.face {
            let [from, tip] = [face.from, face.tip].map(|px| self.at(px));
            // The line ends at the ring.
            let end = tip - (tip - from).normalized() * TIP.min(from.distance(tip));
            painter.line_segment([from, end], Stroke::new(NOSE_WIDTH + 2.0 * size::CASING, CASING));
            painter.circle_filled(tip, TIP + size::CASING, CASING);
            painter.line_segment([from, end], Stroke::new(NOSE_WIDTH, palette.text));
            if face.is_towards {
                painter.circle_filled(tip, TIP, palette.text);
            } else {
                painter.circle_stroke(tip, TIP - 0.5 * NOSE_WIDTH, Stroke::new(NOSE_WIDTH, palette.text));
            }
        }
    }
}

/// Opacity of the wedge, and of its sides.
const WEDGE: f32 = 0.14;
const WEDGE_SIDES: f32 = 0.6;
/// Half the bar's length across the limb at its limit, and the bar's width, in points.
const BAR: f32 = 9.0;
const BAR_WIDTH: f32 = 3.0;
/// From the arc to the words.
const WORDS_FROM_ARC: f32 = 14.0;
/// Around the words.
const WORDS_MARGIN: Vec2 = vec2(5.0, 2.0);
/// Opacity of the words' ground.
const WORDS_OPACITY: f32 = 0.82;

impl Overlay {
    /// Paints arcs and bars: under the joints.
    pub fn limits(&self, marks: &[LimitMark]) {
        let (painter, palette) = (&self.painter, theme::colours(Theme::Dark));
        for limit in marks {
            let pivot = self.at(limit.pivot);
            let arc = self.points(&limit.arc);
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
            for stroke in cased(mark::SELECTED_LIMB_WIDTH, SELECTED) {
                painter.line(arc.clone(), stroke);
            }
            for end in [arc.first(), arc.last()].into_iter().flatten() {
                painter.line_segment([pivot, *end], Stroke::new(1.0, SELECTED.gamma_multiply(WEDGE_SIDES)));
            }
            if let Some(reached) = limit.reached.map(|px| self.at(px)) {
                let along = (reached - pivot).normalized();
                let bar = [reached - along * BAR, reached + along * BAR];
                for stroke in cased(BAR_WIDTH, palette.warn) {
                    painter.line_segment(bar, stroke);
                }
                painter.circle_filled(reached, BAR_WIDTH + size::CASING, CASING);
                painter.circle_filled(reached, BAR_WIDTH, palette.warn);
            }
        }
    }

    /// Paints the words over everything else, inside the picture and beside each other; their places with what they say.
    pub fn limit_words<'a>(&self, marks: &'a [LimitMark], font: &FontId) -> Vec<(Rect, &'a str)> {
        let (painter, palette) = (&self.painter, theme::colours(Theme::Dark));
        let mut placed: Vec<(Rect, &str)> = Vec::new();
        let bounds = painter.clip_rect().shrink(4.0);
        for limit in marks {
            let colour = if limit.reached.is_some() { palette.warn } else { palette.text };
            let galley = painter.layout_no_wrap(limit.words.clone(), font.clone(), colour);
            let size = galley.size() + 2.0 * WORDS_MARGIN;
            let pivot = self.at(limit.pivot);
            let tip = self.at(limit.reached.unwrap_or(limit.now));
            let outwards = (tip - pivot).normalized() * WORDS_FROM_ARC;
            let align = if outwards.x < 0.0 { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
            let mut rect = within(align.anchor_size(tip + outwards, size), bounds);
            while let Some((other, _)) = placed.iter().find(|(other, _)| other.intersects(rect)) {
                let below = other.bottom() + 1.0;
                rect = rect.translate(vec2(0.0, below - rect.top()));
            }
            painter.rect_filled(rect, f32::from(size::FIELD_RADIUS), CASING.gamma_multiply(WORDS_OPACITY));
            painter.galley(rect.min + WORDS_MARGIN, galley, colour);
            placed.push((rect, &limit.words));
        }
        placed
    }
}

/// Moved by as little as puts it inside, where it fits.
fn within(rect: Rect, bounds: Rect) -> Rect {
    let x = rect.left().min(bounds.right() - rect.width()).max(bounds.left());
    let y = rect.top().min(bounds.bottom() - rect.height()).max(bounds.top());
    Rect::from_min_size(Pos2::new(x, y), rect.size())
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
