//! Pull: what the pixels that a solid has won pull at its two joints, summed.
//!
//! A pixel's gradient acts as a force g₀ at p0 and g₁ at p1. With f = g₀ + g₁ and up to the ramp's factor,
//!
//! | nearest | f | g₁ |
//! |---|---|---|
//! | axis, round end, equal sphere | δ = (e·q/\|e\|²) e − q, q = p0 + t a | t f |
//! | flat cap at p0 (t = 0) or p1 (t = 1) | h − κ a, κ = (h·e)/(a·e) | t f + κ h |
//!
//! Forces are first collected for some hundred pixels and then multiplied out in several passes, so that each
//! pass's sums stay in registers; then they are flushed to f64.

use glam::Vec3;
use pulp::Simd;

use super::grid::RowData;
use super::solid::{LaneSolid, Shape};
use super::sums::{CAPS, DEPTH, SUMS};
use super::winners::{Band, END_CAP, FlatHit, Row, START_CAP};
use crate::render::ramp::BACKGROUND;

/// Vectors kept of one group of pixels: f, w, t, ρ, ∂λ/∂z, κ h.
const ENTRY: usize = 10;
/// Groups of pixels collected before they are summed: these stay in the first cache.
const GROUPS: usize = 48;
/// Widest lanes, in numbers.
const MOST_LANES: usize = 16;

/// Forces collected and not yet summed.
#[derive(Debug, Clone, Default)]
pub(super) struct Collected {
    vectors: Vec<f32>,
    groups: usize,
}

impl Collected {
    pub(super) fn reserve(&mut self) {
        self.vectors.resize(GROUPS * ENTRY * MOST_LANES, 0.0);
    }

    /// Collects the pixels of a row that the solid has won and whose ramp is not clipped.
    #[inline(always)]
    pub(super) fn pull_row<S: Simd>(
        &mut self,
        simd: S,
        (solid, index): (&LaneSolid, usize),
        row: &Row<'_>,
        band: &Band,
        data: RowData<'_>,
        totals: &mut [f64; SUMS],
    ) {
        let span = row.columns::<S>();
        let here = row.start + span.start..row.start + span.end;
        let (xs, _) = S::as_simd_f32s(&row.xs[span.clone()]);
        let (levels, _) = S::as_simd_f32s(&band.levels[here.clone()]);
        let (owners, _) = S::as_simd_u32s(&band.owners[here.clone()]);
        let (fractions, _) = S::as_simd_f32s(&band.fractions[here.clone()]);
        let (norms, _) = S::as_simd_f32s(&band.inverse_norms[here]);
        let (values, _) = S::as_simd_f32s(&data.values[span.clone()]);
        let (weights, _) = S::as_simd_f32s(&data.weights[span]);
        let splat = |value: f32| simd.splat_f32s(value);
        let (zero, one, white) = (splat(0.0), splat(1.0), splat(BACKGROUND as f32));
        let owner = simd.splat_u32s(index as u32);
        for i in 0..xs.len() {
            let level = levels[i];
            let active = simd.and_m32s(
                simd.and_m32s(simd.less_than_f32s(zero, level), simd.less_than_f32s(level, one)),
                simd.equal_u32s(owners[i], owner),
            );
            if simd.first_true_m32s(active) >= S::F32_LANES {
                continue;
            }
            let weight = simd.select_f32s(active, weights[i], zero);
            let residual = simd.negate_mul_add_e_f32s(level, white, values[i]);
            let force = Force::new(simd, solid, (xs[i], row.y), (level, fractions[i]), norms[i]);
            let (vectors, _) = S::as_mut_simd_f32s(&mut self.vectors);
            let entry = &mut vectors[self.groups * ENTRY..(self.groups + 1) * ENTRY];
            entry[0] = force.f[0];
            entry[1] = force.f[1];
            entry[2] = force.f[2];
            entry[3] = weight;
            entry[4] = force.fraction;
            entry[5] = residual;
            if let Some([constant, slope]) = solid.ramp.by_depth {
                entry[6] = simd.mul_add_e_f32s(splat(slope), level, splat(constant));
            }
            if matches!(solid.shape, Shape::Cylinder { .. }) {
                entry[7..].copy_from_slice(&force.cap);
            }
            self.groups += 1;
            if self.groups == GROUPS {
                self.flush(simd, solid, totals);
            }
        }
    }

    /// Multiplies out what was collected and adds it to the totals.
    #[inline(always)]
    pub(super) fn flush<S: Simd>(&mut self, simd: S, solid: &LaneSolid, totals: &mut [f64; SUMS]) {
        if self.groups == 0 {
            return;
        }
        let (vectors, _) = S::as_simd_f32s(&self.vectors);
        let entries = &vectors[..self.groups * ENTRY];
        self.groups = 0;
        sum_products(simd, entries, totals);
        sum_forces(simd, entries, totals);
        let by_depth = solid.ramp.by_depth.is_some();
        if by_depth {
            sum_depth(simd, entries, totals);
        }
        if matches!(solid.shape, Shape::Cylinder { .. }) {
            sum_caps(simd, entries, by_depth, totals);
        }
    }
}

/// A pixel's pull: f, κ h and the fraction t.
pub(super) struct Force<S: Simd> {
    pub f: [S::f32s; 3],
    pub cap: [S::f32s; 3],
    pub fraction: S::f32s,
}

impl<S: Simd> Force<S> {
    /// Of rays (x, y) that see a solid at a level and a fraction.
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        solid: &LaneSolid,
        (x, y): (S::f32s, f32),
        (level, fraction): (S::f32s, S::f32s),
        inverse_norm: S::f32s,
    ) -> Self {
        let mut force = match solid.shape {
            Shape::Capsule | Shape::Spheres { .. } => round(simd, solid, x, y, fraction, inverse_norm),
            Shape::Cylinder { .. } => flat(simd, solid, x, y, fraction, inverse_norm),
        };
        if solid.ramp.is_linear {
            let [start, width] = solid.ramp.distance.map(|part| simd.splat_f32s(part));
            let distance = simd.mul_add_e_f32s(level, width, start);
            let inverse = simd.div_f32s(simd.splat_f32s(1.0), distance);
            force.f = force.f.map(|f| simd.mul_f32s(f, inverse));
            force.cap = force.cap.map(|g| simd.mul_f32s(g, inverse));
        }
        force
    }
}

/// The axis, a round end or a sphere at fraction t.
#[inline(always)]
fn round<S: Simd>(
    simd: S,
    solid: &LaneSolid,
    x: S::f32s,
    y: f32,
    t: S::f32s,
    inverse_norm: S::f32s,
) -> Force<S> {
    let splat = |value: f32| simd.splat_f32s(value);
    let start = solid.start_point();
    let along = |a: f32, p: f32| simd.mul_add_e_f32s(t, splat(a), splat(p));
    let q = [along(solid.a.x, start.x), along(solid.a.y, start.y), along(solid.a.z, start.z)];
    // δ = (e·q/|e|²) e − q, from the closest point to the ray
    let depth = simd.mul_add_e_f32s(x, q[0], simd.mul_add_e_f32s(splat(y), q[1], q[2]));
    let s = simd.mul_f32s(depth, inverse_norm);
    let f = [
        simd.mul_add_e_f32s(s, x, simd.neg_f32s(q[0])),
        simd.mul_add_e_f32s(s, splat(y), simd.neg_f32s(q[1])),
        simd.sub_f32s(s, q[2]),
    ];
    Force { f, cap: [splat(0.0); 3], fraction: t }
}

/// The axis between its joints, or one of the flat caps.
#[inline(always)]
fn flat<S: Simd>(
    simd: S,
    solid: &LaneSolid,
    x: S::f32s,
    y: f32,
    mark: S::f32s,
    inverse_norm: S::f32s,
) -> Force<S> {
    let splat = |value: f32| simd.splat_f32s(value);
    let (zero, one) = (splat(0.0), splat(1.0));
    let t = simd.min_f32s(simd.max_f32s(mark, zero), one);
    let mut force = round(simd, solid, x, y, t, inverse_norm);
    for (joint, is_cap) in [
        (&solid.start, simd.less_than_or_equal_f32s(mark, splat(START_CAP))),
        (&solid.end, simd.less_than_or_equal_f32s(splat(END_CAP), mark)),
    ] {
        if simd.first_true_m32s(is_cap) >= S::F32_LANES {
            continue;
        }
        let hit = FlatHit::new(simd, solid, joint, x, y);
        // h in metres; axis · e is a · e over z₀, the first joint's depth.
        let h = hit.h.map(|h| simd.mul_f32s(h, splat(joint.z)));
        let along_ray = simd.mul_add_e_f32s(h[0], x, simd.mul_add_e_f32s(h[1], splat(y), h[2]));
        let kappa = simd.div_f32s(along_ray, simd.mul_f32s(hit.along, splat(solid.start.z)));
        for (axis, a) in [solid.a.x, solid.a.y, solid.a.z].into_iter().enumerate() {
            let f = simd.negate_mul_add_e_f32s(kappa, splat(a), h[axis]);
            force.f[axis] = simd.select_f32s(is_cap, f, force.f[axis]);
            force.cap[axis] = simd.select_f32s(is_cap, simd.mul_f32s(kappa, h[axis]), force.cap[axis]);
        }
    }
    force
}

impl LaneSolid {
    fn start_point(&self) -> Vec3 {
        Vec3::new(self.start.x, self.start.y, 1.0) * self.start.z
    }
}

/// Pairs of a symmetric 3 × 3 matrix, its upper triangle row by row.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

#[inline(always)]
fn add_totals<S: Simd, const N: usize>(simd: S, sums: [S::f32s; N], totals: &mut [f64]) {
    for (total, sum) in totals.iter_mut().zip(sums) {
        *total += f64::from(simd.reduce_sum_f32s(sum));
    }
}

/// Σ w f fᵀ and Σ w t f fᵀ.
#[inline(always)]
fn sum_products<S: Simd>(simd: S, entries: &[S::f32s], totals: &mut [f64; SUMS]) {
    let mut sums = [simd.splat_f32s(0.0); 12];
    for entry in entries.chunks_exact(ENTRY) {
        let f = [entry[0], entry[1], entry[2]];
        let weighted = f.map(|f| simd.mul_f32s(f, entry[3]));
        for (slot, (i, j)) in PAIRS.into_iter().enumerate() {
            let product = simd.mul_f32s(weighted[i], f[j]);
            sums[slot] = simd.add_f32s(sums[slot], product);
            sums[6 + slot] = simd.mul_add_e_f32s(product, entry[4], sums[6 + slot]);
        }
    }
    add_totals(simd, sums, &mut totals[..12]);
}

/// Σ w t² f fᵀ, Σ w ρ f and Σ w t ρ f.
#[inline(always)]
fn sum_forces<S: Simd>(simd: S, entries: &[S::f32s], totals: &mut [f64; SUMS]) {
    let mut sums = [simd.splat_f32s(0.0); 12];
    for entry in entries.chunks_exact(ENTRY) {
        let (t, residual) = (entry[4], entry[5]);
        let f = [entry[0], entry[1], entry[2]];
        let weighted = f.map(|f| simd.mul_f32s(f, entry[3]));
        let g = f.map(|f| simd.mul_f32s(f, t));
        let weighted_g = weighted.map(|f| simd.mul_f32s(f, t));
        for (slot, (i, j)) in PAIRS.into_iter().enumerate() {
            sums[slot] = simd.mul_add_e_f32s(weighted_g[i], g[j], sums[slot]);
        }
        for i in 0..3 {
            sums[6 + i] = simd.mul_add_e_f32s(weighted[i], residual, sums[6 + i]);
            sums[9 + i] = simd.mul_add_e_f32s(weighted_g[i], residual, sums[9 + i]);
        }
    }
    add_totals(simd, sums, &mut totals[12..24]);
}

/// Σ w c f, Σ w c t f, Σ w c² and Σ w c ρ, with c = ∂λ/∂z.
#[inline(always)]
fn sum_depth<S: Simd>(simd: S, entries: &[S::f32s], totals: &mut [f64; SUMS]) {
    let mut sums = [simd.splat_f32s(0.0); 8];
    for entry in entries.chunks_exact(ENTRY) {
        let weighted = simd.mul_f32s(entry[3], entry[6]);
        let weighted_t = simd.mul_f32s(weighted, entry[4]);
        for i in 0..3 {
            sums[i] = simd.mul_add_e_f32s(weighted, entry[i], sums[i]);
            sums[3 + i] = simd.mul_add_e_f32s(weighted_t, entry[i], sums[3 + i]);
        }
        sums[6] = simd.mul_add_e_f32s(weighted, entry[6], sums[6]);
        sums[7] = simd.mul_add_e_f32s(weighted, entry[5], sums[7]);
    }
    add_totals(simd, sums, &mut totals[DEPTH..DEPTH + 8]);
}

/// With G = κ h: Σ w f Gᵀ, Σ w t f Gᵀ, Σ w G Gᵀ, Σ w ρ G and, if asked for, Σ w c G.
#[inline(always)]
fn sum_caps<S: Simd>(simd: S, entries: &[S::f32s], by_depth: bool, totals: &mut [f64; SUMS]) {
    let zero = simd.splat_f32s(0.0);
    let mut mixed = [zero; 9];
    let mut mixed_t = [zero; 9];
    for entry in entries.chunks_exact(ENTRY) {
        let weighted = [entry[7], entry[8], entry[9]].map(|g| simd.mul_f32s(g, entry[3]));
        for i in 0..3 {
            let along = simd.mul_f32s(entry[i], entry[4]);
            for j in 0..3 {
                mixed[3 * i + j] = simd.mul_add_e_f32s(entry[i], weighted[j], mixed[3 * i + j]);
                mixed_t[3 * i + j] = simd.mul_add_e_f32s(along, weighted[j], mixed_t[3 * i + j]);
            }
        }
    }
    add_totals(simd, mixed, &mut totals[CAPS..CAPS + 9]);
    add_totals(simd, mixed_t, &mut totals[CAPS + 9..CAPS + 18]);
    let mut sums = [zero; 12];
    for entry in entries.chunks_exact(ENTRY) {
        let cap = [entry[7], entry[8], entry[9]];
        let weighted = cap.map(|g| simd.mul_f32s(g, entry[3]));
        for (slot, (i, j)) in PAIRS.into_iter().enumerate() {
            sums[slot] = simd.mul_add_e_f32s(weighted[i], cap[j], sums[slot]);
        }
        for i in 0..3 {
            sums[6 + i] = simd.mul_add_e_f32s(weighted[i], entry[5], sums[6 + i]);
            if by_depth {
                sums[9 + i] = simd.mul_add_e_f32s(weighted[i], entry[6], sums[9 + i]);
            }
        }
    }
    add_totals(simd, sums, &mut totals[CAPS + 18..CAPS + 30]);
}
