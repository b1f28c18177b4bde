//! The lower envelope of a row's parabolas: m(x) = min over c of (x − c)² + h(c), for all x of a row.
//!
//! The c that is nearest to x never goes back when x goes on (two of the parabolas cross only once), so between two pixels
//! with known nearest columns only the columns between those need be looked at. The search halves the row until blocks of
//! a few vectors of pixels are left; within a block every column between those of its ends is tried for all pixels at once.
//! This is arithmetic without branches, which suits vectors better than the usual stack of parabolas (Felzenszwalb &
//! Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8, 2012), and gives the same numbers:
//! whole ones, and exact, while m < 2²⁴.

use std::ops::Range;

use pulp::Simd;

/// The height of what pads the columns: never the lowest.
const NOWHERE: f32 = f32::MAX;

/// How many vectors of pixels make a block.
const VECTORS: usize = 4;

/// Buffers for one row after the other, for vectors of one kind.
#[derive(Debug)]
pub(super) struct RowSearch<S: Simd> {
    simd: S,
    /// The first column.
    first: usize,
    /// How many columns there are, without the padding.
    columns: usize,
    /// The numbers of the columns from 0 on, as many as a row and a block may have.
    apexes: Vec<f32>,
    /// h of the columns, padded to whole vectors.
    heights: Vec<f32>,
    /// The nearest column of each block's first pixel, and of what follows the last block; counted from the first column.
    nearest: Vec<usize>,
    minima: Vec<f32>,
}

impl<S: Simd> RowSearch<S> {
    /// Pixels that are worked on together.
    const BLOCK: usize = VECTORS * S::F32_LANES;

    /// For rows of at most `width` columns.
    pub(super) fn new(simd: S, width: usize) -> Self {
        let apexes = (0..(width + Self::BLOCK) as i32).map(|column| column as f32).collect();
        Self {
            simd,
            first: 0,
            columns: 0,
            apexes,
            heights: Vec::new(),
            nearest: Vec::new(),
            minima: Vec::new(),
        }
    }

    /// The columns from `first` on have h = min(`above`, `below`)²; at least one.
    #[inline(always)]
    pub(super) fn set_columns(&mut self, first: usize, above: &[i32], below: &[i32]) {
        (self.first, self.columns) = (first, above.len());
        self.heights.clear();
        self.heights.extend(above.iter().zip(below).map(|(&above, &below)| {
            let distance = above.min(below) as f32;
            distance * distance
        }));
        self.heights.resize(above.len() + S::F32_LANES, NOWHERE);
    }

    /// m of the pixels, and perhaps of some beyond the last one.
    #[inline(always)]
    pub(super) fn minima(&mut self, pixels: Range<usize>) -> &[f32] {
        let blocks = pixels.len().div_ceil(Self::BLOCK);
        let at = pixels.start;
        self.nearest.clear();
        self.nearest.resize(blocks + 1, 0);
        self.nearest[0] = self.nearest(0..self.columns - 1, at);
        self.nearest[blocks] = self.nearest(self.nearest[0]..self.columns - 1, at + blocks * Self::BLOCK);
        let mut step = blocks.next_power_of_two() / 2;
        while step > 0 {
            let mut block = step;
            while block < blocks {
                let between = self.nearest[block - step]..self.nearest[(block + step).min(blocks)];
                self.nearest[block] = self.nearest(between, at + block * Self::BLOCK);
                block += 2 * step;
            }
            step /= 2;
        }
        self.minima.resize(blocks * Self::BLOCK, 0.0);
        for block in 0..blocks {
            self.find_minima(block, at + block * Self::BLOCK);
        }
        &self.minima
    }

    /// The column, both ends of the range included, whose parabola is lowest at `x`.
    #[inline(always)]
    fn nearest(&self, between: Range<usize>, x: usize) -> usize {
        let (simd, lanes) = (self.simd, S::F32_LANES);
        let vectors = (between.end - between.start) / lanes + 1;
        let span = between.start..between.start + vectors * lanes;
        let (apexes, _) = S::as_simd_f32s(&self.apexes[self.first + span.start..self.first + span.end]);
        let (heights, _) = S::as_simd_f32s(&self.heights[span]);
        let x = simd.splat_f32s(x as f32);
        let mut best = simd.splat_f32s(f32::INFINITY);
        let mut best_apex = best;
        for (&apex, &height) in apexes.iter().zip(heights) {
            let distance = simd.sub_f32s(x, apex);
            let value = simd.mul_add_e_f32s(distance, distance, height);
            best_apex = simd.select_f32s(simd.less_than_f32s(value, best), apex, best_apex);
            best = simd.min_f32s(value, best);
        }
        let is_lowest = simd.equal_f32s(best, simd.splat_f32s(simd.reduce_min_f32s(best)));
        let apex =
            simd.reduce_min_f32s(simd.select_f32s(is_lowest, best_apex, simd.splat_f32s(f32::INFINITY)));
        // Columns beyond the range come in with the last vector, and may do as well as the range's last.
        (apex as usize).saturating_sub(self.first).clamp(between.start, between.end)
    }

    /// The lowest of the parabolas that come into question, for the pixels of a block, which begins at `x`.
    #[inline(always)]
    fn find_minima(&mut self, block: usize, x: usize) {
        let simd = self.simd;
        let (from, to) = (self.nearest[block], self.nearest[block + 1] + 1);
        let (lane_numbers, _) = S::as_simd_f32s(&self.apexes[..Self::BLOCK]);
        let mut xs = [simd.splat_f32s(x as f32); VECTORS];
        for (x, &lane_number) in xs.iter_mut().zip(lane_numbers) {
            *x = simd.add_f32s(*x, lane_number);
        }
        let mut best = [simd.splat_f32s(f32::INFINITY); VECTORS];
        let apexes = &self.apexes[self.first + from..self.first + to];
        for (&apex, &height) in apexes.iter().zip(&self.heights[from..to]) {
            let (apex, height) = (simd.splat_f32s(apex), simd.splat_f32s(height));
            for (best, &x) in best.iter_mut().zip(&xs) {
                let distance = simd.sub_f32s(x, apex);
                *best = simd.min_f32s(simd.mul_add_e_f32s(distance, distance, height), *best);
            }
        }
        let (minima, _) = S::as_mut_simd_f32s(&mut self.minima[block * Self::BLOCK..][..Self::BLOCK]);
        minima.copy_from_slice(&best);
    }
}
