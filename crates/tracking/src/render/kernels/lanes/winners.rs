//! Winners: which solid is darkest in each pixel, and where along its axis the ray is nearest.

use std::ops::Range;

use pulp::Simd;

use super::band::{Band, Cells, Places};
use super::grid::PixelGrid;
use super::ground::{Ground, SolidPart};
use super::masks::put_f32s;
use super::solid::{AxisSight, LaneJoint, LaneSolid, Shape};
use crate::render::primitive::PixelBox;

/// f32 of this size have no digits after the point: adding and taking it away rounds to a whole number.
const ROUNDER: f32 = 12_582_912.0;
/// The fraction that stands for a cylinder's flat cap at p0.
pub(super) const START_CAP: f32 = -1.0;
/// The fraction that stands for a cylinder's flat cap at p1.
pub(super) const END_CAP: f32 = 2.0;

/// A cylinder's t this near to its joints is in doubt: beyond them the axis is not seen at all.
const DOUBTFUL_FRACTION: f32 = 1e-3;
/// And all t are where the ray runs this nearly along the axis: |e × axis|².
const DOUBTFUL_LENGTH: f32 = 1e-6;
/// A flat cap whose plane the ray meets at less than this is in doubt: the sine of the angle.
const DOUBTFUL_EDGE: f32 = 0.2;
/// Which of equal spheres is nearest is in doubt where t is this near to the middle between two, in gaps.
const DOUBTFUL_GAP: f32 = 1e-3;

impl Ground {
    /// Ground and winners of one band of tile rows; with `DOUBTS`, also by how much they have won.
    #[inline(always)]
    pub(super) fn win_band<S: Simd, const DOUBTS: bool>(
        &self,
        simd: S,
        band: &mut Band,
        rows: &Range<usize>,
        grid: &PixelGrid,
    ) {
        band.open::<DOUBTS>(self, rows, grid);
        band.list(self, rows, grid);
        let places = Places::<S>::new(self, rows, grid);
        let Band { levels, owners, fractions, runners_up, tiles, works, .. } = band;
        // As long as each other, so that one is in bounds where the other is.
        let pixels = levels.len();
        let mut cells = Cells::<S, DOUBTS> {
            levels: S::as_mut_simd_f32s(levels).0,
            owners: S::as_mut_simd_u32s(&mut owners[..pixels]).0,
            runners_up: S::as_mut_simd_f32s(runners_up).0,
        };
        let fractions = S::as_mut_simd_f32s(fractions).0;
        for work in works {
            let solid = &self.solids[work.solid];
            let (owner, tiles) = (simd.splat_u32s(work.owner), &tiles[work.tiles.clone()]);
            let offset = simd.splat_f32s(solid.ramp.offset);
            let challenge = Challenge { simd, solid, part: work.part, offset, owner, tiles, places };
            if solid.ramp.is_linear {
                challenge.all::<DOUBTS, true>(&mut cells, fractions, (rows.start, grid));
            } else {
                challenge.all::<DOUBTS, false>(&mut cells, fractions, (rows.start, grid));
            }
        }
    }
}

/// What an axis's formulas want of it, in all lanes.
#[derive(Clone, Copy)]
pub(super) struct AxisLanes<S: Simd> {
    joint: [S::f32s; 2],
    v: [S::f32s; 2],
    w: [S::f32s; 3],
    along: [S::f32s; 2],
    foot: S::f32s,
}

/// A solid's axis as its rays see it: with A = e·v and B = e·w, sin² = A²/(A² + B²) of the angle to the axis's plane.
pub(super) struct AxisRays<S: Simd> {
    pub a: S::f32s,
    pub b: S::f32s,
    /// A².
    pub square: S::f32s,
    /// A² + B².
    pub length: S::f32s,
    /// t (A² + B²).
    pub along: S::f32s,
}

impl<S: Simd> AxisLanes<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, solid: &LaneSolid, sight: &AxisSight) -> Self {
        let splat = |value: f32| simd.splat_f32s(value);
        Self {
            joint: [splat(solid.joints[0].x), splat(solid.joints[0].y)],
            v: [splat(sight.v[0]), splat(sight.v[1])],
            w: [splat(sight.w[0]), splat(sight.w[1]), splat(sight.w[2])],
            along: [splat(sight.along[0]), splat(sight.along[1])],
            foot: splat(sight.foot),
        }
    }

    #[inline(always)]
    pub(super) fn see(&self, simd: S, [x, y]: [S::f32s; 2]) -> AxisRays<S> {
        let dx = simd.sub_f32s(x, self.joint[0]);
        let dy = simd.sub_f32s(y, self.joint[1]);
        let a = simd.mul_add_e_f32s(self.v[0], dx, simd.mul_f32s(self.v[1], dy));
        let b = simd.mul_add_e_f32s(self.w[0], dx, simd.mul_add_e_f32s(self.w[1], dy, self.w[2]));
        let along = simd.mul_add_e_f32s(self.along[0], dx, simd.mul_f32s(self.along[1], dy));
        let square = simd.mul_f32s(a, a);
        let length = simd.mul_add_e_f32s(b, b, square);
        let along = simd.negate_mul_add_e_f32s(self.foot, square, simd.mul_f32s(b, along));
        AxisRays { a, b, square, length, along }
    }
}

/// A part of a solid that competes for the pixels of some tiles.
struct Challenge<'a, S: Simd> {
    simd: S,
    solid: &'a LaneSolid,
    part: SolidPart,
    /// Of its ramp.
    offset: S::f32s,
    owner: S::u32s,
    tiles: &'a [u32],
    places: Places<'a, S>,
}

impl<S: Simd> Challenge<'_, S> {
    /// For all of its tiles, in a band of a grid that begins at a tile row.
    #[inline(always)]
    fn all<const DOUBTS: bool, const LINEAR: bool>(
        &self,
        cells: &mut Cells<'_, S, DOUBTS>,
        fractions: &mut [S::f32s],
        (first_row, grid): (usize, &PixelGrid),
    ) {
        match (self.part, &self.solid.sight) {
            (SolidPart::Axis, Some(sight)) => self.axis::<DOUBTS, LINEAR>(sight, cells),
            (SolidPart::Ball(end), _) => self.ball::<DOUBTS, LINEAR>(end, cells),
            (SolidPart::Whole, Some(sight)) if self.solid.shape == Shape::Capsule => {
                self.capsule::<DOUBTS, LINEAR>(sight, cells, fractions);
            }
            _ => {
                for &tile in self.tiles {
                    let (at, rays) = self.places.at(tile);
                    let tile = [(tile >> 16) as usize + first_row, (tile & 0xffff) as usize];
                    let here = (at, rays, grid.covers(tile));
                    self.whole::<DOUBTS, LINEAR>(self.solid, here, cells, fractions);
                }
            }
        }
    }

    /// λ/255 at a squared distance, before clipping.
    #[inline(always)]
    fn level<const LINEAR: bool>(&self, slope: S::f32s, squared: S::f32s) -> S::f32s {
        let measure = if LINEAR { self.simd.sqrt_f32s(squared) } else { squared };
        self.simd.mul_add_e_f32s(slope, measure, self.offset)
    }

    #[inline(always)]
    fn axis<const DOUBTS: bool, const LINEAR: bool>(
        &self,
        sight: &AxisSight,
        cells: &mut Cells<'_, S, DOUBTS>,
    ) {
        let simd = self.simd;
        let axis = AxisLanes::new(simd, self.solid, sight);
        let slope = simd.splat_f32s(sight.slope);
        let (zero, beyond) = (simd.splat_f32s(0.0), simd.splat_f32s(f32::INFINITY));
        for &tile in self.tiles {
            let (at, rays) = self.places.at(tile);
            let rays = axis.see(simd, rays);
            let between = simd.and_m32s(
                simd.less_than_or_equal_f32s(zero, rays.along),
                simd.less_than_or_equal_f32s(rays.along, rays.length),
            );
            let level = self.level::<LINEAR>(slope, simd.div_f32s(rays.square, rays.length));
            cells.offer(simd, at, simd.select_f32s(between, level, beyond), self.owner);
        }
    }

    /// A ball about a joint p = z ê: with δ = e − ê, d² = z² |δ × ê|²/|e|².
    #[inline(always)]
    fn ball<const DOUBTS: bool, const LINEAR: bool>(&self, end: usize, cells: &mut Cells<'_, S, DOUBTS>) {
        let simd = self.simd;
        let joint = &self.solid.joints[end];
        let depths = joint.z / self.solid.joints[0].z;
        let slope = self.solid.ramp.slope * if LINEAR { depths } else { depths * depths };
        let [slope, joint_x, joint_y, one] =
            [slope, joint.x, joint.y, 1.0].map(|value| simd.splat_f32s(value));
        for &tile in self.tiles {
            let (at, [x, y]) = self.places.at(tile);
            let (dx, dy) = (simd.sub_f32s(x, joint_x), simd.sub_f32s(y, joint_y));
            let turn = simd.negate_mul_add_e_f32s(dy, joint_x, simd.mul_f32s(dx, joint_y));
            let square = simd.mul_add_e_f32s(turn, turn, simd.mul_add_e_f32s(dx, dx, simd.mul_f32s(dy, dy)));
            let norm = simd.mul_add_e_f32s(x, x, simd.mul_add_e_f32s(y, y, one));
            let level = self.level::<LINEAR>(slope, simd.div_f32s(square, norm));
            cells.offer(simd, at, level, self.owner);
        }
    }

    /// A capsule that is looked at as a whole: with t* of the infinite axis's point nearest to the ray, and t that clamped
    /// to 0 … 1, d² = D² A²/(A² + B²) + (t − t*)² |a|² (A² + B²)/|e|².
    #[inline(always)]
    fn capsule<const DOUBTS: bool, const LINEAR: bool>(
        &self,
        sight: &AxisSight,
        cells: &mut Cells<'_, S, DOUBTS>,
        fractions: &mut [S::f32s],
    ) {
        let simd = self.simd;
        let axis = AxisLanes::new(simd, self.solid, sight);
        let [slope, beyond, zero, one] =
            [sight.slope, sight.beyond, 0.0, 1.0].map(|value| simd.splat_f32s(value));
        for &tile in self.tiles {
            let (at, [x, y]) = self.places.at(tile);
            let rays = axis.see(simd, [x, y]);
            // A ray along the axis has no t of its own: any will do.
            let inverse = simd.div_f32s(one, simd.max_f32s(rays.length, simd.splat_f32s(f32::MIN_POSITIVE)));
            let unclamped = simd.mul_f32s(rays.along, inverse);
            let fraction = simd.min_f32s(simd.max_f32s(unclamped, zero), one);
            let past = simd.sub_f32s(unclamped, fraction);
            let norm = simd.mul_add_e_f32s(x, x, simd.mul_add_e_f32s(y, y, one));
            let end = simd.div_f32s(simd.mul_f32s(beyond, simd.mul_f32s(past, rays.length)), norm);
            let ratio = simd.mul_add_e_f32s(past, end, simd.mul_f32s(rays.square, inverse));
            let darker = cells.offer(simd, at, self.level::<LINEAR>(slope, ratio), self.owner);
            put_f32s(simd, &mut fractions[at], darker, fraction);
        }
    }

    /// A solid that is looked at as a whole, in one tile that covers a box. As an argument it is known to be apart from the
    /// cells, so that its constants stay in registers.
    #[inline(always)]
    fn whole<const DOUBTS: bool, const LINEAR: bool>(
        &self,
        solid: &LaneSolid,
        (at, [x, y], tile): (usize, [S::f32s; 2], PixelBox),
        cells: &mut Cells<'_, S, DOUBTS>,
        fractions: &mut [S::f32s],
    ) {
        let Self { simd, owner, .. } = *self;
        let norm = simd.mul_add_e_f32s(x, x, simd.mul_add_e_f32s(y, y, simd.splat_f32s(1.0)));
        let inverse_norm = simd.div_f32s(simd.splat_f32s(1.0), norm);
        let line = AxisPixels::new(simd, solid, [x, y]);
        let nearest = match solid.shape {
            Shape::Capsule => line.capsule(simd),
            Shape::Spheres { gaps } => line.spheres(simd, gaps),
            Shape::Cylinder { caps } => {
                let axis = line.cylinder_axis(simd, inverse_norm);
                with_caps(simd, axis, solid, caps.map(|cap| cap.meets(&tile)), [x, y])
            }
        };
        let squared = match solid.shape {
            Shape::Cylinder { .. } => nearest.squared,
            _ => simd.mul_f32s(nearest.squared, inverse_norm),
        };
        let level = self.level::<LINEAR>(simd.splat_f32s(solid.ramp.slope), squared);
        let darker = cells.offer(simd, at, level, owner);
        if DOUBTS && let Some(doubtful) = nearest.doubtful {
            let hopeless = simd.splat_f32s(f32::NEG_INFINITY);
            put_f32s(simd, &mut cells.runners_up[at], doubtful, hopeless);
        }
        put_f32s(simd, &mut fractions[at], darker, nearest.fraction);
    }
}

impl PixelBox {
    #[inline(always)]
    fn meets(&self, other: &Self) -> bool {
        let meet = |a: [usize; 2], b: [usize; 2]| a[0] < b[1] && b[0] < a[1];
        meet(self.rows, other.rows) && meet(self.columns, other.columns)
    }
}

/// Where a ray is nearest to a solid. Squared distances are in units of the first joint's depth; those of
/// [`AxisRow::capsule`] and [`AxisRow::spheres`] still want 1/|e|².
struct Nearest<S: Simd> {
    fraction: S::f32s,
    squared: S::f32s,
    /// Where rounding decides what of the solid is nearest; none where it never does.
    doubtful: Option<S::m32s>,
}

/// The nearest of a cylinder's axis and those of its flat caps that are met.
#[inline(always)]
fn with_caps<S: Simd>(
    simd: S,
    mut nearest: Nearest<S>,
    solid: &LaneSolid,
    is_met: [bool; 2],
    rays: [S::f32s; 2],
) -> Nearest<S> {
    let [start, end] = &solid.joints;
    for (joint, mark, is_met) in [(start, START_CAP, is_met[0]), (end, END_CAP, is_met[1])] {
        if is_met {
            let hit = FlatHit::new(simd, solid, joint, rays);
            let squared = hit.squared(simd, joint.z / solid.joints[0].z);
            let closer = simd.less_than_f32s(squared, nearest.squared);
            nearest.squared = simd.select_f32s(closer, squared, nearest.squared);
            nearest.fraction = simd.select_f32s(closer, simd.splat_f32s(mark), nearest.fraction);
            let edge = simd.splat_f32s(DOUBTFUL_EDGE * solid.axis.length());
            let is_edge_on = simd.and_m32s(
                simd.less_than_f32s(simd.abs_f32s(hit.along), edge),
                simd.less_than_f32s(squared, simd.splat_f32s(solid.cap_reach)),
            );
            nearest.doubtful = nearest.doubtful.map(|doubtful| simd.or_m32s(doubtful, is_edge_on));
        }
    }
    nearest
}

/// A solid's axis as lanes of rays see it.
///
/// With δ = e − ê₀ = (dx, dy, 0): e × axis = cross + δ × axis, e × ê₀ = δ × ê₀.
struct AxisPixels<S: Simd> {
    /// e × axis.
    with_axis: [S::f32s; 3],
    /// e × ê₀.
    with_joint: [S::f32s; 3],
    /// t before it is clamped.
    fraction: S::f32s,
    /// |e × axis|².
    length: S::f32s,
}

impl<S: Simd> AxisPixels<S> {
    #[inline(always)]
    fn new(simd: S, solid: &LaneSolid, [x, y]: [S::f32s; 2]) -> Self {
        let splat = |value: f32| simd.splat_f32s(value);
        let LaneSolid { joints: [start, _], axis, cross, .. } = solid;
        let dx = simd.sub_f32s(x, splat(start.x));
        let dy = simd.sub_f32s(y, splat(start.y));
        let with_axis = [
            simd.mul_add_e_f32s(splat(axis.z), dy, splat(cross.x)),
            simd.negate_mul_add_e_f32s(splat(axis.z), dx, splat(cross.y)),
            simd.mul_add_e_f32s(
                splat(axis.y),
                dx,
                simd.negate_mul_add_e_f32s(splat(axis.x), dy, splat(cross.z)),
            ),
        ];
        let with_joint = [
            dy,
            simd.neg_f32s(dx),
            simd.negate_mul_add_e_f32s(splat(start.x), dy, simd.mul_f32s(splat(start.y), dx)),
        ];
        let dot = |a: [S::f32s; 3], b: [S::f32s; 3]| {
            let sum = simd.mul_add_e_f32s(a[1], b[1], simd.mul_f32s(a[0], b[0]));
            simd.mul_add_e_f32s(a[2], b[2], sum)
        };
        // A ray along the axis has no t of its own: any will do.
        let length = simd.max_f32s(dot(with_axis, with_axis), splat(f32::MIN_POSITIVE));
        let fraction = simd.div_f32s(simd.neg_f32s(dot(with_axis, with_joint)), length);
        Self { with_axis, with_joint, fraction, length }
    }

    /// |e × ê₀ + t e × axis|²
    #[inline(always)]
    fn squared(&self, simd: S, fraction: S::f32s) -> S::f32s {
        let along = |axis: usize| simd.mul_add_e_f32s(fraction, self.with_axis[axis], self.with_joint[axis]);
        let [x, y, z] = [along(0), along(1), along(2)];
        simd.mul_add_e_f32s(z, z, simd.mul_add_e_f32s(y, y, simd.mul_f32s(x, x)))
    }

    #[inline(always)]
    fn capsule(&self, simd: S) -> Nearest<S> {
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let fraction = simd.min_f32s(simd.max_f32s(self.fraction, zero), one);
        Nearest { fraction, squared: self.squared(simd, fraction), doubtful: None }
    }

    #[inline(always)]
    fn spheres(&self, simd: S, gap_count: f32) -> Nearest<S> {
        let (zero, one, rounder) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0), simd.splat_f32s(ROUNDER));
        let fraction = simd.min_f32s(simd.max_f32s(self.fraction, zero), one);
        let gaps = simd.splat_f32s(gap_count);
        let whole = simd.sub_f32s(simd.mul_add_e_f32s(fraction, gaps, rounder), rounder);
        let off = simd.abs_f32s(simd.negate_mul_add_e_f32s(fraction, gaps, whole));
        let doubtful = simd.less_than_f32s(simd.splat_f32s(0.5 - DOUBTFUL_GAP), off);
        let fraction = simd.mul_f32s(whole, simd.splat_f32s(1.0 / gap_count));
        let squared = self.squared(simd, fraction);
        Nearest { fraction, squared, doubtful: Some(doubtful) }
    }

    /// The axis between the joints; infinitely far beyond them.
    #[inline(always)]
    fn cylinder_axis(&self, simd: S, inverse_norm: S::f32s) -> Nearest<S> {
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let fraction = self.fraction;
        let between = simd.and_m32s(
            simd.less_than_or_equal_f32s(zero, fraction),
            simd.less_than_or_equal_f32s(fraction, one),
        );
        let squared = simd.mul_f32s(self.squared(simd, fraction), inverse_norm);
        let is_near = |joint: f32| {
            let off = simd.abs_f32s(simd.sub_f32s(fraction, simd.splat_f32s(joint)));
            simd.less_than_f32s(off, simd.splat_f32s(DOUBTFUL_FRACTION))
        };
        let is_along = simd.less_than_f32s(self.length, simd.splat_f32s(DOUBTFUL_LENGTH));
        let doubtful = simd.or_m32s(is_along, simd.or_m32s(is_near(0.0), is_near(1.0)));
        let squared = simd.select_f32s(between, squared, simd.splat_f32s(f32::INFINITY));
        Nearest { fraction, squared, doubtful: Some(doubtful) }
    }
}

/// Where lanes of rays meet the plane of a flat cap.
///
/// With ρ = (axis·δ)/(axis·e) about the cap's joint p = z ê: h = z (δ − ρ e), exact near the joint.
pub(super) struct FlatHit<S: Simd> {
    /// δ − ρ e
    pub h: [S::f32s; 3],
    /// axis · e
    pub along: S::f32s,
    in_front: S::m32s,
}

impl<S: Simd> FlatHit<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, solid: &LaneSolid, joint: &LaneJoint, [x, y]: [S::f32s; 2]) -> Self {
        let splat = |value: f32| simd.splat_f32s(value);
        let (dx, dy) = (simd.sub_f32s(x, splat(joint.x)), simd.sub_f32s(y, splat(joint.y)));
        let across = simd.mul_f32s(splat(solid.axis.y), dy);
        let offset = simd.mul_add_e_f32s(splat(solid.axis.x), dx, across);
        let along = simd.add_f32s(offset, splat(joint.axis_along));
        let ratio = simd.div_f32s(offset, along);
        let h = [
            simd.negate_mul_add_e_f32s(ratio, x, dx),
            simd.negate_mul_add_e_f32s(ratio, y, dy),
            simd.neg_f32s(ratio),
        ];
        Self { h, along, in_front: simd.less_than_f32s(ratio, splat(1.0)) }
    }

    /// |h|² in units of the first joint's depth, `scale` being the cap's depth in them; infinite behind the
    /// camera.
    #[inline(always)]
    fn squared(&self, simd: S, scale: f32) -> S::f32s {
        let [x, y, z] = self.h;
        let sum = simd.mul_add_e_f32s(z, z, simd.mul_add_e_f32s(y, y, simd.mul_f32s(x, x)));
        let squared = simd.mul_f32s(sum, simd.splat_f32s(scale * scale));
        simd.select_f32s(self.in_front, squared, simd.splat_f32s(f32::INFINITY))
    }
}
