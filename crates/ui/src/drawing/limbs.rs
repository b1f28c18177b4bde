//! Limbs and spheres of a body projected to capsules and discs of the picture, for outlines and for finding the limb
//! under the pointer.
//!
//! The projection of a sphere is taken as a disc of radius f r / z about its centre: within a percent for limbs
//! that are not at the very edge of a wide picture.

use std::f64::consts::TAU;

use backlit_tracking::body::{Kinematics, Limb, Model, PlacedSphere};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::{RendererKind, sphere_fractions};
use glam::{DVec2, DVec3};

use super::outline::simplified;

/// Limbs with an end nearer than this to the camera plane are not drawn (metres).
const NEAREST_M: f64 = 0.05;

/// Points on a whole circle of an outline.
const CIRCLE_POINTS: usize = 32;

/// A limb as one camera sees it: two discs and what lies between them. Its first joint comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedLimb {
    /// Its joints.
    pub ends_px: [DVec2; 2],
    /// Radii at the joints.
    pub radii_px: [f64; 2],
    /// Depths of the joints, metres.
    pub depths_m: [f64; 2],
    /// What stands for it.
    pub solid: RendererKind,
}

impl ProjectedLimb {
    /// A solid between two points of the world; `None` for one that reaches behind the camera.
    pub(super) fn new(camera: &Camera, ends: [DVec3; 2], radius: f64, solid: RendererKind) -> Option<Self> {
        let [start, end] = ends.map(|end| place_in_front(camera, end));
        let depths_m = ends.map(|end| camera.depth(end));
        let radii_px = depths_m.map(|depth| camera.intrinsics().mean_focal_px() * radius / depth);
        Some(Self { ends_px: [start?, end?], radii_px, depths_m, solid })
    }

    /// Distance of a pixel from the capsule's border, in pixels; negative inside.
    pub fn distance_px(&self, px: DVec2) -> f64 {
        let share = self.nearest_share(px);
        let [start, end] = self.radii_px;
        px.distance(self.ends_px[0].lerp(self.ends_px[1], share)) - (start + share * (end - start))
    }

    /// A point of the border beside the middle of the limb: to the right of its direction on the screen for 1, to the
    /// left for −1.
    pub fn side_px(&self, side: f64) -> DVec2 {
        let [start, end] = self.ends_px;
        let across = (end - start).try_normalize().unwrap_or(DVec2::X).perp();
        let radius = 0.5 * (self.radii_px[0] + self.radii_px[1]);
        start.lerp(end, 0.5) + across * (side * radius)
    }

    /// The same limb with other radii.
    pub fn widened(&self, factor: f64) -> Self {
        Self { radii_px: self.radii_px.map(|radius| radius * factor), ..*self }
    }

    /// Whether the boxes around two limbs meet.
    fn is_near(&self, other: &Self) -> bool {
        let [(min, max), (other_min, other_max)] = [self, other].map(Self::bounds);
        min.cmple(other_max).all() && other_min.cmple(max).all()
    }

    fn bounds(&self) -> (DVec2, DVec2) {
        let ([start, end], [start_radius, end_radius]) = (self.ends_px, self.radii_px.map(DVec2::splat));
        ((start - start_radius).min(end - end_radius), (start + start_radius).max(end + end_radius))
    }

    /// Depth of the axis where it passes nearest to a pixel, metres.
    pub fn depth_at(&self, px: DVec2) -> f64 {
        // Along a line, 1/z is linear in the picture.
        let share = self.nearest_share(px);
        1.0 / ((1.0 - share) / self.depths_m[0] + share / self.depths_m[1])
    }

    /// The limb's border as a convex polygon, clockwise on the screen: a cylinder's ends straight at the joints, as
    /// seen from the side.
    pub fn outline(&self) -> Vec<DVec2> {
        let discs @ [start, end] = [0, 1].map(|index| (self.ends_px[index], self.radii_px[index]));
        let along = end.0 - start.0;
        let (distance, difference) = (along.length(), start.1 - end.1);
        if distance <= difference.abs() {
            return arc(discs[usize::from(difference <= 0.0)], 0.0, TAU).collect();
        }
        // The common tangents touch both discs at this angle from the axis.
        let (heading, touch) = (along.to_angle(), (difference / distance).acos());
        match self.solid {
            RendererKind::Cylinder => {
                let corners = [(end, -touch), (end, touch), (start, touch), (start, -touch)];
                let corner = |((centre, radius), turn)| centre + radius * DVec2::from_angle(heading + turn);
                corners.map(corner).to_vec()
            }
            RendererKind::Capsule | RendererKind::SphereTree { .. } => {
                let round_start = arc(start, heading + touch, heading + TAU - touch);
                arc(end, heading - touch, heading + touch).chain(round_start).collect()
            }
        }
    }

    fn nearest_share(&self, px: DVec2) -> f64 {
        let along = self.ends_px[1] - self.ends_px[0];
        let share = (px - self.ends_px[0]).dot(along) / along.length_squared();
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// Where a camera sees a point, unless that is nearer than [`NEAREST_M`] or behind it.
pub(super) fn place_in_front(camera: &Camera, point: DVec3) -> Option<DVec2> {
    let px = camera.project(point).filter(|px| px.is_finite());
    px.filter(|_| camera.depth(point) > NEAREST_M)
}

/// The borders of limbs that turn together, without what lies inside another of them: polylines, the first and
/// last point of a closed one being the same.
pub fn joined_outline(limbs: &[&ProjectedLimb]) -> Vec<Vec<DVec2>> {
    let mut lines = Vec::new();
    for (index, limb) in limbs.iter().enumerate() {
        let others = limbs.iter().enumerate().filter(|(other, _)| *other != index);
        let near: Vec<_> = others.map(|(_, other)| other).filter(|other| limb.is_near(other)).collect();
        let mut border = subdivided(&limb.outline());
        let is_hidden = |px: &DVec2| near.iter().any(|other| other.distance_px(*px) < -HIDDEN_PX);
        // Starting behind a hidden point, every visible run is whole.
        if let Some(hidden) = border.iter().position(is_hidden) {
            border.rotate_left(hidden);
        } else {
            border.extend(border.first().copied());
        }
        let runs = border.split(is_hidden).filter(|run| run.len() > 1);
        lines.extend(runs.map(|run| simplified(run, STRAIGHT_PX)));
    }
    lines
}

/// Depth inside another limb at which a border is hidden, pixels: two limbs that are equal still show one.
const HIDDEN_PX: f64 = 0.25;

/// Points this near to a straight line are not needed, pixels.
const STRAIGHT_PX: f64 = 0.01;

/// Longest side of a subdivided border, pixels.
const LONGEST_SIDE_PX: f64 = 2.0;

fn subdivided(polygon: &[DVec2]) -> Vec<DVec2> {
    let next = polygon.iter().cycle().skip(1);
    let sides = polygon.iter().zip(next).flat_map(|(from, to)| {
        let steps = (from.distance(*to) / LONGEST_SIDE_PX).ceil().clamp(1.0, 1000.0) as usize;
        (0..steps).map(move |step| from.lerp(*to, step as f64 / steps as f64))
    });
    sides.collect()
}

fn arc((centre, radius): (DVec2, f64), from: f64, to: f64) -> impl Iterator<Item = DVec2> {
    let steps = (((to - from) / TAU * CIRCLE_POINTS as f64).ceil() as usize).max(1);
    (0..=steps)
        .map(move |step| centre + radius * DVec2::from_angle(from + (to - from) * step as f64 / steps as f64))
}

/// Every limb as a camera sees it; `None` for one that reaches behind the camera.
pub fn project_limbs(
    model: &Model,
    kinematics: &Kinematics,
    camera: &Camera,
    renderer: RendererKind,
) -> Vec<Option<ProjectedLimb>> {
    let ends = kinematics.starts().iter().zip(kinematics.ends());
    let limb = |(limb, (start, end)): (&Limb, (&DVec3, &DVec3))| {
        ProjectedLimb::new(camera, [*start, *end], limb.radius, renderer)
    };
    model.limbs().iter().zip(ends).map(limb).collect()
}

/// A sphere as one camera sees it, taken as a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedSphere {
    /// Index of its limb.
    pub limb: usize,
    /// Its centre.
    pub centre_px: DVec2,
    /// Its radius.
    pub radius_px: f64,
}

/// The spheres that a renderer stands a body on: those of a level of the limbs' trees, counted from the coarsest, and equal ones
/// along the axis of limbs without a tree. None of other renderers.
pub fn body_spheres(
    model: &Model,
    kinematics: &Kinematics,
    renderer: RendererKind,
    level: usize,
) -> Vec<PlacedSphere> {
    let RendererKind::SphereTree { spheres } = renderer else { return Vec::new() };
    let trees = model.placed_spheres(kinematics, level);
    let mut placed = Vec::new();
    for (index, limb) in model.limbs().iter().enumerate() {
        match RendererKind::equal_spheres(limb, spheres) {
            None => placed.extend(trees.iter().filter(|sphere| sphere.limb == index)),
            Some(count) => {
                let (from, to) = (kinematics.starts()[index], kinematics.ends()[index]);
                let equal = |at| PlacedSphere { limb: index, centre: from.lerp(to, at), radius: limb.radius };
                placed.extend(sphere_fractions(count).map(equal));
            }
        }
    }
    placed
}

/// Spheres as a camera sees them, the farthest first; without those behind it.
pub fn project_spheres(spheres: &[PlacedSphere], camera: &Camera) -> Vec<ProjectedSphere> {
    let focal = camera.intrinsics().mean_focal_px();
    let project = |sphere: &PlacedSphere| {
        let depth = camera.depth(sphere.centre);
        let centre_px = (depth > NEAREST_M).then(|| camera.project(sphere.centre))??;
        Some((
            depth,
            ProjectedSphere { limb: sphere.limb, centre_px, radius_px: focal * sphere.radius / depth },
        ))
    };
    let mut seen: Vec<_> = spheres.iter().filter_map(project).collect();
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    seen.into_iter().map(|(_, sphere)| sphere).collect()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{LimbSphere, Pose, SphereLevel, builtin};

    use super::*;

    const LIMB: ProjectedLimb = ProjectedLimb {
        ends_px: [DVec2::new(10.0, 20.0), DVec2::new(50.0, 20.0)],
        radii_px: [8.0, 4.0],
        depths_m: [2.0, 4.0],
        solid: RendererKind::Capsule,
    };

    #[test]
    fn distances_and_depths_follow_the_limb() {
        assert!((LIMB.distance_px(DVec2::new(30.0, 20.0)) + 6.0).abs() < 1e-9);
        assert!((LIMB.distance_px(DVec2::new(57.0, 20.0)) - 3.0).abs() < 1e-9);
        assert!((LIMB.depth_at(DVec2::new(30.0, 0.0)) - 8.0 / 3.0).abs() < 1e-9);
        let point = ProjectedLimb { ends_px: [LIMB.ends_px[0]; 2], ..LIMB };
        assert!(point.distance_px(DVec2::new(10.0, 30.0)).is_finite());
    }

    #[test]
    fn joined_limbs_show_no_edge_between_them() {
        let alone = joined_outline(&[&LIMB]);
        assert_eq!(alone.len(), 1);
        assert_eq!(alone[0].first(), alone[0].last());
        let joint = LIMB.ends_px[1];
        let next = ProjectedLimb { ends_px: [joint, DVec2::new(90.0, 20.0)], radii_px: [4.0; 2], ..LIMB };
        let lines = joined_outline(&[&LIMB, &next]);
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().flatten().all(|px| px.distance(joint) > 3.7), "nothing crosses the joint");
    }

    #[test]
    fn the_outline_touches_both_discs_and_is_convex() {
        let near = ProjectedLimb { ends_px: [LIMB.ends_px[0], DVec2::new(12.0, 21.0)], ..LIMB };
        for limb in [LIMB, near, ProjectedLimb { solid: RendererKind::Cylinder, ..LIMB }] {
            let outline = limb.outline();
            for (index, point) in outline.iter().enumerate() {
                let off = |end: usize| (point.distance(limb.ends_px[end]) - limb.radii_px[end]).abs();
                assert!(off(0).min(off(1)) < 1e-9);
                let ahead = outline[(index + 1) % outline.len()] - *point;
                let next = outline[(index + 2) % outline.len()] - *point;
                assert!(ahead.perp_dot(next) > -1e-9, "clockwise on the screen at {index}");
            }
        }
    }

    const OWN: RendererKind = RendererKind::SphereTree { spheres: None };

    #[test]
    fn limbs_with_trees_have_their_levels_and_others_equal_spheres() {
        let model = builtin::single_limb();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        assert!(body_spheres(&model, &kinematics, RendererKind::Capsule, 0).is_empty());
        let three = body_spheres(&model, &kinematics, RendererKind::SphereTree { spheres: Some(3) }, 0);
        assert_eq!(three.len(), 3);
        assert!(three[1].centre.abs_diff_eq(kinematics.starts()[0].midpoint(kinematics.ends()[0]), 1e-12));

        let sphere = |at: f64, parent| LimbSphere { at, radius: 0.1, offset: DVec3::X * 0.02, parent };
        let level = |spheres: Vec<LimbSphere>| SphereLevel { error: 0.01, spheres, reaches: Vec::new() };
        let levels =
            vec![level(vec![sphere(0.5, None)]), level(vec![sphere(0.2, Some(0)), sphere(0.8, Some(0))])];
        let tree = model.with_trees(vec![levels]).unwrap();
        let counts = [0, 1, 9].map(|level| body_spheres(&tree, &kinematics, OWN, level).len());
        assert_eq!(counts, [1, 2, 2], "there is nothing finer than the finest");
    }
}
