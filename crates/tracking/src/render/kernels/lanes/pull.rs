//! Pull: what the pixels that a part of a solid has won pull at its two joints, summed.
//!
//! A pixel's gradient acts as a force g₀ at p0 and g₁ at p1. With f = g₀ + g₁ and up to the ramp's factor,
//!
//! | nearest | f | g₁ |
//! |---|---|---|
//! | axis, seen by A and B | S (−D w) + T (D v), S = A²/(A² + B²), T = A B/(A² + B²) | t f |
//! | ball about p0 or p1 | δ = (e·p/\|e\|²) e − p | 0 or f |
//! | axis, round end, equal sphere | δ = (e·q/\|e\|²) e − q, q = p0 + t a | t f |
//! | flat cap at p0 (t = 0) or p1 (t = 1) | h − κ a, κ = (h·e)/(a·e) | t f + κ h |
//!
//! The first two have so few sums that these stay in registers: two numbers a pixel on the axis, and no t on a ball.
//! Tiles with any such pixel are listed before that; what is then done for each needs no branch. Sums in f32 are of a few
//! tiles and go to f64. Of whole solids forces are first collected and then multiplied out in several passes.

use pulp::Simd;

use super::band::{Band, Places};
use super::grid::PixelGrid;
use super::ground::{Ground, SolidPart};
use super::masks::on_ramp;
use super::solid::{AxisSight, LaneSolid, Shape};
use super::sums::{AXIS_SUMS, BALL_SUMS, SolidSums};
use super::whole::{ENTRY, Force, flush, inverse_distance, toward_ray};
use super::winners::AxisLanes;
use crate::render::ramp::BACKGROUND;

/// Tiles whose sums are in f32.
const TILES: usize = 64;
/// Tiles collected before they are summed: these stay in the first cache.
const GROUPS: usize = 48;
/// Widest lanes, in numbers.
const MOST_LANES: usize = 16;

/// Memory of the pull.
#[derive(Debug, Clone, Default)]
pub(super) struct Collected {
    vectors: Vec<f32>,
    groups: usize,
}

/// The winners of a band and its data, as vectors.
struct Pulling<'a, S: Simd> {
    places: Places<'a, S>,
    levels: &'a [S::f32s],
    owners: &'a [S::u32s],
    fractions: &'a [S::f32s],
    values: &'a [S::f32s],
    weights: &'a [S::f32s],
    /// By how many vectors weights advance from tile row to tile row.
    weight_pitch: usize,
}

impl<'a, S: Simd> Pulling<'a, S> {
    #[inline(always)]
    fn new(ground: &'a Ground, band: &'a Band, rows: &std::ops::Range<usize>, grid: &'a PixelGrid) -> Self {
        let ([values, weights], weight_pitch) = grid.band_data(rows.start);
        Self {
            places: Places::new(ground, rows, grid),
            levels: S::as_simd_f32s(&band.levels).0,
            owners: S::as_simd_u32s(&band.owners).0,
            fractions: S::as_simd_f32s(&band.fractions).0,
            values: S::as_simd_f32s(values).0,
            weights: S::as_simd_f32s(weights).0,
            weight_pitch,
        }
    }

    /// Which pixels a part has won and has not clipped.
    #[inline(always)]
    fn active(&self, simd: S, at: usize, owner: S::u32s) -> S::m32s {
        simd.and_m32s(on_ramp(simd, self.levels[at]), simd.equal_u32s(self.owners[at], owner))
    }

    /// A tile's level, w where the part pulls and zero elsewhere, and ρ.
    #[inline(always)]
    fn residual(&self, simd: S, tile: u32, at: usize, owner: S::u32s) -> [S::f32s; 3] {
        let level = self.levels[at];
        let (row, column) = ((tile >> 16) as usize, (tile & 0xffff) as usize);
        let weight = self.weights[row * self.weight_pitch + column];
        let weight = simd.select_f32s(self.active(simd, at, owner), weight, simd.splat_f32s(0.0));
        let white = simd.splat_f32s(BACKGROUND as f32);
        [level, weight, simd.negate_mul_add_e_f32s(level, white, self.values[at])]
    }
}

impl Collected {
    pub(super) fn reserve(&mut self) {
        self.vectors.resize(GROUPS * ENTRY * MOST_LANES, 0.0);
    }

    /// Adds the pull of one band of tile rows, whose winners are known, to the sums of all solids.
    #[inline(always)]
    pub(super) fn pull_band<S: Simd>(
        &mut self,
        simd: S,
        (ground, band): (&Ground, &Band),
        rows: &std::ops::Range<usize>,
        grid: &PixelGrid,
        sums: &mut [SolidSums],
    ) {
        let pulling = Pulling::<S>::new(ground, band, rows, grid);
        for work in &band.works {
            let (solid, sums) = (&ground.solids[work.solid], &mut sums[work.solid]);
            let owner = simd.splat_u32s(work.owner);
            let tiles = &band.tiles[work.tiles.clone()];
            let by_depth = solid.ramp.by_depth;
            match (work.part, &solid.sight) {
                (SolidPart::Axis, Some(sight)) => {
                    let part = (solid, sight);
                    sum_axis(simd, &pulling, part, (owner, tiles), &mut self.vectors, &mut sums.axis);
                }
                (SolidPart::Ball(end), _) => {
                    let sums = &mut sums.balls[end];
                    match by_depth {
                        None => sum_ball::<S, false>(simd, &pulling, (solid, end), owner, tiles, sums),
                        Some(_) => sum_ball::<S, true>(simd, &pulling, (solid, end), owner, tiles, sums),
                    }
                }
                _ => {
                    for &tile in tiles {
                        let (at, rays) = pulling.places.at(tile);
                        let [level, weight, residual] = pulling.residual(simd, tile, at, owner);
                        let force = Force::new(simd, solid, rays, (level, pulling.fractions[at]));
                        let (vectors, _) = S::as_mut_simd_f32s(&mut self.vectors);
                        let entry = &mut vectors[self.groups * ENTRY..(self.groups + 1) * ENTRY];
                        entry[..3].copy_from_slice(&force.f);
                        entry[3] = weight;
                        entry[4] = force.fraction;
                        entry[5] = residual;
                        if let Some(line) = by_depth {
                            entry[6] = depth_rate(simd, line, level);
                        }
                        if matches!(solid.shape, Shape::Cylinder { .. }) {
                            entry[7..].copy_from_slice(&force.cap);
                        }
                        self.groups += 1;
                        if self.groups == GROUPS {
                            flush(simd, &self.vectors, &mut self.groups, solid, &mut sums.whole);
                        }
                    }
                    flush(simd, &self.vectors, &mut self.groups, solid, &mut sums.whole);
                }
            }
        }
    }
}

/// ∂λ/∂z of a solid's depth.
#[inline(always)]
pub(super) fn depth_rate<S: Simd>(simd: S, [constant, slope]: [f32; 2], level: S::f32s) -> S::f32s {
    simd.mul_add_e_f32s(simd.splat_f32s(slope), level, simd.splat_f32s(constant))
}

/// S and T of rays that see an axis at a level, and t; `distance` is of linear ramps, d at λ = 0 and what it rises by.
#[inline(always)]
pub(super) fn axis_force<S: Simd>(
    simd: S,
    axis: &AxisLanes<S>,
    distance: Option<[S::f32s; 2]>,
    rays: [S::f32s; 2],
    level: S::f32s,
) -> ([S::f32s; 2], S::f32s) {
    let rays = axis.see(simd, rays);
    let inverse = simd.div_f32s(simd.splat_f32s(1.0), rays.length);
    let fraction = simd.mul_f32s(rays.along, inverse);
    let scale = match distance {
        Some([start, width]) => simd.div_f32s(inverse, simd.mul_add_e_f32s(level, width, start)),
        None => inverse,
    };
    let a = simd.mul_f32s(rays.a, scale);
    ([simd.mul_f32s(a, rays.a), simd.mul_f32s(a, rays.b)], fraction)
}

/// Sums of an axis: see [`AXIS_SUMS`]. Forces are collected first, so that all sums stay in registers.
#[inline(always)]
fn sum_axis<S: Simd>(
    simd: S,
    pulling: &Pulling<'_, S>,
    (solid, sight): (&LaneSolid, &AxisSight),
    (owner, tiles): (S::u32s, &[u32]),
    vectors: &mut [f32],
    totals: &mut [f64; AXIS_SUMS],
) {
    const ENTRY: usize = 6;
    let axis = AxisLanes::new(simd, solid, sight);
    let [start, width] = solid.ramp.distance;
    let distance = [simd.splat_f32s(start), simd.splat_f32s(width)];
    let distance = if solid.ramp.is_linear { Some(distance) } else { None };
    let (vectors, _) = S::as_mut_simd_f32s(vectors);
    for tiles in tiles.chunks(TILES) {
        for (&tile, entry) in tiles.iter().zip(vectors.chunks_exact_mut(ENTRY)) {
            let (at, rays) = pulling.places.at(tile);
            let [level, weight, residual] = pulling.residual(simd, tile, at, owner);
            let (f, t) = axis_force(simd, &axis, distance, rays, level);
            entry[0] = f[0];
            entry[1] = f[1];
            entry[2] = t;
            entry[3] = weight;
            entry[4] = residual;
            if let Some(line) = solid.ramp.by_depth {
                entry[5] = depth_rate(simd, line, level);
            }
        }
        let entries = &vectors[..tiles.len() * ENTRY];
        let mut sums = [simd.splat_f32s(0.0); 13];
        for entry in entries.chunks_exact(ENTRY) {
            let (f, t, residual) = ([entry[0], entry[1]], entry[2], entry[4]);
            let weighted = [simd.mul_f32s(f[0], entry[3]), simd.mul_f32s(f[1], entry[3])];
            let g = [simd.mul_f32s(f[0], t), simd.mul_f32s(f[1], t)];
            let weighted_g = [simd.mul_f32s(weighted[0], t), simd.mul_f32s(weighted[1], t)];
            for (first, [a, b]) in [(0, [weighted, f]), (3, [weighted_g, f]), (6, [weighted_g, g])] {
                sums[first] = simd.mul_add_e_f32s(a[0], b[0], sums[first]);
                sums[first + 1] = simd.mul_add_e_f32s(a[0], b[1], sums[first + 1]);
                sums[first + 2] = simd.mul_add_e_f32s(a[1], b[1], sums[first + 2]);
            }
            for i in 0..2 {
                sums[9 + i] = simd.mul_add_e_f32s(weighted[i], residual, sums[9 + i]);
                sums[11 + i] = simd.mul_add_e_f32s(weighted_g[i], residual, sums[11 + i]);
            }
        }
        add_totals(simd, sums, &mut totals[..13]);
        if solid.ramp.by_depth.is_some() {
            let mut sums = [simd.splat_f32s(0.0); 6];
            for entry in entries.chunks_exact(ENTRY) {
                let weighted = simd.mul_f32s(entry[5], entry[3]);
                let weighted_t = simd.mul_f32s(weighted, entry[2]);
                for i in 0..2 {
                    sums[i] = simd.mul_add_e_f32s(weighted, entry[i], sums[i]);
                    sums[2 + i] = simd.mul_add_e_f32s(weighted_t, entry[i], sums[2 + i]);
                }
                sums[4] = simd.mul_add_e_f32s(weighted, entry[5], sums[4]);
                sums[5] = simd.mul_add_e_f32s(weighted, entry[4], sums[5]);
            }
            add_totals(simd, sums, &mut totals[13..]);
        }
    }
}

/// δ of rays that see a ball at a level; over its length for linear ramps.
#[inline(always)]
pub(super) fn ball_force<S: Simd>(
    simd: S,
    (solid, end): (&LaneSolid, usize),
    rays: [S::f32s; 2],
    level: S::f32s,
) -> [S::f32s; 3] {
    let joint = &solid.joints[end];
    let point = [joint.x * joint.z, joint.y * joint.z, joint.z].map(|part| simd.splat_f32s(part));
    let f = toward_ray(simd, point, rays);
    if solid.ramp.is_linear {
        let inverse = inverse_distance(simd, solid, level);
        f.map(|f| simd.mul_f32s(f, inverse))
    } else {
        f
    }
}

/// Sums of a ball: see [`BALL_SUMS`].
#[inline(always)]
fn sum_ball<S: Simd, const DEPTHS: bool>(
    simd: S,
    pulling: &Pulling<'_, S>,
    part: (&LaneSolid, usize),
    owner: S::u32s,
    tiles: &[u32],
    totals: &mut [f64; BALL_SUMS],
) {
    for tiles in tiles.chunks(TILES) {
        let mut sums = [simd.splat_f32s(0.0); 9];
        let mut depths = [simd.splat_f32s(0.0); 5];
        for &tile in tiles {
            let (at, rays) = pulling.places.at(tile);
            let [level, weight, residual] = pulling.residual(simd, tile, at, owner);
            let f = ball_force(simd, part, rays, level);
            let weighted = f.map(|f| simd.mul_f32s(f, weight));
            for (slot, (i, j)) in PAIRS.into_iter().enumerate() {
                sums[slot] = simd.mul_add_e_f32s(weighted[i], f[j], sums[slot]);
            }
            for i in 0..3 {
                sums[6 + i] = simd.mul_add_e_f32s(weighted[i], residual, sums[6 + i]);
            }
            if DEPTHS && let Some(line) = part.0.ramp.by_depth {
                let c = depth_rate(simd, line, level);
                for i in 0..3 {
                    depths[i] = simd.mul_add_e_f32s(weighted[i], c, depths[i]);
                }
                let weighted = simd.mul_f32s(c, weight);
                depths[3] = simd.mul_add_e_f32s(weighted, c, depths[3]);
                depths[4] = simd.mul_add_e_f32s(weighted, residual, depths[4]);
            }
        }
        add_totals(simd, sums, &mut totals[..9]);
        if DEPTHS {
            add_totals(simd, depths, &mut totals[9..]);
        }
    }
}

/// Pairs of a symmetric 3 × 3 matrix, its upper triangle row by row.
pub(super) const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Adds sums of lanes to totals in f64.
#[inline(always)]
pub(super) fn add_totals<S: Simd, const N: usize>(simd: S, sums: [S::f32s; N], totals: &mut [f64]) {
    for (total, sum) in totals.iter_mut().zip(sums) {
        *total += f64::from(simd.reduce_sum_f32s(sum));
    }
}
