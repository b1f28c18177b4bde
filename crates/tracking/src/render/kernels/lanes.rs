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
//! Where the axis passes the camera at some distance a capsule is three parts, which compete for pixels as if they
//! were solids: its axis between the joints and a ball about each. With w the unit vector from the camera to the
//! infinite axis at distance D, â the axis's direction, v = â × w, A = e·v and B = e·w (linear in x and y),
//! d² = D² A²/(A² + B²), and t from 0 to 1 tells whether the axis is seen at all.
//!
//! A vector is a tile of the picture, four columns wide. Per band of tile rows: spans of tiles that a part may touch,
//! cut by straight lines and by the outlines of balls; of them those that no solid darkens altogether are listed part by
//! part, without a branch; winners part by part; cost; pull part by part, of the tiles that have any. Work grows with the
//! area of the ramps.

mod band;
mod drawing;
mod grid;
mod ground;
mod masks;
mod outline;
mod pull;
mod solid;
mod sums;
mod whole;
mod winners;

use std::cell::Cell;
use std::ops::Range;

use pulp::{Simd, WithSimd};

pub(in crate::render) use drawing::draw;
pub(crate) use grid::PixelGrid;

use self::band::Band;
use self::ground::Ground;
use self::pull::Collected;
use self::sums::SolidSums;
use crate::processor::run_in_lanes;
use crate::render::View;
use crate::render::wrench::WrenchBlock;

/// Pixels of a band: what is known of them stays in the second cache.
const BAND_PIXELS: usize = 32 * 1024;

/// Memory of the kernel, reused from call to call.
#[derive(Debug, Clone, Default)]
pub(crate) struct Lanes {
    ground: Ground,
    sums: Vec<SolidSums>,
}

/// A thread's buffers for one picture. One set serves all cameras and all fits: it stays in the second cache, and a fit
/// that begins has no fresh memory to clear.
#[derive(Debug, Default)]
struct Scratch {
    band: Band,
    collected: Collected,
}

thread_local! {
    static SCRATCH: Cell<Scratch> = Cell::default();
}

impl Scratch {
    /// Does work with the thread's buffers. Work within work has buffers of its own.
    fn with<T>(grid: &PixelGrid, work: impl FnOnce(&mut Self) -> T) -> T {
        let mut scratch = SCRATCH.take();
        scratch.band.resize(grid.band_tile_rows() * grid.entries(), false);
        scratch.collected.reserve();
        let found = work(&mut scratch);
        SCRATCH.set(scratch);
        found
    }
}

impl Lanes {
    /// Adds every limb's pull to `blocks`, one entry per limb of the model, if these are given, and returns
    /// Σ w ((D − Λ)² − (D − 255)²): what limbs change of the cost. [`View::suits_lanes`] must hold.
    pub(crate) fn accumulate(
        &mut self,
        view: &View,
        grid: &PixelGrid,
        blocks: Option<&mut [WrenchBlock]>,
    ) -> f64 {
        self.prepare(view, grid);
        let pulls = blocks.is_some();
        let cost = Scratch::with(grid, |scratch| {
            run_in_lanes(grid.tile.lanes(), Pass { lanes: self, scratch, grid, pulls })
        });
        if let Some(blocks) = blocks {
            for (solid, sums) in self.ground.solids.iter().zip(&self.sums) {
                solid.add_to(sums, &mut blocks[solid.limb]);
            }
        }
        cost
    }

    /// Looks at every pixel of a view row by row: `see` hears of a row, of the first column that any solid may touch,
    /// and of λ/255 from there on, before clipping. [`View::suits_lanes`] must hold.
    pub(crate) fn visit(&mut self, view: &View, see: impl FnMut(usize, usize, &[f32])) {
        let grid = PixelGrid::without_data(view.size);
        self.prepare(view, &grid);
        Scratch::with(&grid, |scratch| {
            run_in_lanes(grid.tile.lanes(), Visit { lanes: self, scratch, grid: &grid, see });
        });
    }

    fn prepare(&mut self, view: &View, grid: &PixelGrid) {
        self.ground.prepare(view, grid);
        self.sums.clear();
        self.sums.resize(self.ground.solids.len(), SolidSums::default());
    }
}

impl PixelGrid {
    fn band_tile_rows(&self) -> usize {
        (BAND_PIXELS / self.entries().max(1)).clamp(1, self.tile_rows().max(1))
    }

    fn bands(&self) -> impl Iterator<Item = Range<usize>> {
        let (all, step) = (self.tile_rows(), self.band_tile_rows());
        (0..all).step_by(step).map(move |first| first..(first + step).min(all))
    }
}

struct Pass<'a> {
    lanes: &'a mut Lanes,
    scratch: &'a mut Scratch,
    grid: &'a PixelGrid,
    pulls: bool,
}

impl WithSimd for Pass<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { lanes: Lanes { ground, sums }, scratch: Scratch { band, collected }, grid, pulls } = self;
        ground.cut_spans::<S, true>(simd, grid.tile_rows());
        let mut cost = 0.0;
        for rows in grid.bands() {
            ground.win_band::<S, false>(simd, band, &rows, grid);
            if pulls {
                cost += band.settle::<S, true>(simd, ground, &rows, grid);
                collected.pull_band(simd, (&*ground, &*band), &rows, grid, sums);
            } else {
                cost += band.settle::<S, false>(simd, ground, &rows, grid);
            }
        }
        cost
    }
}

/// [`Lanes::look`] as it is dispatched.
struct Visit<'a, F> {
    lanes: &'a mut Lanes,
    scratch: &'a mut Scratch,
    grid: &'a PixelGrid,
    see: F,
}

impl<F: FnMut(usize, usize, &[f32])> WithSimd for Visit<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { lanes: Lanes { ground, .. }, scratch: Scratch { band, .. }, grid, mut see } = self;
        ground.cut_spans::<S, true>(simd, grid.tile_rows());
        let mut line = Vec::new();
        for rows in grid.bands() {
            ground.win_band::<S, false>(simd, band, &rows, grid);
            for (row, columns, tile_row) in ground.touched_rows(&rows, grid) {
                grid.untile(&band.levels, (tile_row, row), columns.clone(), &mut line);
                see(row, columns.start, &line);
            }
        }
    }
}
