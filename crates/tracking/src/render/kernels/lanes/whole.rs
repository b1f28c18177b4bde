//! Pull of a solid that is looked at as a whole: forces collected, and multiplied out in several passes, so that each
//! pass's sums stay in registers.

use glam::Vec3;
use pulp::Simd;

use super::masks::lane_bits;
use super::pull::{PAIRS, add_totals};
use super::solid::{LaneSolid, Shape};
use super::sums::{CAPS, DEPTH, SUMS};
use super::winners::{END_CAP, FlatHit, START_CAP};

/// Vectors kept of one tile: f, w, t, ρ, ∂λ/∂z, κ h.
pub(super) const ENTRY: usize = 10;

/// Multiplies out what was collected of a whole solid and adds it to the totals.
#[inline(always)]
pub(super) fn flush<S: Simd>(
    simd: S,
    vectors: &[f32],
    groups: &mut usize,
    solid: &LaneSolid,
    totals: &mut [f64; SUMS],
) {
    if *groups == 0 {
        return;
    }
    let (vectors, _) = S::as_simd_f32s(vectors);
    let entries = &vectors[..*groups * ENTRY];
    *groups = 0;
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
        rays: [S::f32s; 2],
        (level, fraction): (S::f32s, S::f32s),
    ) -> Self {
        let mut force = match solid.shape {
            Shape::Capsule | Shape::Spheres { .. } => round(simd, solid, rays, fraction),
            Shape::Cylinder { .. } => flat(simd, solid, rays, fraction),
        };
        if solid.ramp.is_linear {
            let inverse = inverse_distance(simd, solid, level);
            force.f = force.f.map(|f| simd.mul_f32s(f, inverse));
            force.cap = force.cap.map(|g| simd.mul_f32s(g, inverse));
        }
        force
    }
}

/// 1/d at a level of a linear ramp.
#[inline(always)]
pub(super) fn inverse_distance<S: Simd>(simd: S, solid: &LaneSolid, level: S::f32s) -> S::f32s {
    let [start, width] = solid.ramp.distance.map(|part| simd.splat_f32s(part));
    simd.div_f32s(simd.splat_f32s(1.0), simd.mul_add_e_f32s(level, width, start))
}

/// The axis, a round end or a sphere at fraction t.
#[inline(always)]
fn round<S: Simd>(simd: S, solid: &LaneSolid, rays: [S::f32s; 2], t: S::f32s) -> Force<S> {
    let splat = |value: f32| simd.splat_f32s(value);
    let start = Vec3::new(solid.joints[0].x, solid.joints[0].y, 1.0) * solid.joints[0].z;
    let along = |a: f32, p: f32| simd.mul_add_e_f32s(t, splat(a), splat(p));
    let q = [along(solid.a.x, start.x), along(solid.a.y, start.y), along(solid.a.z, start.z)];
    Force { f: toward_ray(simd, q, rays), cap: [splat(0.0); 3], fraction: t }
}

/// δ = (e·q/|e|²) e − q, from a point to the ray.
#[inline(always)]
pub(super) fn toward_ray<S: Simd>(simd: S, q: [S::f32s; 3], [x, y]: [S::f32s; 2]) -> [S::f32s; 3] {
    let depth = simd.mul_add_e_f32s(x, q[0], simd.mul_add_e_f32s(y, q[1], q[2]));
    let norm = simd.mul_add_e_f32s(x, x, simd.mul_add_e_f32s(y, y, simd.splat_f32s(1.0)));
    let s = simd.div_f32s(depth, norm);
    [
        simd.mul_add_e_f32s(s, x, simd.neg_f32s(q[0])),
        simd.mul_add_e_f32s(s, y, simd.neg_f32s(q[1])),
        simd.sub_f32s(s, q[2]),
    ]
}

/// The axis between its joints, or one of the flat caps.
#[inline(always)]
fn flat<S: Simd>(simd: S, solid: &LaneSolid, [x, y]: [S::f32s; 2], mark: S::f32s) -> Force<S> {
    let splat = |value: f32| simd.splat_f32s(value);
    let (zero, one) = (splat(0.0), splat(1.0));
    let t = simd.min_f32s(simd.max_f32s(mark, zero), one);
    let mut force = round(simd, solid, [x, y], t);
    for (joint, is_cap) in [
        (&solid.joints[0], simd.less_than_or_equal_f32s(mark, splat(START_CAP))),
        (&solid.joints[1], simd.less_than_or_equal_f32s(splat(END_CAP), mark)),
    ] {
        if lane_bits(simd, is_cap) == 0 {
            continue;
        }
        let hit = FlatHit::new(simd, solid, joint, [x, y]);
        // h in metres; axis · e is a · e over z₀, the first joint's depth.
        let h = hit.h.map(|h| simd.mul_f32s(h, splat(joint.z)));
        let along_ray = simd.mul_add_e_f32s(h[0], x, simd.mul_add_e_f32s(h[1], y, h[2]));
        let kappa = simd.div_f32s(along_ray, simd.mul_f32s(hit.along, splat(solid.joints[0].z)));
        for (axis, a) in [solid.a.x, solid.a.y, solid.a.z].into_iter().enumerate() {
            let f = simd.negate_mul_add_e_f32s(kappa, splat(a), h[axis]);
            force.f[axis] = simd.select_f32s(is_cap, f, force.f[axis]);
            force.cap[axis] = simd.select_f32s(is_cap, simd.mul_f32s(kappa, h[axis]), force.cap[axis]);
        }
    }
    force
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
