//! Capsules and spheres in f32 lanes: winners, residuals and wrench sums of one camera in one go.
//!
//! Rays are e = (x, y, 1), not normalised, on the plane z = 1. With p0 = z₀ ê₀ and δ = e − ê₀:
//!
//! | quantity | on a row (y fixed) |
//! |---|---|
//! | e × a = ê₀ × a + δ × a | linear in δx |
//! | e × p0 = z₀ (δ × ê₀) | linear in δx, exact near the joint |
//! | t = clamp(−(e × p0)·(e × a) / \|e × a\|², 0, 1) | closest point of the limb |
//! | d² = \|e × p0 + t e × a\|² / \|e\|² | squared distance of the ray |
//!
//! Clamping t takes in the hemispherical ends, since all of the limb lies in front of the camera: views in
//! which it does not are left to [`scalar`](super::scalar).
//!
//! Of equal spheres evenly spread along a limb the nearest is the one whose t is nearest to the closest
//! point's, so they are a capsule with t rounded. A sphere of its own is a capsule without length.
//!
//! A ray's force on its limb acts at q = p0 + t a, so a limb's wrench block needs only Σ kkᵀ, Σ t kkᵀ,
//! Σ t² kkᵀ, Σ ρk and Σ t ρk: 24 sums, and 8 more where the ramp's width follows the depth. They are kept in
//! f32 lanes for one band of rows and flushed to f64. On a row, a limb touches the interval in which the
//! infinite cylinder around its axis is within reach, cut to the limb's pixel box.

use glam::{DVec3, Vec3};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use pulp::{Arch, Simd, WithSimd};

use crate::render::View;
use crate::render::primitive::{Primitive, Solid};
use crate::render::ramp::{BACKGROUND, RampForm};
use crate::render::wrench::WrenchBlock;

/// Rows of a grid are padded to a multiple of this many lanes.
pub const PADDING: usize = 16;
/// Pixels of a band: its winners stay in the first two caches.
const BAND_PIXELS: usize = 16 * 1024;
/// f32 of this size have no digits after the point.
const ROUNDER: f32 = 12_582_912.0;
/// Sums of one limb.
const SUMS: usize = 33;

/// Every `stride`-th pixel of a picture, packed, with its rays and data.
#[derive(Debug, Clone, Default)]
pub struct Grid {
    /// Sampled pixels across.
    pub columns: usize,
    /// Sampled pixels down.
    pub rows: usize,
    /// Entries from one row to the next; a multiple of [`PADDING`].
    pub pitch: usize,
    /// Pixels between samples.
    pub stride: usize,
    /// First sampled pixel, across and down.
    pub offset: usize,
    /// D, rows × pitch.
    pub values: Vec<f32>,
    /// Weights, rows × pitch; zero in the padding.
    pub weights: Vec<f32>,
}

/// Memory of the kernel, reused from call to call.
#[derive(Debug, Clone, Default)]
pub struct Lanes {
    xs: Vec<f32>,
    inverse_norms: Vec<f32>,
    levels: Vec<f32>,
    owners: Vec<u32>,
    capsules: Vec<Capsule>,
    spans: Vec<[u32; 2]>,
    touched: Vec<[u32; 2]>,
    totals: Vec<[f64; SUMS]>,
}

/// One limb's constants for a camera.
#[derive(Debug, Clone, Copy)]
struct Capsule {
    p0: DVec3,
    a: DVec3,
    /// From the limb's first joint, about which moments are taken, to p0.
    arm: DVec3,
    /// The limb's own axis, whose ends share the pull of the depth.
    limb_axis: DVec3,
    /// t is rounded to multiples of 1/(spheres − 1).
    spheres: Option<f32>,
    limb: usize,
    reach: f64,
    ramp: RampForm,
    /// Rows and columns of the grid that it may touch, ends excluded.
    rows: [usize; 2],
    columns: [usize; 2],
    /// Where its row spans begin in [`Lanes::spans`].
    first_span: usize,
}

impl Lanes {
    /// Whether the kernel can take a view: no cylinders, all well in front of the camera, no lens.
    #[must_use]
    pub fn can_take(view: &View) -> bool {
        view.is_pinhole()
            && view.primitives().iter().all(|primitive| {
                let near = 1.5 * primitive.ramp.reach();
                match primitive.solid {
                    Solid::Capsule { p0, p1 } => p0.z.min(p1.z) > near,
                    Solid::Spheres { p0, p1, count } => count > 1 && p0.z.min(p1.z) > near,
                    Solid::Sphere { centre, .. } => centre.z > near,
                    Solid::Cylinder { .. } => false,
                }
            })
    }

    /// Adds every limb's wrench block and returns Σ w ((D − Λ)² − (D − 255)²): what limbs change of the cost.
    ///
    /// `blocks` has one entry per limb of the model. [`can_take`](Self::can_take) must hold.
    pub fn accumulate(&mut self, view: &View, grid: &Grid, blocks: &mut [WrenchBlock]) -> f64 {
        self.prepare(view, grid);
        let cost = Arch::new().dispatch(Pass { lanes: self, grid, view });
        for (capsule, totals) in self.capsules.iter().zip(&self.totals) {
            if totals[PIXELS] > 0.0 {
                let (products, forces) = capsule.wrench_sums(totals);
                blocks[capsule.limb].add_sums(&products, &forces);
            }
        }
        cost
    }

    fn prepare(&mut self, view: &View, grid: &Grid) {
        let pinhole = view.pinhole();
        self.xs.clear();
        let plane_x = |i: usize| (((grid.offset + i * grid.stride) as f64 - pinhole.cx) / pinhole.fx) as f32;
        self.xs.extend((0..grid.pitch).map(plane_x));
        self.inverse_norms.resize(grid.pitch, 0.0);
        let band = grid.band_rows() * grid.pitch;
        if self.levels.len() != band {
            self.levels = vec![1.0; band];
            self.owners = vec![0; band];
        }
        self.capsules.clear();
        self.spans.clear();
        self.touched.clear();
        self.touched.resize(grid.rows, [u32::MAX, 0]);
        for primitive in view.primitives() {
            self.add_capsule(view, grid, primitive);
        }
        self.totals.clear();
        self.totals.resize(self.capsules.len(), [0.0; SUMS]);
    }

    fn add_capsule(&mut self, view: &View, grid: &Grid, primitive: &Primitive) {
        let (p0, p1, arm, limb_axis, spheres) = match primitive.solid {
            Solid::Capsule { p0, p1 } => (p0, p1, DVec3::ZERO, p1 - p0, None),
            Solid::Spheres { p0, p1, count } => (p0, p1, DVec3::ZERO, p1 - p0, Some((count - 1) as f32)),
            Solid::Sphere { p0, p1, centre } => (centre, centre, centre - p0, p1 - p0, None),
            Solid::Cylinder { .. } => return,
        };
        let bounds = primitive.bounds;
        let index =
            |pixel: usize, limit: usize| pixel.saturating_sub(grid.offset).div_ceil(grid.stride).min(limit);
        let rows = [index(bounds.y0, grid.rows), index(bounds.y1, grid.rows)];
        let columns = [index(bounds.x0, grid.columns), index(bounds.x1, grid.columns)];
        if rows[0] >= rows[1] || columns[0] >= columns[1] {
            return;
        }
        let capsule = Capsule {
            p0,
            a: p1 - p0,
            arm,
            limb_axis,
            spheres,
            limb: primitive.limb,
            reach: primitive.ramp.reach(),
            ramp: primitive.ramp.form(),
            rows,
            columns,
            first_span: self.spans.len(),
        };
        capsule.push_spans(view, grid, &mut self.spans, &mut self.touched);
        self.capsules.push(capsule);
    }
}

impl Grid {
    fn band_rows(&self) -> usize {
        (BAND_PIXELS / self.pitch.max(1)).clamp(8, self.rows.max(8))
    }
}

impl Capsule {
    /// For each of its rows the columns where the ray passes the axis within reach; empty spans have no end.
    ///
    /// With n = a × p0 a ray meets the axis at distance |n·e| / |e × a|, so within reach ρ lies where
    /// (n·e)² − ρ² |e × a|² < 0: a quadratic in x. A sphere is within reach where |e × p0|² − ρ² |e|² < 0.
    fn push_spans(&self, view: &View, grid: &Grid, spans: &mut Vec<[u32; 2]>, touched: &mut [[u32; 2]]) {
        let pinhole = view.pinhole();
        let (a, n) = (self.a, self.a.cross(self.p0));
        let reach = self.reach * (1.0 + 1e-6);
        let squared = reach * reach;
        let p = self.p0;
        let is_sphere = a == DVec3::ZERO;
        let q2 = if is_sphere {
            p.y * p.y + p.z * p.z - squared
        } else {
            n.x * n.x - squared * (a.y * a.y + a.z * a.z)
        };
        let to_column = |x: f64| (x * pinhole.fx + pinhole.cx - grid.offset as f64) / grid.stride as f64;
        for (row, touched) in (self.rows[0]..).zip(&mut touched[self.rows[0]..self.rows[1]]) {
            let y = ((grid.offset + row * grid.stride) as f64 - pinhole.cy) / pinhole.fy;
            let mut span = [self.columns[0] as u32, self.columns[1] as u32];
            // e × a = (y az − ay, ax − x az, x ay − y ax)
            let cross = |v: DVec3| (y * v.z - v.y, v.x, -y * v.x);
            let (q1, q0) = if is_sphere {
                let (cx, cy, cz) = cross(p);
                (p.y * cz - p.z * cy, cx * cx + cy * cy + cz * cz - squared * (1.0 + y * y))
            } else {
                let (cx, cy, cz) = cross(a);
                let n0 = n.y * y + n.z;
                (
                    n.x * n0 - squared * (a.y * cz - a.z * cy),
                    n0 * n0 - squared * (cx * cx + cy * cy + cz * cz),
                )
            };
            if q2 > 0.0 {
                let discriminant = q1 * q1 - q2 * q0;
                if discriminant <= 0.0 {
                    spans.push([0, 0]);
                    continue;
                }
                let root = discriminant.sqrt();
                // Cut to whole columns: at most one too many on the left, and casts never leave the range.
                let low = to_column((-q1 - root) / q2).max(f64::from(span[0]));
                let high = (to_column((-q1 + root) / q2) + 1.0).min(f64::from(span[1]));
                if low >= high {
                    spans.push([0, 0]);
                    continue;
                }
                span = [low as u32, high as u32];
            }
            *touched = [touched[0].min(span[0]), touched[1].max(span[1])];
            spans.push(span);
        }
    }

    /// M = Σ w h hᵀ and m = Σ w h ρ from the sums, camera axes, about the limb's first joint.
    fn wrench_sums(&self, s: &[f64; SUMS]) -> (SMatrix<f64, 7, 7>, SVector<f64, 7>) {
        // A ramp's factor: k = factor · δ, or already in the sums for linear ramps.
        let factor = match self.ramp {
            RampForm::Quadratic { alpha, .. } => -2.0 * BACKGROUND * alpha,
            RampForm::Linear { width, .. } => -BACKGROUND / width,
        };
        let square = factor * factor;
        let symmetric = |i: usize| {
            let s = &s[i..i + 6];
            Matrix3::new(s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]) * square
        };
        let vector = |i: usize| Vector3::new(s[i], s[i + 1], s[i + 2]) * factor;
        let (kk, tkk, ttkk) = (symmetric(0), symmetric(6), symmetric(12));
        let (k, tk) = (vector(18), vector(21));
        let a = Vector3::from(self.a.to_array());
        let cross = Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0);
        let mut products = SMatrix::<f64, 7, 7>::zeros();
        products.fixed_view_mut::<3, 3>(0, 0).copy_from(&kk);
        let moment = cross * tkk;
        products.fixed_view_mut::<3, 3>(3, 0).copy_from(&moment);
        products.fixed_view_mut::<3, 3>(0, 3).copy_from(&moment.transpose());
        products.fixed_view_mut::<3, 3>(3, 3).copy_from(&(cross * ttkk * cross.transpose()));
        let stretch = tkk * a;
        products.fixed_view_mut::<3, 1>(0, 6).copy_from(&stretch);
        products.fixed_view_mut::<1, 3>(6, 0).copy_from(&stretch.transpose());
        let stretch = cross * ttkk * a;
        products.fixed_view_mut::<3, 1>(3, 6).copy_from(&stretch);
        products.fixed_view_mut::<1, 3>(6, 3).copy_from(&stretch.transpose());
        products[(6, 6)] = (a.transpose() * ttkk * a)[0];
        let mut forces = SVector::<f64, 7>::zeros();
        forces.fixed_rows_mut::<3>(0).copy_from(&k);
        forces.fixed_rows_mut::<3>(3).copy_from(&(cross * tk));
        forces[6] = a.dot(&tk);
        if self.ramp.follows_depth() {
            // Half the depth's force at each of the limb's joints: its wrench is constant but for the factor c.
            let axis = Vector3::from(self.limb_axis.to_array());
            let (depth_k, depth_tk) = (vector(24), vector(27));
            let mut with = SVector::<f64, 7>::zeros();
            with.fixed_rows_mut::<3>(0).copy_from(&depth_k);
            with.fixed_rows_mut::<3>(3).copy_from(&(cross * depth_tk));
            with[6] = a.dot(&depth_tk);
            let z = Vector3::z();
            let mut depth = SVector::<f64, 7>::zeros();
            depth.fixed_rows_mut::<3>(0).copy_from(&z);
            depth.fixed_rows_mut::<3>(3).copy_from(&(axis.cross(&z) * 0.5));
            depth[6] = 0.5 * axis.z;
            // All else is about p0 so far: bring the mixed sums to the limb's joint too.
            let with = self.shift() * with;
            products = self.shift() * products * self.shift().transpose();
            forces = self.shift() * forces;
            products +=
                with * depth.transpose() + depth * with.transpose() + depth * depth.transpose() * s[30];
            forces += depth * s[31];
        } else if self.arm != DVec3::ZERO {
            products = self.shift() * products * self.shift().transpose();
            forces = self.shift() * forces;
        }
        (products, forces)
    }

    /// Takes wrenches about p0 to wrenches about the limb's first joint: the moment gains arm × k, the stretch
    /// arm·k.
    fn shift(&self) -> SMatrix<f64, 7, 7> {
        let arm = self.arm;
        let mut shift = SMatrix::<f64, 7, 7>::identity();
        let cross = Matrix3::new(0.0, -arm.z, arm.y, arm.z, 0.0, -arm.x, -arm.y, arm.x, 0.0);
        shift.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross);
        shift.fixed_view_mut::<1, 3>(6, 0).copy_from(&Vector3::from(arm.to_array()).transpose());
        shift
    }
}

/// Index of the sum of weights: whether any pixel pulls.
const PIXELS: usize = 32;

struct Pass<'a> {
    lanes: &'a mut Lanes,
    grid: &'a Grid,
    view: &'a View,
}

impl WithSimd for Pass<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { lanes, grid, view } = self;
        let pinhole = view.pinhole();
        let mut cost = 0.0;
        let band_rows = grid.band_rows();
        for first in (0..grid.rows).step_by(band_rows) {
            let last = (first + band_rows).min(grid.rows);
            for row in first..last {
                let y = (((grid.offset + row * grid.stride) as f64 - pinhole.cy) / pinhole.fy) as f32;
                lanes.win_row(simd, row, first, y, grid.pitch);
                cost += lanes.row_cost(simd, row, first, grid);
            }
            for index in 0..lanes.capsules.len() {
                lanes.pull_band(simd, index, first..last, grid, pinhole.cy, pinhole.fy);
            }
            for row in first..last {
                let [from, to] = lanes.touched[row];
                if from < to {
                    let start = (row - first) * grid.pitch;
                    let range = start + align_down::<S>(from)..start + align_up::<S>(to);
                    lanes.levels[range].fill(1.0);
                }
            }
        }
        cost
    }
}

#[inline(always)]
fn align_down<S: Simd>(column: u32) -> usize {
    column as usize / S::F32_LANES * S::F32_LANES
}

#[inline(always)]
fn align_up<S: Simd>(column: u32) -> usize {
    (column as usize).next_multiple_of(S::F32_LANES)
}

/// What does not change along a row of a capsule.
#[derive(Clone, Copy)]
struct RowConstants {
    origin: Vec3,
    a: Vec3,
    z0: f32,
    dy: f32,
    cross_x: f32,
    cross_y: f32,
    cross_z: f32,
    joint_x: f32,
    spheres: Option<f32>,
}

impl RowConstants {
    #[inline(always)]
    fn new(capsule: &Capsule, y: f32) -> Self {
        let (p0, a) = (capsule.p0, capsule.a);
        let origin = p0 / p0.z;
        let c = origin.cross(a).as_vec3();
        let dy = y - origin.y as f32;
        let a32 = a.as_vec3();
        Self {
            origin: origin.as_vec3(),
            a: a32,
            z0: p0.z as f32,
            dy,
            cross_x: c.x + dy * a32.z,
            cross_y: c.y,
            cross_z: c.z - dy * a32.x,
            joint_x: p0.z as f32 * dy,
            spheres: capsule.spheres,
        }
    }
}

/// Closest point and distance for lanes of pixels.
struct Closest<S: Simd> {
    t: S::f32s,
    squared: S::f32s,
}

#[inline(always)]
fn closest<S: Simd>(simd: S, row: &RowConstants, x: S::f32s, inverse_norm: S::f32s) -> Closest<S> {
    let splat = |value: f32| simd.splat_f32s(value);
    let dx = simd.sub_f32s(x, splat(row.origin.x));
    // e × a
    let ax = splat(row.cross_x);
    let ay = simd.mul_add_e_f32s(splat(-row.a.z), dx, splat(row.cross_y));
    let az = simd.mul_add_e_f32s(splat(row.a.y), dx, splat(row.cross_z));
    // e × p0
    let px = splat(row.joint_x);
    let py = simd.mul_f32s(splat(-row.z0), dx);
    let pz = simd.mul_add_e_f32s(splat(row.z0 * row.origin.y), dx, splat(-row.z0 * row.origin.x * row.dy));
    let length = simd.mul_add_e_f32s(az, az, simd.mul_add_e_f32s(ay, ay, splat(row.cross_x * row.cross_x)));
    let dot = simd.mul_add_e_f32s(az, pz, simd.mul_add_e_f32s(ay, py, simd.mul_f32s(ax, px)));
    // A ray along the axis has no t of its own: any will do.
    let length = simd.max_f32s(length, splat(f32::MIN_POSITIVE));
    let t = simd.div_f32s(simd.neg_f32s(dot), length);
    let mut t = simd.min_f32s(simd.max_f32s(t, splat(0.0)), splat(1.0));
    if let Some(gaps) = row.spheres {
        // Adding and taking away 1.5 · 2²³ rounds to the nearest whole number.
        let whole =
            simd.sub_f32s(simd.add_f32s(simd.mul_f32s(t, splat(gaps)), splat(ROUNDER)), splat(ROUNDER));
        t = simd.mul_f32s(whole, splat(1.0 / gaps));
    }
    let (x, y, z) =
        (simd.mul_add_e_f32s(t, ax, px), simd.mul_add_e_f32s(t, ay, py), simd.mul_add_e_f32s(t, az, pz));
    let squared = simd.mul_add_e_f32s(z, z, simd.mul_add_e_f32s(y, y, simd.mul_f32s(x, x)));
    Closest { t, squared: simd.mul_f32s(squared, inverse_norm) }
}

impl Lanes {
    /// The darkest capsule of every pixel of a row.
    #[inline(always)]
    fn win_row<S: Simd>(&mut self, simd: S, row: usize, first: usize, y: f32, pitch: usize) {
        let [from, to] = self.touched[row];
        if from >= to {
            return;
        }
        let lane = S::F32_LANES;
        let (from, to) = (align_down::<S>(from), align_up::<S>(to));
        let (xs, _) = S::as_simd_f32s(&self.xs[from..to]);
        let (norms, _) = S::as_mut_simd_f32s(&mut self.inverse_norms[from..to]);
        let base = simd.splat_f32s(1.0 + y * y);
        for (norm, &x) in norms.iter_mut().zip(xs) {
            *norm = simd.div_f32s(simd.splat_f32s(1.0), simd.mul_add_e_f32s(x, x, base));
        }
        let start = (row - first) * pitch;
        for (index, capsule) in self.capsules.iter().enumerate() {
            if !(capsule.rows[0]..capsule.rows[1]).contains(&row) {
                continue;
            }
            let [from, to] = self.spans[capsule.first_span + row - capsule.rows[0]];
            if from >= to {
                continue;
            }
            let (from, to) = (align_down::<S>(from), align_up::<S>(to));
            let constants = RowConstants::new(capsule, y);
            let (xs, _) = S::as_simd_f32s(&self.xs[from..to]);
            let (norms, _) = S::as_simd_f32s(&self.inverse_norms[from..to]);
            let (levels, _) = S::as_mut_simd_f32s(&mut self.levels[start + from..start + to]);
            let (owners, _) = S::as_mut_simd_u32s(&mut self.owners[start + from..start + to]);
            let ramp = capsule.ramp.line();
            let (slope, offset) = (simd.splat_f32s(ramp.0), simd.splat_f32s(ramp.1));
            let owner = simd.splat_u32s(index as u32);
            for i in 0..(to - from) / lane {
                let point = closest(simd, &constants, xs[i], norms[i]);
                let measure = if ramp.2 { simd.sqrt_f32s(point.squared) } else { point.squared };
                let level = simd.mul_add_e_f32s(slope, measure, offset);
                let darker = simd.less_than_f32s(level, levels[i]);
                levels[i] = simd.select_f32s(darker, level, levels[i]);
                owners[i] = simd.select_u32s(darker, owner, owners[i]);
            }
        }
    }

    /// Σ w ((D − Λ)² − (D − 255)²) over the touched pixels of a row.
    #[inline(always)]
    fn row_cost<S: Simd>(&self, simd: S, row: usize, first: usize, grid: &Grid) -> f64 {
        let [from, to] = self.touched[row];
        if from >= to {
            return 0.0;
        }
        let (from, to) = (align_down::<S>(from), align_up::<S>(to));
        let (start, data) = ((row - first) * grid.pitch, row * grid.pitch);
        let (levels, _) = S::as_simd_f32s(&self.levels[start + from..start + to]);
        let (values, _) = S::as_simd_f32s(&grid.values[data + from..data + to]);
        let (weights, _) = S::as_simd_f32s(&grid.weights[data + from..data + to]);
        let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
        let white = simd.splat_f32s(BACKGROUND as f32);
        let mut sum = zero;
        for i in 0..levels.len() {
            let level = simd.min_f32s(simd.max_f32s(levels[i], zero), one);
            let residual = simd.sub_f32s(values[i], simd.mul_f32s(level, white));
            let empty = simd.sub_f32s(values[i], white);
            let squares = simd.sub_f32s(simd.mul_f32s(residual, residual), simd.mul_f32s(empty, empty));
            sum = simd.mul_add_e_f32s(weights[i], squares, sum);
        }
        f64::from(simd.reduce_sum_f32s(sum))
    }

    /// One capsule's sums over a band of rows.
    #[inline(always)]
    fn pull_band<S: Simd>(
        &mut self,
        simd: S,
        index: usize,
        band: std::ops::Range<usize>,
        grid: &Grid,
        cy: f64,
        fy: f64,
    ) {
        let capsule = self.capsules[index];
        let rows = capsule.rows[0].max(band.start)..capsule.rows[1].min(band.end);
        if rows.is_empty() {
            return;
        }
        let mut sums = [simd.splat_f32s(0.0); SUMS];
        for row in rows {
            let y = (((grid.offset + row * grid.stride) as f64 - cy) / fy) as f32;
            self.pull_row(simd, index, &capsule, row, row - band.start, y, grid, &mut sums);
        }
        for (total, sum) in self.totals[index].iter_mut().zip(sums) {
            *total += f64::from(simd.reduce_sum_f32s(sum));
        }
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "one row of a hot loop")]
    fn pull_row<S: Simd>(
        &self,
        simd: S,
        index: usize,
        capsule: &Capsule,
        row: usize,
        band_row: usize,
        y: f32,
        grid: &Grid,
        sums: &mut [S::f32s; SUMS],
    ) {
        let [from, to] = self.spans[capsule.first_span + row - capsule.rows[0]];
        if from >= to {
            return;
        }
        let (from, to) = (align_down::<S>(from), align_up::<S>(to));
        let (start, data) = (band_row * grid.pitch, row * grid.pitch);
        let (xs, _) = S::as_simd_f32s(&self.xs[from..to]);
        let (levels, _) = S::as_simd_f32s(&self.levels[start + from..start + to]);
        let (owners, _) = S::as_simd_u32s(&self.owners[start + from..start + to]);
        let (values, _) = S::as_simd_f32s(&grid.values[data + from..data + to]);
        let (weights, _) = S::as_simd_f32s(&grid.weights[data + from..data + to]);
        let constants = RowConstants::new(capsule, y);
        let splat = |value: f32| simd.splat_f32s(value);
        let (zero, one, white) = (splat(0.0), splat(1.0), splat(BACKGROUND as f32));
        let owner = simd.splat_u32s(index as u32);
        let base = splat(1.0 + y * y);
        let y_lanes = splat(y);
        let p0 = capsule.p0.as_vec3();
        for i in 0..xs.len() {
            let level = levels[i];
            let active = simd.and_m32s(
                simd.and_m32s(simd.less_than_f32s(zero, level), simd.less_than_f32s(level, one)),
                simd.equal_u32s(owners[i], owner),
            );
            if simd.first_true_m32s(active) >= S::F32_LANES {
                continue;
            }
            let x = xs[i];
            let inverse_norm = simd.div_f32s(one, simd.mul_add_e_f32s(x, x, base));
            let point = closest(simd, &constants, x, inverse_norm);
            let t = point.t;
            let along = |a: f32, p: f32| simd.mul_add_e_f32s(t, splat(a), splat(p));
            let (qx, qy, qz) =
                (along(constants.a.x, p0.x), along(constants.a.y, p0.y), along(constants.a.z, p0.z));
            // δ = (e·q/|e|²) e − q, from the ray to the closest point's far side
            let depth = simd.mul_add_e_f32s(x, qx, simd.mul_add_e_f32s(y_lanes, qy, qz));
            let s = simd.mul_f32s(depth, inverse_norm);
            let mut dx = simd.mul_add_e_f32s(s, x, simd.neg_f32s(qx));
            let mut dy = simd.mul_add_e_f32s(s, y_lanes, simd.neg_f32s(qy));
            let mut dz = simd.sub_f32s(s, qz);
            if capsule.ramp.line().2 {
                // ∂λ/∂q = −(255/width) δ/d
                let inverse = simd.div_f32s(one, simd.sqrt_f32s(simd.max_f32s(point.squared, splat(1e-20))));
                dx = simd.mul_f32s(dx, inverse);
                dy = simd.mul_f32s(dy, inverse);
                dz = simd.mul_f32s(dz, inverse);
            }
            let weight = simd.select_f32s(active, weights[i], zero);
            let residual = simd.sub_f32s(values[i], simd.mul_f32s(level, white));
            let (wx, wy, wz) =
                (simd.mul_f32s(weight, dx), simd.mul_f32s(weight, dy), simd.mul_f32s(weight, dz));
            let mut add = |slot: usize, a: S::f32s, b: S::f32s| {
                sums[slot] = simd.mul_add_e_f32s(a, b, sums[slot]);
            };
            let products = [(wx, dx), (wx, dy), (wx, dz), (wy, dy), (wy, dz), (wz, dz)];
            for (slot, (a, b)) in products.into_iter().enumerate() {
                let product = simd.mul_f32s(a, b);
                let t_product = simd.mul_f32s(product, t);
                add(slot, product, one);
                add(6 + slot, t_product, one);
                add(12 + slot, t_product, t);
            }
            let t_residual = simd.mul_f32s(t, residual);
            for (slot, w) in [wx, wy, wz].into_iter().enumerate() {
                add(18 + slot, w, residual);
                add(21 + slot, w, t_residual);
            }
            add(PIXELS, weight, one);
            if let Some((constant, slope)) = capsule.ramp.depth_line() {
                let measure = if capsule.ramp.line().2 { level } else { point.squared };
                let c = simd.mul_add_e_f32s(splat(slope), measure, splat(constant));
                let tc = simd.mul_f32s(t, c);
                for (slot, w) in [wx, wy, wz].into_iter().enumerate() {
                    add(24 + slot, w, c);
                    add(27 + slot, w, tc);
                }
                let wc = simd.mul_f32s(weight, c);
                add(30, wc, c);
                add(31, wc, residual);
            }
        }
    }
}
