//! Winners: which solid is darkest in each pixel, and where along its axis the ray is nearest.

use pulp::Simd;

use super::solid::{GridBox, Joint, LaneSolid, Shape};

/// f32 of this size have no digits after the point: adding and taking it away rounds to a whole number.
const ROUNDER: f32 = 12_582_912.0;
/// The owner where no solid is near; set only where doubts are asked for.
pub(super) const NO_SOLID: u32 = u32::MAX;
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

/// A band of rows: what is known of its pixels. Rows × pitch each.
#[derive(Debug, Clone, Default)]
pub(super) struct Band {
    /// λ/255 before clipping.
    pub levels: Vec<f32>,
    /// Index of the darkest solid.
    pub owners: Vec<u32>,
    /// t of its point nearest to the ray, or the mark of a flat cap.
    pub fractions: Vec<f32>,
    /// 1/|e|².
    pub inverse_norms: Vec<f32>,
    /// λ/255 of the darkest of the others, background and solids, before clipping; minus infinity where that of
    /// some solid cannot be trusted. Only where doubts are asked for.
    pub runners_up: Vec<f32>,
}

impl Band {
    pub(super) fn resize(&mut self, pixels: usize) {
        if self.levels.len() < pixels {
            self.levels.resize(pixels, 1.0);
            self.owners.resize(pixels, 0);
            self.fractions.resize(pixels, 0.0);
            self.inverse_norms.resize(pixels, 1.0);
        }
    }

    /// The same with room for doubts.
    pub(super) fn resize_with_doubts(&mut self, pixels: usize) {
        self.resize(pixels);
        if self.runners_up.len() < pixels {
            self.runners_up.resize(pixels, f32::INFINITY);
        }
    }

    /// Empties the columns of a row, and those after them that lanes may reach.
    #[inline(always)]
    pub(super) fn open_row<S: Simd, const DOUBTS: bool>(&mut self, simd: S, row: &Row<'_>) {
        let &Row { start, y, xs, span: [from, to], .. } = row;
        let (from, to) = (from as usize, (to as usize + S::F32_LANES).min(xs.len()));
        self.levels[start + from..start + to].fill(1.0);
        if DOUBTS {
            self.owners[start + from..start + to].fill(NO_SOLID);
            self.runners_up[start + from..start + to].fill(f32::INFINITY);
        }
        let (head, tail) = S::as_simd_f32s(&xs[from..to]);
        let (norms, norms_tail) = S::as_mut_simd_f32s(&mut self.inverse_norms[start + from..start + to]);
        let base = 1.0 + y * y;
        for (norm, &x) in norms.iter_mut().zip(head) {
            *norm = simd.div_f32s(simd.splat_f32s(1.0), simd.mul_add_e_f32s(x, x, simd.splat_f32s(base)));
        }
        for (norm, x) in norms_tail.iter_mut().zip(tail) {
            *norm = 1.0 / (x * x + base);
        }
    }

    /// Lets a solid win the pixels of one row's span in which it is darker than those before it.
    #[inline(always)]
    pub(super) fn challenge<S: Simd, const DOUBTS: bool>(
        &mut self,
        simd: S,
        solid: &LaneSolid,
        index: usize,
        row: &Row<'_>,
    ) {
        let span = row.columns::<S>();
        let (xs, _) = S::as_simd_f32s(&row.xs[span.clone()]);
        let here = row.start + span.start..row.start + span.end;
        let (norms, _) = S::as_simd_f32s(&self.inverse_norms[here.clone()]);
        let (levels, _) = S::as_mut_simd_f32s(&mut self.levels[here.clone()]);
        let (owners, _) = S::as_mut_simd_u32s(&mut self.owners[here.clone()]);
        let (fractions, _) = S::as_mut_simd_f32s(&mut self.fractions[here.clone()]);
        let (runners_up, _) = S::as_mut_simd_f32s(if DOUBTS { &mut self.runners_up[here] } else { &mut [] });
        let line = AxisRow::new(solid, row.y);
        let owner = simd.splat_u32s(index as u32);
        let (slope, offset) = (simd.splat_f32s(solid.ramp.slope), simd.splat_f32s(solid.ramp.offset));
        for i in 0..xs.len() {
            let nearest = match solid.shape {
                Shape::Capsule => line.capsule(simd, xs[i]),
                Shape::Spheres { gaps } => line.spheres(simd, xs[i], gaps),
                Shape::Cylinder { caps } => {
                    let columns = span.start + i * S::F32_LANES..span.start + (i + 1) * S::F32_LANES;
                    let axis = line.cylinder_axis(simd, xs[i], norms[i]);
                    let is_met = caps.map(|cap| cap.meets(&columns, row.row));
                    with_caps(simd, axis, solid, is_met, (xs[i], row.y))
                }
            };
            let squared = match solid.shape {
                Shape::Cylinder { .. } => nearest.squared,
                _ => simd.mul_f32s(nearest.squared, norms[i]),
            };
            let measure = if solid.ramp.is_linear { simd.sqrt_f32s(squared) } else { squared };
            let level = simd.mul_add_e_f32s(slope, measure, offset);
            let darker = simd.less_than_f32s(level, levels[i]);
            if DOUBTS {
                let runner_up = simd.min_f32s(runners_up[i], simd.max_f32s(level, levels[i]));
                let hopeless = simd.splat_f32s(f32::NEG_INFINITY);
                runners_up[i] = match nearest.doubtful {
                    Some(doubtful) => simd.select_f32s(doubtful, hopeless, runner_up),
                    None => runner_up,
                };
            }
            levels[i] = simd.min_f32s(level, levels[i]);
            owners[i] = simd.select_u32s(darker, owner, owners[i]);
            fractions[i] = simd.select_f32s(darker, nearest.fraction, fractions[i]);
        }
    }
}

/// One row of a band, and the columns of it that a solid may touch.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    /// Row of the grid.
    pub row: usize,
    /// Its first entry in the band.
    pub start: usize,
    /// Its place on the plane z = 1.
    pub y: f32,
    /// Places of the columns on the plane z = 1.
    pub xs: &'a [f32],
    pub span: [u32; 2],
}

impl Row<'_> {
    #[inline(always)]
    pub(super) fn is_touched(&self) -> bool {
        self.span[0] < self.span[1]
    }

    /// The span's columns, up to whole lanes.
    #[inline(always)]
    pub(super) fn columns<S: Simd>(&self) -> std::ops::Range<usize> {
        let [from, to] = self.span;
        let chunks = ((to - from) as usize).div_ceil(S::F32_LANES);
        from as usize..from as usize + chunks * S::F32_LANES
    }
}

impl GridBox {
    #[inline(always)]
    pub(super) fn meets(&self, columns: &std::ops::Range<usize>, row: usize) -> bool {
        (self.rows[0]..self.rows[1]).contains(&row)
            && columns.start < self.columns[1]
            && columns.end > self.columns[0]
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
    (x, y): (S::f32s, f32),
) -> Nearest<S> {
    for (joint, mark, is_met) in [(&solid.start, START_CAP, is_met[0]), (&solid.end, END_CAP, is_met[1])] {
        if is_met {
            let hit = FlatHit::new(simd, solid, joint, x, y);
            let squared = hit.squared(simd, joint.z / solid.start.z);
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

/// What does not change along a row of a solid's axis.
///
/// With δ = e − ê₀ = (dx, dy, 0): e × axis = cross + δ × axis, e × ê₀ = δ × ê₀.
struct AxisRow {
    joint_x: f32,
    joint_y: f32,
    dy: f32,
    cross: [f32; 3],
    axis_y: f32,
    axis_z: f32,
    joint_cross_z: f32,
    cross_x_squared: f32,
    dot: f32,
}

/// e × axis and δ × ê₀ of lanes of pixels on a row.
struct Crosses<S: Simd> {
    axis_y: S::f32s,
    axis_z: S::f32s,
    /// −dx
    joint_y: S::f32s,
    joint_z: S::f32s,
    /// t before it is clamped.
    fraction: S::f32s,
    /// |e × axis|²
    length: S::f32s,
}

impl AxisRow {
    #[inline(always)]
    fn new(solid: &LaneSolid, y: f32) -> Self {
        let dy = y - solid.start.y;
        let cross_x = solid.cross.x + dy * solid.axis.z;
        Self {
            joint_x: solid.start.x,
            joint_y: solid.start.y,
            dy,
            cross: [cross_x, solid.cross.y, solid.cross.z - dy * solid.axis.x],
            axis_y: solid.axis.y,
            axis_z: solid.axis.z,
            joint_cross_z: -solid.start.x * dy,
            cross_x_squared: cross_x * cross_x,
            dot: cross_x * dy,
        }
    }

    #[inline(always)]
    fn crosses<S: Simd>(&self, simd: S, x: S::f32s) -> Crosses<S> {
        let splat = |value: f32| simd.splat_f32s(value);
        let dx = simd.sub_f32s(x, splat(self.joint_x));
        let axis_y = simd.negate_mul_add_e_f32s(splat(self.axis_z), dx, splat(self.cross[1]));
        let axis_z = simd.mul_add_e_f32s(splat(self.axis_y), dx, splat(self.cross[2]));
        let joint_y = simd.neg_f32s(dx);
        let joint_z = simd.mul_add_e_f32s(splat(self.joint_y), dx, splat(self.joint_cross_z));
        let length = simd.mul_add_e_f32s(axis_y, axis_y, splat(self.cross_x_squared));
        let length = simd.mul_add_e_f32s(axis_z, axis_z, length);
        let dot = simd.mul_add_e_f32s(axis_y, joint_y, splat(self.dot));
        let dot = simd.mul_add_e_f32s(axis_z, joint_z, dot);
        // A ray along the axis has no t of its own: any will do.
        let length = simd.max_f32s(length, splat(f32::MIN_POSITIVE));
        let fraction = simd.div_f32s(simd.neg_f32s(dot), length);
        Crosses { axis_y, axis_z, joint_y, joint_z, fraction, length }
    }

    /// |e × ê₀ + t e × axis|²
    #[inline(always)]
    fn squared<S: Simd>(&self, simd: S, crosses: &Crosses<S>, fraction: S::f32s) -> S::f32s {
        let x = simd.mul_add_e_f32s(fraction, simd.splat_f32s(self.cross[0]), simd.splat_f32s(self.dy));
        let y = simd.mul_add_e_f32s(fraction, crosses.axis_y, crosses.joint_y);
        let z = simd.mul_add_e_f32s(fraction, crosses.axis_z, crosses.joint_z);
        simd.mul_add_e_f32s(z, z, simd.mul_add_e_f32s(y, y, simd.mul_f32s(x, x)))
    }

    #[inline(always)]
    fn capsule<S: Simd>(&self, simd: S, x: S::f32s) -> Nearest<S> {
        let crosses = self.crosses(simd, x);
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let fraction = simd.min_f32s(simd.max_f32s(crosses.fraction, zero), one);
        Nearest { fraction, squared: self.squared(simd, &crosses, fraction), doubtful: None }
    }

    #[inline(always)]
    fn spheres<S: Simd>(&self, simd: S, x: S::f32s, gap_count: f32) -> Nearest<S> {
        let crosses = self.crosses(simd, x);
        let (zero, one, rounder) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0), simd.splat_f32s(ROUNDER));
        let fraction = simd.min_f32s(simd.max_f32s(crosses.fraction, zero), one);
        let gaps = simd.splat_f32s(gap_count);
        let whole = simd.sub_f32s(simd.mul_add_e_f32s(fraction, gaps, rounder), rounder);
        let off = simd.abs_f32s(simd.negate_mul_add_e_f32s(fraction, gaps, whole));
        let doubtful = simd.less_than_f32s(simd.splat_f32s(0.5 - DOUBTFUL_GAP), off);
        let fraction = simd.mul_f32s(whole, simd.splat_f32s(1.0 / gap_count));
        let squared = self.squared(simd, &crosses, fraction);
        Nearest { fraction, squared, doubtful: Some(doubtful) }
    }

    /// The axis between the joints; infinitely far beyond them.
    #[inline(always)]
    fn cylinder_axis<S: Simd>(&self, simd: S, x: S::f32s, inverse_norm: S::f32s) -> Nearest<S> {
        let crosses = self.crosses(simd, x);
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let fraction = crosses.fraction;
        let between = simd.and_m32s(
            simd.less_than_or_equal_f32s(zero, fraction),
            simd.less_than_or_equal_f32s(fraction, one),
        );
        let squared = simd.mul_f32s(self.squared(simd, &crosses, fraction), inverse_norm);
        let is_near = |joint: f32| {
            let off = simd.abs_f32s(simd.sub_f32s(fraction, simd.splat_f32s(joint)));
            simd.less_than_f32s(off, simd.splat_f32s(DOUBTFUL_FRACTION))
        };
        let is_along = simd.less_than_f32s(crosses.length, simd.splat_f32s(DOUBTFUL_LENGTH));
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
    pub(super) fn new(simd: S, solid: &LaneSolid, joint: &Joint, x: S::f32s, y: f32) -> Self {
        let splat = |value: f32| simd.splat_f32s(value);
        let dx = simd.sub_f32s(x, splat(joint.x));
        let dy = y - joint.y;
        let offset = simd.mul_add_e_f32s(splat(solid.axis.x), dx, splat(solid.axis.y * dy));
        let along = simd.add_f32s(offset, splat(joint.axis_along));
        let ratio = simd.div_f32s(offset, along);
        let h = [
            simd.negate_mul_add_e_f32s(ratio, x, dx),
            simd.negate_mul_add_e_f32s(ratio, splat(y), splat(dy)),
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
