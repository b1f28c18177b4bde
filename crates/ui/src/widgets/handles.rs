//! Joints, limbs and sizes as things to take hold of: what is under the pointer, and the marks that show it. A limb's size
//! has a diamond beyond its end for the length, and one on each side for the radius.

use egui::{Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use glam::DVec2;

use super::marks::cased;
use super::{Overlay, ViewTransform};
use crate::drawing::{JointId, JointMark, ProjectedLimb, joined_outline};
use crate::style::theme::data_colours::{CASING, JOINT, SELECTED, SELECTED_LIMB_FILL, mark};
use crate::style::theme::size;

/// A joint is taken hold of within this distance, in points.
const REACH: f32 = 12.0;

/// A hovered joint's ring is this much larger.
const HOVER_GROWTH: f32 = 1.6;

/// A joint that makes room is a dot of this radius.
const SMALL_RADIUS: f32 = 2.0;

/// A selected joint's square, if it is pinned, is this much larger than any other's.
const SELECTED_PIN_SCALE: f32 = 1.5;

/// What the pointer can take hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// A joint.
    Joint(JointId),
    /// The limb of this index, by its body.
    Limb(usize),
    /// The length of the limb of this index, by the handle beyond its end.
    Length(usize),
    /// The radius of the limb of this index, by a handle on its outline.
    Radius(usize),
}

/// What is under `pointer`: the nearest joint within reach, else the nearest to the camera of the limbs there.
pub fn grip_at(
    pointer: Pos2,
    view: &ViewTransform,
    joints: &[JointMark],
    limbs: &[Option<ProjectedLimb>],
) -> Option<Grip> {
    let nearest = joints
        .iter()
        .map(|joint| (joint.id, view.screen_from_px(joint.px).distance(pointer)))
        .filter(|(_, distance)| *distance <= REACH)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((joint, _)) = nearest {
        return Some(Grip::Joint(joint));
    }
    let px = view.px_from_screen(pointer);
    let limbs = limbs.iter().enumerate().filter_map(|(index, limb)| Some((index, limb.as_ref()?)));
    limbs
        .filter(|(_, limb)| limb.distance_px(px) <= 0.0)
        .map(|(index, limb)| (index, limb.depth_at(px)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _)| Grip::Limb(index))
}

/// How a joint is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JointLook {
    /// It is the one that is held.
    pub is_selected: bool,
    /// The pointer is on it.
    pub is_hovered: bool,
    /// It is being dragged, or pressed.
    pub is_dragged: bool,
    /// It makes room for what is drawn about it.
    pub is_small: bool,
}

impl Overlay {
    /// Paints a joint's mark with its casing.
    pub fn joint(&self, joint: &JointMark, look: JointLook) {
        let (painter, at) = (&self.painter, self.at(joint.px));
        if look.is_dragged {
            for stroke in cased(mark::DRAG_RING_WIDTH, SELECTED) {
                painter.circle_stroke(at, mark::DRAG_RING_RADIUS, stroke);
            }
        }
        let colour = if look.is_selected { SELECTED } else { JOINT };
        match (joint.is_pinned, look.is_selected) {
            (true, is_selected) => {
                let scale = if is_selected || look.is_hovered { SELECTED_PIN_SCALE } else { 1.0 };
                let square = |side: f32| Rect::from_center_size(at, Vec2::splat(side));
                let margin = mark::PIN_CASING_SIDE - mark::PIN_SIDE;
                painter.rect_filled(square(mark::PIN_SIDE * scale + margin), 0.0, CASING);
                painter.rect_filled(square(mark::PIN_SIDE * scale), 0.0, colour);
                if is_selected {
                    painter.circle_filled(at, mark::SELECTED_CORE_RADIUS, CASING);
                }
            }
            (false, _) if look.is_small && !look.is_dragged && !look.is_hovered => {
                painter.circle_filled(at, SMALL_RADIUS + size::CASING, CASING);
                painter.circle_filled(at, SMALL_RADIUS, colour);
            }
            (false, true) => {
                painter.circle_filled(at, mark::SELECTED_CASING_RADIUS, CASING);
                painter.circle_filled(at, mark::SELECTED_RADIUS, SELECTED);
                painter.circle_filled(at, mark::SELECTED_CORE_RADIUS, CASING);
            }
            (false, false) => {
                let radius = mark::JOINT_RADIUS + if look.is_hovered { HOVER_GROWTH } else { 0.0 };
                painter.circle_filled(at, radius + mark::JOINT_WIDTH * 0.5 + size::CASING, CASING);
                painter.circle_stroke(at, radius, Stroke::new(mark::JOINT_WIDTH, JOINT));
            }
        }
    }

    /// Paints limbs that turn together as held (filled and outlined in the accent), or as under the pointer
    /// (outlined like a joint).
    pub fn limbs(&self, limbs: &[&ProjectedLimb], is_selected: bool) {
        if is_selected {
            let fill = SELECTED.gamma_multiply(SELECTED_LIMB_FILL);
            for limb in limbs {
                let outline = self.points(&limb.outline());
                self.painter.add(Shape::convex_polygon(outline, fill, Stroke::NONE));
            }
        }
        let colour = if is_selected { SELECTED } else { JOINT };
        self.lines(&joined_outline(limbs), cased(mark::SELECTED_LIMB_WIDTH, colour), false);
    }
}

/// A handle is taken hold of within this distance, in points.
const DIAMOND_REACH: f32 = 9.0;
/// From a diamond's middle to its corners.
const DIAMOND_HALF: f32 = 5.5;
/// How much larger a diamond is under the pointer.
const DIAMOND_GROWTH: f32 = 1.5;
/// From the limb's border at its end to the length's diamond.
const BEYOND: f32 = 12.0;
/// The length's diamond is at least so far from every joint, …
const CLEAR_OF_JOINTS: f32 = 16.0;
/// … to which it is pushed on by this much, so often.
const PUSH: f32 = 6.0;
const MOST_PUSHES: usize = 8;
/// A limb seen shorter than this has no handle for its length: it points at the camera. Points.
const END_ON: f32 = 10.0;

/// The handles of one limb, in points of the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeHandles {
    limb: usize,
    /// The limb's second joint and the diamond beyond it.
    length: Option<[Pos2; 2]>,
    radius: [Pos2; 2],
}

impl SizeHandles {
    /// The handles of the limb of this index, as `projected` in the picture.
    /// The length's keeps clear of `joints`.
    pub fn new(limb: usize, projected: &ProjectedLimb, view: &ViewTransform, joints: &[JointMark]) -> Self {
        let on_screen = |px: DVec2| view.screen_from_px(px);
        let [start, end] = projected.ends_px.map(on_screen);
        let along = end - start;
        let mut beyond = projected.radii_px[1] as f32 * view.points_per_px + BEYOND;
        let at = |beyond: f32| end + along.normalized() * beyond;
        let is_on_joint =
            |at: Pos2| joints.iter().any(|joint| on_screen(joint.px).distance(at) < CLEAR_OF_JOINTS);
        for _ in 0..MOST_PUSHES {
            if is_on_joint(at(beyond)) {
                beyond += PUSH;
            }
        }
        let length = (along.length() >= END_ON).then(|| [end, at(beyond)]);
        Self { limb, length, radius: [-1.0, 1.0].map(|side| on_screen(projected.side_px(side))) }
    }

    /// The handle under the pointer.
    pub fn grip_at(&self, pointer: Pos2) -> Option<Grip> {
        let is_near = |at: Pos2| at.distance(pointer) <= DIAMOND_REACH;
        if self.length.is_some_and(|[_, at]| is_near(at)) {
            return Some(Grip::Length(self.limb));
        }
        self.radius.into_iter().any(is_near).then_some(Grip::Radius(self.limb))
    }

    /// Where the handles are, with what each is called.
    pub fn places(&self) -> impl Iterator<Item = (Pos2, &'static str)> {
        let length = self.length.map(|[_, at]| (at, "length"));
        length.into_iter().chain([(self.radius[0], "radius"), (self.radius[1], "radius, other side")])
    }

    /// Paints the diamonds; `held` is the one that is hovered or dragged.
    pub fn paint(&self, painter: &Painter, held: Option<Grip>) {
        if let Some([from, to]) = self.length {
            for stroke in cased(mark::RAY_WIDTH, SELECTED) {
                painter.line_segment([from, to], stroke);
            }
            diamond(painter, to, held == Some(Grip::Length(self.limb)));
        }
        for at in self.radius {
            diamond(painter, at, held == Some(Grip::Radius(self.limb)));
        }
    }
}

fn diamond(painter: &Painter, at: Pos2, is_held: bool) {
    let half = DIAMOND_HALF + if is_held { DIAMOND_GROWTH } else { 0.0 };
    for (half, colour) in [(half + 1.5, CASING), (half, SELECTED), (half - 3.5, CASING)] {
        let corners = [vec2(0.0, -half), vec2(half, 0.0), vec2(0.0, half), vec2(-half, 0.0)];
        let corners = corners.map(|corner: Vec2| at + corner).to_vec();
        painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE));
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::render::RendererKind;
    use egui::pos2;

    use super::*;

    fn view() -> ViewTransform {
        ViewTransform {
            rect: Rect::from_min_size(pos2(0.0, 0.0), vec2(200.0, 200.0)),
            points_per_px: 2.0,
            centre_px: pos2(50.0, 50.0),
        }
    }

    fn joint(id: JointId, x: f64, y: f64) -> JointMark {
        JointMark { id, name: String::new(), px: DVec2::new(x, y), depth_m: 2.0, is_pinned: false }
    }

    fn limb(y: f64, depth_m: f64) -> Option<ProjectedLimb> {
        Some(ProjectedLimb {
            ends_px: [DVec2::new(20.0, y), DVec2::new(80.0, y)],
            radii_px: [5.0; 2],
            depths_m: [depth_m; 2],
            solid: RendererKind::Capsule,
        })
    }

    #[test]
    fn joints_come_before_limbs_and_near_limbs_before_far_ones() {
        let joints = [joint(JointId::Root, 20.0, 50.0), joint(JointId::End(0), 25.0, 50.0)];
        let limbs = [None, limb(50.0, 3.0), limb(52.0, 2.0)];
        let at = |x: f32, y: f32| grip_at(pos2(x, y), &view(), &joints, &limbs);
        assert_eq!(at(44.0, 100.0), Some(Grip::Joint(JointId::Root)));
        assert_eq!(at(46.0, 100.0), Some(Grip::Joint(JointId::End(0))));
        assert_eq!(at(61.9, 100.0), Some(Grip::Joint(JointId::End(0))));
        assert_eq!(at(63.0, 100.0), Some(Grip::Limb(2)));
        assert_eq!(at(100.0, 92.0), Some(Grip::Limb(1)));
        assert_eq!(at(100.0, 130.0), None);
    }

    #[test]
    fn diamonds_lie_beyond_the_end_and_on_the_outline() {
        let limb = ProjectedLimb {
            ends_px: [DVec2::new(20.0, 50.0), DVec2::new(60.0, 50.0)],
            radii_px: [6.0, 4.0],
            depths_m: [3.0; 2],
            solid: RendererKind::Capsule,
        };
        let handles = SizeHandles::new(7, &limb, &view(), &[]);
        let at = |x: f32, y: f32| handles.grip_at(pos2(x, y));
        assert_eq!(at(120.0 + 8.0 + 12.0, 100.0), Some(Grip::Length(7)));
        assert_eq!(at(80.0, 90.0), Some(Grip::Radius(7)));
        assert_eq!(at(80.0, 110.0), Some(Grip::Radius(7)));
        assert_eq!(at(100.0, 100.0), None);
        let end_on = ProjectedLimb { ends_px: [limb.ends_px[0], DVec2::new(22.0, 50.0)], ..limb };
        assert!(SizeHandles::new(7, &end_on, &view(), &[]).places().all(|(_, name)| name != "length"));
    }
}
