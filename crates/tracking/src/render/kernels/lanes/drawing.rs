//! Whole pictures in lanes: λ and owner of every pixel, how strongly it pulls, how it changes along a motion.
//!
//! The winners are the fit's; beside them the second darkest is kept. Pixels about which f32 may be wrong are decided
//! again by [`scalar`](super::super::scalar)'s arithmetic: where two solids, or a solid and the background, are as
//! dark as each other; where a ramp begins; where rounding decides which part of a solid is nearest; all of a
//! ramp that is so steep that the rounding of the ray would show. A pixel never depends on its neighbours, so that bands
//! and threads change nothing.

use std::ops::Range;

use glam::DVec3;
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::band::{Band, Places, solid_of};
use super::grid::PixelGrid;
use super::ground::{Ground, SolidPart};
use super::masks::{lane_bits, on_ramp, put_f32s};
use super::pull::{axis_force, ball_force, depth_rate};
use super::solid::LaneSolid;
use super::whole::Force;
use super::winners::AxisLanes;
use crate::processor::run_in_lanes;
use crate::render::View;
use crate::render::drawing::{DrawOptions, Drawing, MOST_ERROR, Strip};
use crate::render::footprint::Footprint;
use crate::render::jacobian::BodyMotion;
use crate::render::prediction::NO_OWNER;
use crate::render::primitive::Solid;
use crate::render::ramp::BACKGROUND;

/// Bands that a thread takes at once.
const LEAST_BANDS: usize = 4;

/// Fills the pictures of a drawing, in which all but the `stale` pixels are background. [`View::suits_lanes`] must hold.
pub(in crate::render) fn draw(
    view: &View,
    wanted: DrawOptions<'_>,
    drawing: &mut Drawing,
    stale: &Footprint,
) {
    let grid = PixelGrid::without_data(view.size);
    let mut ground = Ground::default();
    ground.prepare(view, &grid);
    run_in_lanes(grid.tile.lanes(), CutSpans { ground: &mut ground, grid: &grid });
    let primitives = &view.primitives;
    let limbs = ground.solids.iter().map(|solid| solid.limb as u16).collect();
    let rates = wanted.motion.map(|motion| {
        let solids = ground.solids.iter();
        solids.map(|solid| SolidRate::new(solid, &primitives[solid.primitive].solid, motion)).collect()
    });
    let error = ground.solids.iter().map(|solid| solid.error).fold(0.0, f32::max);
    let plan = Plan { ground, grid, view, wanted, limbs, rates, error };
    let strips = drawing.strips(plan.grid.band_tile_rows() * plan.grid.tile.rows, stale);
    let draw = |scratch: &mut DrawScratch, strip: Strip<'_>| {
        run_in_lanes(plan.grid.tile.lanes(), DrawBand { plan: &plan, scratch, strip });
    };
    strips.into_par_iter().with_min_len(LEAST_BANDS).for_each_init(DrawScratch::default, draw);
}

struct CutSpans<'a> {
    ground: &'a mut Ground,
    grid: &'a PixelGrid,
}

impl WithSimd for CutSpans<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.ground.cut_spans::<S, false>(simd, self.grid.tile_rows());
    }
}

/// What all bands of a view share.
struct Plan<'a> {
    ground: Ground,
    grid: PixelGrid,
    view: &'a View,
    wanted: DrawOptions<'a>,
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
        let (velocity, moved) = motion.in_camera(solid.limb);
        let ([p0, p1], [from, to]) = (shape.joints, shape.axis());
        let (start, axis, limb_axis) = (from - p0, to - from, p1 - p0);
        let factor = solid.ramp.factor;
        let numbers = |rate: DVec3| (rate * factor).as_vec3().to_array();
        Self {
            start: numbers(velocity + moved(start)),
            axis: numbers(moved(axis)),
            depth: (velocity.z + 0.5 * moved(limb_axis).z) as f32,
        }
    }
}

/// A thread's memory.
#[derive(Debug, Default)]
struct DrawScratch {
    band: Band,
    gradients: Vec<f32>,
    changes: Vec<f32>,
    /// What is known of one row, in the order of its columns.
    levels: Vec<f32>,
    owners: Vec<u32>,
    runners_up: Vec<f32>,
    derived: Vec<f32>,
}

struct DrawBand<'a> {
    plan: &'a Plan<'a>,
    scratch: &'a mut DrawScratch,
    strip: Strip<'a>,
}

impl WithSimd for DrawBand<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { plan, scratch, mut strip } = self;
        let Plan { ground, grid, view, wanted, .. } = plan;
        let side = grid.tile.rows;
        let tile_rows = strip.rows().start / side..strip.rows().end.div_ceil(side);
        scratch.band.resize(grid.band_tile_rows() * grid.entries(), true);
        ground.win_band::<S, true>(simd, &mut scratch.band, &tile_rows, grid);
        if wanted.gradient || wanted.motion.is_some() {
            scratch.derive_band(simd, plan, &tile_rows);
        }
        let mut touched = ground.touched_rows(&tile_rows, grid).peekable();
        for row in strip.rows() {
            let Some((_, columns, tile_row)) = touched.next_if(|touched| touched.0 == row) else {
                strip.clear(row, 0..0);
                continue;
            };
            strip.clear(row, columns.clone());
            scratch.put_row(plan, &mut strip, (tile_row, row), columns.clone());
            let DrawScratch { levels, runners_up, .. } = &*scratch;
            doubts(simd, plan.error, (levels, runners_up), |column| {
                strip.put_exactly(view, *wanted, columns.start + column, row);
            });
        }
    }
}

impl DrawScratch {
    /// Copies what is known of a row's columns to the pictures.
    #[inline(always)]
    fn put_row(
        &mut self,
        plan: &Plan<'_>,
        strip: &mut Strip<'_>,
        (tile_row, row): (usize, usize),
        columns: Range<usize>,
    ) {
        let Self { band, gradients, changes, levels, owners, runners_up, derived } = self;
        let (grid, place, out) = (&plan.grid, (tile_row, row), strip.row(row));
        grid.untile(&band.levels, place, columns.clone(), levels);
        grid.untile(&band.owners, place, columns.clone(), owners);
        grid.untile(&band.runners_up, place, columns.clone(), runners_up);
        for (lambda, level) in out.lambda[columns.clone()].iter_mut().zip(levels) {
            *lambda = BACKGROUND as f32 * level.clamp(0.0, 1.0);
        }
        for (owner, part) in out.owner[columns.clone()].iter_mut().zip(owners) {
            *owner = plan.limbs.get(solid_of(*part)).copied().unwrap_or(NO_OWNER);
        }
        for (values, target) in [(&*gradients, out.gradient), (&*changes, out.change)] {
            if !target.is_empty() {
                grid.untile(values, place, columns.clone(), derived);
                target[columns.clone()].copy_from_slice(derived);
            }
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
        if lane_bits(simd, simd.or_m32s(is_tied, is_at_end)) != 0 {
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

impl DrawScratch {
    /// How strongly the pixels of a band pull and how they change, where that is wanted; zero where they do not.
    #[inline(always)]
    fn derive_band<S: Simd>(&mut self, simd: S, plan: &Plan<'_>, rows: &Range<usize>) {
        let Plan { ground, grid, wanted, rates, .. } = plan;
        let Self { band, gradients, changes, .. } = self;
        let pixels = rows.len() * grid.entries();
        for (values, is_wanted) in [(&mut *gradients, wanted.gradient), (&mut *changes, rates.is_some())] {
            values.clear();
            values.resize(if is_wanted { pixels } else { 0 }, 0.0);
        }
        let (gradients, _) = S::as_mut_simd_f32s(gradients);
        let (changes, _) = S::as_mut_simd_f32s(changes);
        let places = Places::<S>::new(ground, rows, grid);
        let (levels, _) = S::as_simd_f32s(&band.levels);
        let (owners, _) = S::as_simd_u32s(&band.owners);
        let (fractions, _) = S::as_simd_f32s(&band.fractions);
        for work in &band.works {
            let solid = &ground.solids[work.solid];
            let rate = rates.as_ref().map(|rates| &rates[work.solid]);
            let owner = simd.splat_u32s(work.owner);
            for &tile in &band.tiles[work.tiles.clone()] {
                let (at, rays) = places.at(tile);
                let level = levels[at];
                let active = simd.and_m32s(on_ramp(simd, level), simd.equal_u32s(owners[at], owner));
                if lane_bits(simd, active) == 0 {
                    continue;
                }
                let force = Force::of_part(simd, (solid, work.part), rays, (level, fractions[at]));
                let by_depth = solid.ramp.by_depth.map(|line| depth_rate(simd, line, level));
                if let Some(target) = gradients.get_mut(at) {
                    let value = magnitude(simd, solid, &force, by_depth);
                    put_f32s(simd, target, active, value);
                }
                if let (Some(target), Some(rate)) = (changes.get_mut(at), rate) {
                    let value = change(simd, rate, &force, by_depth);
                    put_f32s(simd, target, active, value);
                }
            }
        }
    }
}

impl<S: Simd> Force<S> {
    /// Of rays that see a part of a solid at a level; a whole solid also at a fraction.
    #[inline(always)]
    fn of_part(
        simd: S,
        (solid, part): (&LaneSolid, SolidPart),
        rays: [S::f32s; 2],
        (level, fraction): (S::f32s, S::f32s),
    ) -> Self {
        let cap = [simd.splat_f32s(0.0); 3];
        match (part, &solid.sight) {
            (SolidPart::Axis, Some(sight)) => {
                let axis = AxisLanes::new(simd, solid, sight);
                let distance = solid.ramp.distance.map(|part| simd.splat_f32s(part));
                let distance = if solid.ramp.is_linear { Some(distance) } else { None };
                let ([s, t], fraction) = axis_force(simd, &axis, distance, rays, level);
                let [b, c] = sight.basis.map(|b| b.as_vec3().to_array());
                let f = [0, 1, 2].map(|axis| {
                    let part = simd.mul_f32s(s, simd.splat_f32s(b[axis]));
                    simd.mul_add_e_f32s(t, simd.splat_f32s(c[axis]), part)
                });
                Self { f, cap, fraction }
            }
            (SolidPart::Ball(end), _) => {
                let f = ball_force(simd, (solid, end), rays, level);
                Self { f, cap, fraction: simd.splat_f32s(end as f32) }
            }
            _ => Self::new(simd, solid, rays, (level, fraction)),
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
