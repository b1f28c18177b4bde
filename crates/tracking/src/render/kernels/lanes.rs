//! Any solid in f32 lanes: winners, residuals and sums of one camera in one go.
//!
//! Rays are e = (x, y, 1), not normalised, on the plane z = 1. With the first joint p0 = z₀ ê₀, δ = e − ê₀ and
//! the axis in units of that depth, a = z₀ A:
//!
//! | quantity | on a row (y fixed) |
//! |---|---|
//! | e × A = ê₀ × A + δ × A | linear in δx |
//! | e × ê₀ = δ × ê₀ | linear in δx, exact near the joint |
//! | t = −(e × ê₀)·(e × A) / \|e × A\|² | closest point of the axis; clamped to 0 … 1 for round ends |
//! | d² = z₀² \|e × ê₀ + t e × A\|² / \|e\|² | squared distance of the ray |
//!
//! Clamping t takes in the hemispherical ends, since all of the limb lies in front of the camera: views in
//! which it does not are left to [`scalar`](super::scalar). Of equal spheres evenly spread along a limb the
//! nearest is the one whose t is nearest to the closest point's, so they are a capsule with t rounded. A
//! sphere of its own is a capsule without length. A flat cap can be hit only where a sphere of the ramp's reach
//! about its joint is seen, so a cylinder costs more than a capsule only there.
//!
//! Per band of rows: spans and ground (columns that any solid may touch), winners solid by solid, cost, pull
//! solid by solid. On a row a solid touches the interval between the two straight lines that outline the
//! infinite cylinder of its reach, cut to its pixel box. Work grows with the area of these spans.
//!
//! | file | holds |
//! |---|---|
//! | `grid` | one camera's data, packed |
//! | `solid` | constants of a solid, spans |
//! | `ground` | all solids of a view and the columns that they may touch |
//! | `winners` | the darkest solid of every pixel |
//! | `pull` | forces of the pixels that a solid has won, summed |
//! | `sums` | a solid's sums as a block |
//! | `drawing` | whole pictures for the screen |

mod drawing;
mod grid;
mod ground;
mod pull;
mod solid;
mod sums;
mod winners;

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

pub(in crate::render) use drawing::draw;
pub(crate) use grid::PixelGrid;

use self::grid::RowData;
use self::ground::Ground;
use self::pull::Collected;
use self::sums::SUMS;
use self::winners::{Band, Row};
use crate::render::View;
use crate::render::ramp::BACKGROUND;
use crate::render::wrench::WrenchBlock;

/// Pixels of a band: what is known of them stays in the second cache.
const BAND_PIXELS: usize = 4 * 1024;
/// Fewer rows than this would flush their sums too often.
const LEAST_BAND_ROWS: usize = 4;

/// Memory of the kernel, reused from call to call.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lanes {
    ground: Ground,
    band: Band,
    collected: Collected,
    totals: Vec<[f64; SUMS]>,
}

impl Lanes {
    /// Adds every limb's pull and returns Σ w ((D − Λ)² − (D − 255)²): what limbs change of the cost.
    ///
    /// `blocks` has one entry per limb of the model. [`View::suits_lanes`] must hold.
    pub(crate) fn accumulate(&mut self, view: &View, grid: &PixelGrid, blocks: &mut [WrenchBlock]) -> f64 {
        self.prepare(view, grid);
        let cost = Arch::new().dispatch(Pass { lanes: self, grid, pulls: true });
        for (solid, totals) in self.ground.solids.iter().zip(&self.totals) {
            solid.add_to(totals, &mut blocks[solid.limb]);
        }
        cost
    }

    /// The same change of the cost without anyone's pull.
    pub(crate) fn cost(&mut self, view: &View, grid: &PixelGrid) -> f64 {
        self.prepare(view, grid);
        Arch::new().dispatch(Pass { lanes: self, grid, pulls: false })
    }

    /// Looks at every pixel of a view row by row: `see` hears of a row, of the first column that any solid may touch,
    /// and of λ/255 from there on, before clipping. [`View::suits_lanes`] must hold.
    pub(crate) fn look(&mut self, view: &View, see: impl FnMut(usize, usize, &[f32])) {
        let grid = PixelGrid::without_data([view.width(), view.height()]);
        self.prepare(view, &grid);
        Arch::new().dispatch(Look { lanes: self, grid: &grid, see });
    }

    fn prepare(&mut self, view: &View, grid: &PixelGrid) {
        self.ground.prepare(view, grid);
        self.band.resize(grid.band_rows() * grid.pitch);
        self.collected.reserve();
        self.totals.clear();
        self.totals.resize(self.ground.solids.len(), [0.0; SUMS]);
    }
}

impl PixelGrid {
    fn band_rows(&self) -> usize {
        (BAND_PIXELS / self.pitch.max(1)).clamp(LEAST_BAND_ROWS, self.rows.max(LEAST_BAND_ROWS))
    }
}

struct Pass<'a> {
    lanes: &'a mut Lanes,
    grid: &'a PixelGrid,
    pulls: bool,
}

impl WithSimd for Pass<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { lanes, grid, pulls } = self;
        lanes.ground.cut_spans(grid);
        let mut cost = 0.0;
        for first in (0..grid.rows).step_by(grid.band_rows()) {
            let rows = first..(first + grid.band_rows()).min(grid.rows);
            lanes.ground.win_band::<S, false>(simd, &mut lanes.band, rows.clone(), grid);
            cost += lanes.cost_of_band(simd, rows.clone(), grid);
            if pulls {
                lanes.pull_band(simd, rows, grid);
            }
        }
        cost
    }
}

/// [`Lanes::look`] as it is dispatched.
struct Look<'a, F> {
    lanes: &'a mut Lanes,
    grid: &'a PixelGrid,
    see: F,
}

impl<F: FnMut(usize, usize, &[f32])> WithSimd for Look<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { lanes, grid, mut see } = self;
        lanes.ground.cut_spans(grid);
        for first in (0..grid.rows).step_by(grid.band_rows()) {
            let rows = first..(first + grid.band_rows()).min(grid.rows);
            lanes.ground.win_band::<S, false>(simd, &mut lanes.band, rows.clone(), grid);
            for row in rows {
                let [from, to] = lanes.ground.touched[row].map(|column| column as usize);
                if from < to {
                    let start = (row - first) * grid.pitch;
                    see(row, from, &lanes.band.levels[start + from..start + to.min(grid.columns)]);
                }
            }
        }
    }
}

impl Lanes {
    /// Cost of one band of rows, whose winners are known.
    #[inline(always)]
    fn cost_of_band<S: Simd>(&self, simd: S, rows: Range<usize>, grid: &PixelGrid) -> f64 {
        let mut cost = 0.0;
        for row in rows.clone() {
            let here = self.ground.row(row, &rows, grid, self.ground.touched[row]);
            if here.is_touched() {
                cost += row_cost(simd, &here, &self.band, grid.row(row));
            }
        }
        cost
    }

    /// Pull of one band of rows, whose winners are known.
    #[inline(always)]
    fn pull_band<S: Simd>(&mut self, simd: S, rows: Range<usize>, grid: &PixelGrid) {
        let Self { ground, band, collected, totals } = self;
        for (index, (solid, totals)) in ground.solids.iter().zip(totals).enumerate() {
            for row in solid.rows_in(&rows) {
                let here = ground.row(row, &rows, grid, ground.span(solid, row));
                if here.is_touched() {
                    collected.pull_row(simd, (solid, index), &here, band, grid.row(row), totals);
                }
            }
            collected.flush(simd, solid, totals);
        }
    }
}

/// Σ w ((D − Λ)² − (D − 255)²) over the touched pixels of a row.
#[inline(always)]
fn row_cost<S: Simd>(simd: S, row: &Row<'_>, band: &Band, data: RowData<'_>) -> f64 {
    let span = row.columns::<S>();
    let (levels, _) = S::as_simd_f32s(&band.levels[row.start + span.start..row.start + span.end]);
    let (values, _) = S::as_simd_f32s(&data.values[span.clone()]);
    let (weights, _) = S::as_simd_f32s(&data.weights[span]);
    let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
    let white = simd.splat_f32s(BACKGROUND as f32);
    let mut sum = zero;
    for ((&level, &value), &weight) in levels.iter().zip(values).zip(weights) {
        let level = simd.min_f32s(simd.max_f32s(level, zero), one);
        let residual = simd.negate_mul_add_e_f32s(level, white, value);
        let empty = simd.sub_f32s(value, white);
        let squares = simd.negate_mul_add_e_f32s(empty, empty, simd.mul_f32s(residual, residual));
        sum = simd.mul_add_e_f32s(weight, squares, sum);
    }
    f64::from(simd.reduce_sum_f32s(sum))
}
