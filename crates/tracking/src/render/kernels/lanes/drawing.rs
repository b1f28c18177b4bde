//! Whole pictures in lanes: λ and owner of every pixel, how strongly it pulls, how it changes along a motion.
//!
//! The winners are the fit's; beside them the second darkest is kept. Pixels about which f32 may be wrong are decided
//! again by [`scalar`](super::super::scalar)'s arithmetic: where two solids, or a solid and the background, are as
//! dark as each other; where a ramp begins; where rounding decides which part of a solid is nearest; all of a
//! ramp that is so steep that the rounding of the ray would show. A pixel never depends on its neighbours, so that bands
//! and threads change nothing.

use std::ops::Range;

use glam::DVec3;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::grid::PixelGrid;
use super::ground::Ground;
use super::pull::Force;
use super::solid::LaneSolid;
use super::winners::Band;
use crate::render::View;
use crate::render::drawing::{Drawing, MOST_ERROR, Strip, Wanted};
use crate::render::jacobian::BodyMotion;
use crate::render::prediction::NO_OWNER;
use crate::render::primitive::Solid;
use crate::render::ramp::BACKGROUND;

/// Bands that a thread takes at once.
const LEAST_BANDS: usize = 4;

/// Fills the pictures of a drawing that come in background. [`View::suits_lanes`] must hold.
pub(in crate::render) fn draw(view: &View, wanted: Wanted<'_>, drawing: &mut Drawing) {
    let grid = PixelGrid::without_data([view.width(), view.height()]);
    let mut ground = Ground::default();
    ground.prepare(view, &grid);
    Arch::new().dispatch(|| ground.cut_spans(&grid));
    let primitives = view.primitives();
    let limbs = ground.solids.iter().map(|solid| solid.limb as u16).collect();
    let rates = wanted.motion.map(|motion| {
        let solids = ground.solids.iter();
        solids.map(|solid| SolidRate::new(solid, &primitives[solid.primitive].solid, motion)).collect()
    });
    let error = ground.solids.iter().map(|solid| solid.error).fold(0.0, f32::max);
    let plan = Plan { ground, grid, view, wanted, limbs, rates, error };
    let strips = drawing.strips(plan.grid.band_rows());
    let draw = |scratch: &mut Scratch, strip: Strip<'_>| {
        Arch::new().dispatch(DrawBand { plan: &plan, scratch, strip });
    };
    strips.into_par_iter().with_min_len(LEAST_BANDS).for_each_init(Scratch::default, draw);
}

/// What all bands of a view share.
struct Plan<'a> {
    ground: Ground,
    grid: PixelGrid,
    view: &'a View,
    wanted: Wanted<'a>,
    /// By solid.
    limbs: Vec<u16>,
    /// By solid, if a motion is looked at.
    rates: Option<Vec<SolidRate>>,
    /// λ/255 is at most this wrong.
    error: f32,
}

/// How a solid moves, in camera axes; all but the depth times its ramp's factor.
#[derive(Debug, Clone, Copy)]
struct SolidRate {
    start: [f32; 3],
    axis: [f32; 3],
    depth: f32,
}

impl SolidRate {
    fn new(solid: &LaneSolid, shape: &Solid, motion: &BodyMotion) -> Self {
        let limb = motion.in_camera(solid.limb);
        let (start, axis, limb_axis) = match *shape {
            Solid::Capsule { p0, p1 } | Solid::Cylinder { p0, p1 } | Solid::Spheres { p0, p1, .. } => {
                (DVec3::ZERO, p1 - p0, p1 - p0)
            }
            Solid::Sphere { p0, p1, centre } => (centre - p0, DVec3::ZERO, p1 - p0),
        };
        let factor = solid.ramp.factor;
        let numbers = |rate: DVec3| (rate * factor).as_vec3().to_array();
        Self {
            start: numbers(limb.velocity + limb.of_arm(start)),
            axis: numbers(limb.of_arm(axis)),
            depth: (limb.velocity.z + 0.5 * limb.of_arm(limb_axis).z) as f32,
        }
    }
}

/// A thread's memory.
#[derive(Debug, Default)]
struct Scratch {
    band: Band,
    gradients: Vec<f32>,
    changes: Vec<f32>,
}

struct DrawBand<'a> {
    plan: &'a Plan<'a>,
    scratch: &'a mut Scratch,
    strip: Strip<'a>,
}

impl WithSimd for DrawBand<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { plan, scratch, mut strip } = self;
        let Plan { ground, grid, view, wanted, .. } = plan;
        let rows = strip.rows();
        scratch.band.resize_with_doubts(grid.band_rows() * grid.pitch);
        ground.win_band::<S, true>(simd, &mut scratch.band, rows.clone(), grid);
        if wanted.gradient || wanted.motion.is_some() {
            scratch.derive_band(simd, plan, &rows);
        }
        for row in rows.clone() {
            let [from, to] = ground.touched[row].map(|column| column as usize);
            let (from, to) = (from.min(grid.columns), to.min(grid.columns));
            let start = (row - rows.start) * grid.pitch;
            strip.row(row).background(from..to.max(from));
            if from < to {
                let here = start + from..start + to;
                plan.put_row(&mut strip, (row, from..to), scratch, here.clone());
                let (levels, runners_up) =
                    (&scratch.band.levels[here.clone()], &scratch.band.runners_up[here]);
                doubts(simd, plan.error, (levels, runners_up), |column| {
                    strip.put_exactly(view, *wanted, from + column, row);
                });
            }
        }
    }
}

impl Plan<'_> {
    /// Copies what is known of a row's columns, `here` in the band, to the pictures.
    #[inline(always)]
    fn put_row(
        &self,
        strip: &mut Strip<'_>,
        (row, columns): (usize, Range<usize>),
        scratch: &Scratch,
        here: Range<usize>,
    ) {
        let band = &scratch.band;
        let out = strip.row(row);
        for (lambda, &level) in out.lambda[columns.clone()].iter_mut().zip(&band.levels[here.clone()]) {
            *lambda = BACKGROUND as f32 * level.clamp(0.0, 1.0);
        }
        for (owner, &solid) in out.owner[columns.clone()].iter_mut().zip(&band.owners[here.clone()]) {
            *owner = self.limbs.get(solid as usize).copied().unwrap_or(NO_OWNER);
        }
        if self.wanted.gradient {
            out.gradient[columns.clone()].copy_from_slice(&scratch.gradients[here.clone()]);
        }
        if self.wanted.motion.is_some() {
            out.change[columns].copy_from_slice(&scratch.changes[here]);
        }
    }
}

/// Calls `visit` for every pixel, of these λ/255 and of their runners-up, that f32 cannot decide.
#[inline(always)]
fn doubts<S: Simd>(
    simd: S,
    error: f32,
    (levels, runners_up): (&[f32], &[f32]),
    mut visit: impl FnMut(usize),
) {
    // Where the error would show, the whole ramp is in doubt; else its dark end. Its bright end competes with
    // the background.
    let (low, high) = (-error, if error > MOST_ERROR { 1.0 + error } else { error });
    let lead = 2.0 * error;
    let is_doubtful = |level: f32, runner_up: f32| runner_up - level < lead || (low < level && level < high);
    let (level_lanes, level_tail) = S::as_simd_f32s(levels);
    let (runner_lanes, runner_tail) = S::as_simd_f32s(runners_up);
    let (low, high, lead) = (simd.splat_f32s(low), simd.splat_f32s(high), simd.splat_f32s(lead));
    for (index, (&level, &runner_up)) in level_lanes.iter().zip(runner_lanes).enumerate() {
        let is_tied = simd.less_than_f32s(simd.sub_f32s(runner_up, level), lead);
        let is_at_end = simd.and_m32s(simd.less_than_f32s(low, level), simd.less_than_f32s(level, high));
        if simd.first_true_m32s(simd.or_m32s(is_tied, is_at_end)) < S::F32_LANES {
            let lanes = index * S::F32_LANES..(index + 1) * S::F32_LANES;
            lanes.filter(|&lane| is_doubtful(levels[lane], runners_up[lane])).for_each(&mut visit);
        }
    }
    let head = levels.len() - level_tail.len();
    for (index, (&level, &runner_up)) in level_tail.iter().zip(runner_tail).enumerate() {
        if is_doubtful(level, runner_up) {
            visit(head + index);
        }
    }
}

impl Scratch {
    /// How strongly the pixels of a band pull and how they change, where that is wanted; zero where they do not.
    #[inline(always)]
    fn derive_band<S: Simd>(&mut self, simd: S, plan: &Plan<'_>, rows: &Range<usize>) {
        let Plan { ground, grid, wanted, rates, .. } = plan;
        let Self { band, gradients, changes } = self;
        let pixels = grid.band_rows() * grid.pitch;
        for (values, is_wanted) in [(&mut *gradients, wanted.gradient), (&mut *changes, rates.is_some())] {
            values.clear();
            values.resize(if is_wanted { pixels } else { 0 }, 0.0);
        }
        for (index, solid) in ground.solids.iter().enumerate() {
            let rate = rates.as_ref().map(|rates| &rates[index]);
            for row in solid.rows_in(rows) {
                let here = ground.row(row, rows, grid, ground.span(solid, row));
                if !here.is_touched() {
                    continue;
                }
                let span = here.columns::<S>();
                let in_band = here.start + span.start..here.start + span.end;
                let (xs, _) = S::as_simd_f32s(&here.xs[span]);
                let (levels, _) = S::as_simd_f32s(&band.levels[in_band.clone()]);
                let (owners, _) = S::as_simd_u32s(&band.owners[in_band.clone()]);
                let (fractions, _) = S::as_simd_f32s(&band.fractions[in_band.clone()]);
                let (norms, _) = S::as_simd_f32s(&band.inverse_norms[in_band.clone()]);
                let gradients = if wanted.gradient { &mut gradients[in_band.clone()] } else { &mut [] };
                let changes = if rate.is_some() { &mut changes[in_band] } else { &mut [] };
                let (gradients, _) = S::as_mut_simd_f32s(gradients);
                let (changes, _) = S::as_mut_simd_f32s(changes);
                let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
                let owner = simd.splat_u32s(index as u32);
                for i in 0..xs.len() {
                    let on_ramp = simd
                        .and_m32s(simd.less_than_f32s(zero, levels[i]), simd.less_than_f32s(levels[i], one));
                    let active = simd.and_m32s(on_ramp, simd.equal_u32s(owners[i], owner));
                    if simd.first_true_m32s(active) >= S::F32_LANES {
                        continue;
                    }
                    let force = Force::new(simd, solid, (xs[i], here.y), (levels[i], fractions[i]), norms[i]);
                    let by_depth = solid.ramp.by_depth.map(|[constant, slope]| {
                        simd.mul_add_e_f32s(simd.splat_f32s(slope), levels[i], simd.splat_f32s(constant))
                    });
                    if let Some(target) = gradients.get_mut(i) {
                        let value = magnitude(simd, solid, &force, by_depth);
                        *target = simd.select_f32s(active, value, *target);
                    }
                    if let (Some(target), Some(rate)) = (changes.get_mut(i), rate) {
                        let value = change(simd, rate, &force, by_depth);
                        *target = simd.select_f32s(active, value, *target);
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: [S::f32s; 3], b: [f32; 3]) -> S::f32s {
    let b = b.map(|part| simd.splat_f32s(part));
    simd.mul_add_e_f32s(a[0], b[0], simd.mul_add_e_f32s(a[1], b[1], simd.mul_f32s(a[2], b[2])))
}

/// |k|: the whole force on the limb.
#[inline(always)]
fn magnitude<S: Simd>(simd: S, solid: &LaneSolid, force: &Force<S>, by_depth: Option<S::f32s>) -> S::f32s {
    let factor = simd.splat_f32s(solid.ramp.factor as f32);
    let [x, y, z] = force.f.map(|f| simd.mul_f32s(f, factor));
    let z = by_depth.map_or(z, |by_depth| simd.add_f32s(z, by_depth));
    simd.sqrt_f32s(simd.mul_add_e_f32s(x, x, simd.mul_add_e_f32s(y, y, simd.mul_f32s(z, z))))
}

/// f·v₀ + g₁·v₁, with v₀ how the solid's start moves, v₁ how its axis does, g₁ = t f + κ h; and the depth's part.
#[inline(always)]
fn change<S: Simd>(simd: S, rate: &SolidRate, force: &Force<S>, by_depth: Option<S::f32s>) -> S::f32s {
    let start = dot(simd, force.f, rate.start);
    let axis = dot(simd, force.f, rate.axis);
    let cap = dot(simd, force.cap, rate.axis);
    let sum = simd.add_f32s(simd.mul_add_e_f32s(force.fraction, axis, start), cap);
    by_depth.map_or(sum, |by_depth| simd.mul_add_e_f32s(by_depth, simd.splat_f32s(rate.depth), sum))
}
