//! Handles for a limb's size in a picture: a diamond beyond its end for the length, one on each side for the radius.

use egui::{Painter, Pos2, Shape, Stroke, Vec2, vec2};
use glam::DVec2;

use super::{Grip, ViewTransform};
use crate::drawing::{JointMark, ProjectedLimb};
use crate::style::theme::data_colours::{CASING, SELECTED, mark};
use crate::style::theme::size;

/// A handle is taken hold of within this distance, in points.
const REACH: f32 = 9.0;
/// From a diamond's middle to its corners.
const HALF: f32 = 5.5;
/// How much larger a diamond is under the pointer.
const HOVER_GROWTH: f32 = 1.5;
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
        let [start, end] = [projected.start_px, projected.end_px].map(on_screen);
        let along = end - start;
        let mut beyond = projected.end_radius_px as f32 * view.points_per_px + BEYOND;
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
        let is_near = |at: Pos2| at.distance(pointer) <= REACH;
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
            let casing = Stroke::new(mark::RAY_WIDTH + 2.0 * size::CASING, CASING);
            painter.line_segment([from, to], casing);
            painter.line_segment([from, to], Stroke::new(mark::RAY_WIDTH, SELECTED));
            diamond(painter, to, held == Some(Grip::Length(self.limb)));
        }
        for at in self.radius {
            diamond(painter, at, held == Some(Grip::Radius(self.limb)));
        }
    }
}

fn diamond(painter: &Painter, at: Pos2, is_held: bool) {
    let half = HALF + if is_held { HOVER_GROWTH } else { 0.0 };
    for (half, colour) in [(half + 1.5, CASING), (half, SELECTED), (half - 3.5, CASING)] {
        let corners = [vec2(0.0, -half), vec2(half, 0.0), vec2(0.0, half), vec2(-half, 0.0)];
        let corners = corners.map(|corner: Vec2| at + corner).to_vec();
        painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE));
    }
}

#[cfg(test)]
mod tests {
    use egui::{Rect, pos2};

    use super::*;

    #[test]
    fn diamonds_lie_beyond_the_end_and_on_the_outline() {
        let limb = ProjectedLimb {
            start_px: DVec2::new(20.0, 50.0),
            end_px: DVec2::new(60.0, 50.0),
            start_radius_px: 6.0,
            end_radius_px: 4.0,
            start_depth_m: 3.0,
            end_depth_m: 3.0,
            has_flat_ends: false,
        };
        let view = ViewTransform {
            rect: Rect::from_min_size(Pos2::ZERO, vec2(200.0, 200.0)),
            points_per_px: 2.0,
            centre_px: pos2(50.0, 50.0),
        };
        let handles = SizeHandles::new(7, &limb, &view, &[]);
        let at = |x: f32, y: f32| handles.grip_at(pos2(x, y));
        assert_eq!(at(120.0 + 8.0 + 12.0, 100.0), Some(Grip::Length(7)));
        assert_eq!(at(80.0, 90.0), Some(Grip::Radius(7)));
        assert_eq!(at(80.0, 110.0), Some(Grip::Radius(7)));
        assert_eq!(at(100.0, 100.0), None);
        let end_on = ProjectedLimb { end_px: DVec2::new(22.0, 50.0), ..limb };
        assert!(SizeHandles::new(7, &end_on, &view, &[]).places().all(|(_, name)| name != "length"));
    }
}
