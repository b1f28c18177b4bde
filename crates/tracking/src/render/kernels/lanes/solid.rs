//! One solid's constants for a camera, and the tiles that its parts may touch on each tile row.

use glam::{DVec3, Vec3};

use super::grid::PixelGrid;
use super::outline::{BallOutline, Bounds, Lattice, RowRule};
use crate::camera::Intrinsics;
use crate::render::primitive::{PixelBox, Primitive, SolidShape};
use crate::render::ramp::{BACKGROUND, RampForm, SolidRamp};

/// The reach is taken this much larger than it is, relatively, where outlines are cut.
const REACH_MARGIN: f64 = 1e-6;
/// An axis that passes the camera at fewer reaches than this is asked for its nearest point the long way.
const FEWEST_REACHES: f64 = 2.0;
/// A capsule in a smaller box of sampled pixels is looked at as a whole: its parts' outlines would cost more than they
/// save.
const FEWEST_FOR_PARTS: usize = 800;
/// A flat cap is looked at as if it reached this much farther than it does.
const WIDE: f64 = 1.1;
/// How many roundings of a ray's place on the plane z = 1 a distance is wrong by, at the most.
const ROUNDINGS: f64 = 2.0;

/// A solid in camera axes, ready for lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneSolid {
    /// Index of its limb.
    pub limb: usize,
    /// Its index in the view.
    pub primitive: usize,
    /// What is nearest to a ray.
    pub shape: Shape,
    /// First joint, from which t is counted, and second; that is used by flat caps and balls.
    pub joints: [LaneJoint; 2],
    /// a = p1 − p0, metres.
    pub a: Vec3,
    /// a / z₀: the axis in units of the first joint's depth.
    pub axis: Vec3,
    /// ê₀ × axis.
    pub cross: Vec3,
    pub ramp: LaneRamp,
    /// Tile rows of the grid that it may touch, end excluded.
    pub tile_rows: [usize; 2],
    /// Its axis apart from its ends, where that can be.
    pub sight: Option<AxisSight>,
    /// What its parts may touch.
    pub outline: Outline,
    /// Where its spans begin in the list of all of them.
    pub spans: usize,
    /// No pixel of a flat cap is darker than background beyond this, squared, in units of the first joint's depth.
    pub cap_reach: f32,
    /// λ/255 of it is at most this wrong.
    pub error: f32,
    /// For a sphere fixed anywhere in its limb.
    pub anchor: Option<Anchor>,
}

/// How a camera sees a limb's infinite axis. With â its direction, w the unit vector to it from the camera's centre
/// at distance D, v = â × w, and the first joint p0 = s₀ â + D w.
#[derive(Debug, Clone, Copy)]
pub(super) struct AxisSight {
    /// −D w and D v: what S and T are multiplied with.
    pub basis: [DVec3; 2],
    /// v, across and down.
    pub v: [f32; 2],
    /// w, across and down, and w·ê₀.
    pub w: [f32; 3],
    /// (D â − s₀ w)/|a|, across and down.
    pub along: [f32; 2],
    /// s₀/|a|.
    pub foot: f32,
    /// |a|²/D².
    pub beyond: f32,
    /// What λ/255 rises by with d²/D², or with d/D for linear ramps.
    pub slope: f32,
}

/// The tiles of a solid's parts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Outline {
    /// A ball about the first joint.
    Ball(BallOutline),
    /// The axis between the joints, what it darkens altogether, and the balls about both joints.
    Parts { axis: Bounds, core: Option<Bounds>, balls: [BallOutline; 2] },
    /// All in one.
    Whole(Bounds),
}

/// Where a sphere sits in its limb, camera axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Anchor {
    /// From the limb's first joint, about which moments are taken, to the sphere's centre.
    pub arm: DVec3,
    /// The limb's own axis, whose ends share the pull of the depth.
    pub limb_axis: DVec3,
}

/// What of a solid a ray may be nearest to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// The axis, t clamped to its ends: a capsule, or a single sphere where the axis has no length.
    Capsule,
    /// Equal spheres at multiples of 1/gaps along the axis.
    Spheres { gaps: f32 },
    /// The axis without its ends, and two flat caps; each cap may be hit only in its columns and rows.
    Cylinder { caps: [PixelBox; 2] },
}

/// A joint p = z ê with ê = (x, y, 1).
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneJoint {
    pub x: f32,
    pub y: f32,
    pub z: f32,
    /// axis · ê, in f64 before it was rounded.
    pub axis_along: f32,
}

/// λ/255 = slope · m + offset, with m = d² or d in units of the first joint's depth.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneRamp {
    pub slope: f32,
    pub offset: f32,
    /// m is d and not d².
    pub is_linear: bool,
    /// ∂λ/∂z = constant + slope · λ/255 for ramps whose width follows the depth.
    pub by_depth: Option<[f32; 2]>,
    /// d = distance[0] + distance[1] · λ/255, metres, for linear ramps.
    pub distance: [f32; 2],
    /// ∂λ/∂q = factor · f, with f = δ for quadratic ramps and δ/d for linear ones.
    pub factor: f64,
}

impl LaneSolid {
    /// Constants of a primitive; `None` if it touches no sampled pixel.
    pub(super) fn new(
        primitive: &Primitive,
        pinhole: &Intrinsics,
        grid: &PixelGrid,
        lattice: &Lattice,
    ) -> Option<Self> {
        let [p0, p1] = primitive.solid.axis();
        let bounds = grid.sampled(&primitive.bounds);
        if bounds.is_empty() {
            return None;
        }
        let reach = primitive.ramp.reach;
        let a = p1 - p0;
        let axis = a / p0.z;
        let shape = match primitive.solid.shape {
            SolidShape::Capsule | SolidShape::Sphere(_) => Shape::Capsule,
            SolidShape::Spheres(count) => Shape::Spheres { gaps: (count - 1) as f32 },
            SolidShape::Cylinder => {
                let size = [grid.columns, grid.rows].map(|count| grid.pixel(count.saturating_sub(1)) + 1);
                let cap = |p| grid.sampled(&PixelBox::around(p, p, reach, pinhole, size));
                Shape::Cylinder { caps: [p0, p1].map(cap) }
            }
        };
        let sight = AxisSight::new(p0, a, &primitive.ramp);
        let outline = match (shape, sight) {
            (Shape::Capsule, _) if a == DVec3::ZERO => {
                Outline::Ball(BallOutline::new(p0, reach * (1.0 + REACH_MARGIN), None, lattice))
            }
            (Shape::Capsule, Some((frame, _))) if bounds.pixels() >= FEWEST_FOR_PARTS => {
                frame.parts(&primitive.ramp, [p0, p1], lattice)
            }
            _ => {
                let halves = sight.map_or_else(
                    || Bounds::new([], RowRule::Any, lattice),
                    |(frame, _)| Bounds::new(frame.edges(reach), RowRule::Any, lattice),
                );
                let [first, past] = bounds.columns.map(|column| column as f64);
                Outline::Whole(halves.and_columns([first, past - 1.0]))
            }
        };
        Some(Self {
            limb: primitive.limb,
            primitive: 0,
            shape,
            joints: [p0, p1].map(|p| LaneJoint::new(p, axis)),
            a: a.as_vec3(),
            axis: axis.as_vec3(),
            cross: (p0 / p0.z).cross(axis).as_vec3(),
            ramp: LaneRamp::new(primitive.ramp.form, p0.z),
            tile_rows: grid.tile.rows_touched(bounds.rows),
            sight: sight.map(|(_, sight)| sight),
            outline,
            spans: 0,
            cap_reach: (WIDE * reach / p0.z).powi(2) as f32,
            error: error(&primitive.ramp, p0, p1),
            anchor: match (primitive.solid.shape, primitive.solid.joints) {
                (SolidShape::Sphere(centre), [p0, p1]) => {
                    Some(Anchor { arm: centre - p0, limb_axis: p1 - p0 })
                }
                _ => None,
            },
        })
    }
}

/// An infinite axis in camera axes; see [`AxisSight`].
#[derive(Debug, Clone, Copy)]
struct AxisFrame {
    direction: DVec3,
    w: DVec3,
    v: DVec3,
    distance: f64,
    length: f64,
    /// Where the first joint is along the axis.
    foot: f64,
}

impl AxisSight {
    /// None where the axis passes too near to the camera's centre, or is a point.
    fn new(p0: DVec3, a: DVec3, ramp: &SolidRamp) -> Option<(AxisFrame, Self)> {
        let length = a.length();
        let direction = a / length;
        let foot = p0.dot(direction);
        let across = p0 - direction * foot;
        let distance = across.length();
        if !(length > 0.0 && distance > FEWEST_REACHES * ramp.reach) {
            return None;
        }
        let w = across / distance;
        let v = direction.cross(w);
        let along = (direction * distance - w * foot) / length;
        let (slope, _, is_linear) = ramp.form.line();
        let unit = if is_linear { distance } else { distance * distance };
        let frame = AxisFrame { direction, w, v, distance, length, foot };
        Some((
            frame,
            Self {
                basis: [w * -distance, v * distance],
                v: [v.x as f32, v.y as f32],
                w: [w.x as f32, w.y as f32, (distance / p0.z) as f32],
                along: [along.x as f32, along.y as f32],
                foot: (foot / length) as f32,
                beyond: (length / distance).powi(2) as f32,
                slope: (f64::from(slope) * unit) as f32,
            },
        ))
    }
}

impl AxisFrame {
    /// The two halves of the picture in which a ray comes within `reach` of the infinite axis: with
    /// sin φ = reach/D, where |e·v| cos φ < (e·w) sin φ.
    fn edges(&self, reach: f64) -> [DVec3; 2] {
        let sin = reach * (1.0 + REACH_MARGIN) / self.distance;
        let cos = (1.0 - sin * sin).max(0.0).sqrt();
        [1.0, -1.0].map(|side| self.v * (side * cos) - self.w * sin)
    }

    /// A capsule's parts. With E = e·(D â − s w), A = e·v and B = e·w, the ray's nearest point of the axis lies beyond a
    /// joint at s where E B > s A². Within reach A² is at most B² tan² φ, which leaves straight lines that are
    /// certainly on either side of that.
    fn parts(&self, ramp: &SolidRamp, joints: [DVec3; 2], lattice: &Lattice) -> Outline {
        let reach = ramp.reach * (1.0 + REACH_MARGIN);
        let sin = reach / self.distance;
        let bend = sin * sin / (1.0 - sin * sin);
        let (start, end) = (self.foot, self.foot + self.length);
        let beyond = |s: f64, bend: f64| self.direction * self.distance - self.w * (s + bend);
        let [low, high] = self.edges(ramp.reach);
        let axis = Bounds::new(
            [low, high, -beyond(start, start.min(0.0) * bend), beyond(end, end.max(0.0) * bend)],
            RowRule::Any,
            lattice,
        );
        let core = ramp.darkness().map(|darkness| {
            let [low, high] = self.edges(darkness * (1.0 - 1e3 * REACH_MARGIN));
            let ends = [-beyond(start, start.max(0.0) * bend), beyond(end, end.min(0.0) * bend)];
            Bounds::new([low, high, ends[0], ends[1]], RowRule::All, lattice)
        });
        let cuts = [beyond(start, start.max(0.0) * bend), -beyond(end, end.min(0.0) * bend)];
        let balls = [0, 1].map(|end| BallOutline::new(joints[end], reach, Some(cuts[end]), lattice));
        Outline::Parts { axis, core, balls }
    }
}

/// How wrong f32 may be about λ/255 on the ramp of a solid: the ray's place and the joint's are rounded.
fn error(ramp: &SolidRamp, p0: DVec3, p1: DVec3) -> f32 {
    let rounding = 0.5 * f64::from(f32::EPSILON);
    let aside = |p: DVec3| p.x.abs().max(p.y.abs()).max(0.5 * p.z) + ramp.reach;
    let distance = ROUNDINGS * rounding * aside(p0).max(aside(p1));
    let (steepness, offset) = match ramp.form {
        RampForm::Quadratic { alpha, beta, .. } => (2.0 * alpha * ramp.reach, beta),
        RampForm::Linear { start, width, .. } => (1.0 / width, start / width),
    };
    (steepness * distance + ROUNDINGS * rounding * offset.abs().max(1.0)) as f32
}

impl LaneJoint {
    fn new(p: DVec3, axis: DVec3) -> Self {
        let unit = p / p.z;
        Self { x: unit.x as f32, y: unit.y as f32, z: p.z as f32, axis_along: axis.dot(unit) as f32 }
    }
}

impl LaneRamp {
    fn new(form: RampForm, depth: f64) -> Self {
        let (slope, offset, is_linear) = form.line();
        let by_measure = form.depth_line();
        let (unit, distance, factor, by_depth) = match form {
            RampForm::Quadratic { alpha, beta, .. } => {
                // m = (λ/255 − β)/α
                let by_level = |(constant, by_measure): (f32, f32)| {
                    let slope = f64::from(by_measure) / alpha;
                    [(f64::from(constant) - slope * beta) as f32, slope as f32]
                };
                (depth * depth, [0.0; 2], -2.0 * BACKGROUND * alpha, by_measure.map(by_level))
            }
            RampForm::Linear { start, width, .. } => {
                (depth, [start as f32, width as f32], -BACKGROUND / width, by_measure.map(<[f32; 2]>::from))
            }
        };
        Self { slope: (f64::from(slope) * unit) as f32, offset, is_linear, by_depth, distance, factor }
    }
}
