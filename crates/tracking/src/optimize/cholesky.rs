//! A = L D Lᵀ for small symmetric positive matrices, in f64 lanes, without allocation once its memory has grown.
//!
//! A pose has some tens of columns: what costs elsewhere is the start and end of many short loops, and waiting for one
//! root or quotient after the other; L of unit diagonal needs no root. The matrix is cut into blocks of four columns and
//! four rows, a panel being the blocks of four columns: right-looking, a panel is factored and then taken off what is after
//! it, block by block, in loops of fixed length.
//!
//! Columns are taken from the last to the first. A body is a tree whose root comes first, so that limbs of different
//! branches have no product; eliminated from the leaves on they get none, and blocks of zeros are passed over.

#![expect(clippy::needless_range_loop, reason = "blocks are written by their rows and columns")]

use nalgebra::{DMatrix, DVector};
use pulp::{Simd, WithSimd};

use crate::processor::run_in_four_f64s;

/// Columns of a panel, and rows of a group: lanes are never wider.
const PANEL: usize = 4;

/// Rows of a column, or columns of a row.
type Quad = [f64; PANEL];
/// Four columns of four rows.
type Block = [Quad; PANEL];

/// L and D of A = L D Lᵀ, with memory that is used again from step to step.
#[derive(Debug, Clone, Default)]
pub struct Cholesky {
    /// L, panel by panel, its rows and columns from the last to the first; above the diagonal anything.
    factor: Vec<Block>,
    /// 1/D.
    inverse: Vec<Quad>,
    panels: usize,
    /// By panel and group of rows, whether the block is not all zero.
    filled: Vec<bool>,
    /// Panel by panel, its groups of rows below the diagonal that are not all zero, and where in it each panel ends.
    below: Vec<u32>,
    ends: Vec<usize>,
    /// Scratch: L D of the groups below a panel.
    scaled: Vec<Block>,
    /// Right-hand side and solution, padded.
    solution: Vec<Quad>,
}

impl Cholesky {
    /// Factors `matrix` + `added(column)` on its diagonal. Only the upper triangle is read. False if it is not positive:
    /// there is no factor then.
    pub(crate) fn factor(&mut self, matrix: &DMatrix<f64>, added: impl Fn(usize) -> f64) -> bool {
        let n = matrix.nrows();
        let panels = n.div_ceil(PANEL);
        if self.panels != panels {
            self.panels = panels;
            self.factor = vec![Block::default(); panels * panels];
            self.inverse = vec![Quad::default(); panels];
            self.filled = vec![false; panels * panels];
            self.scaled = vec![Block::default(); panels];
            self.solution = vec![Quad::default(); panels];
        }
        self.below.clear();
        self.below.reserve(panels * panels);
        self.ends.clear();
        run_in_four_f64s(Factor { cholesky: self, matrix: matrix.as_slice(), n, added })
    }

    /// Solves A x = `right` with the last factor.
    pub(crate) fn solve(&mut self, right: &DVector<f64>, solution: &mut DVector<f64>) {
        let n = right.len();
        let values = self.solution.as_flattened_mut();
        values[..n].iter_mut().zip(right.iter().rev()).for_each(|(x, right)| *x = *right);
        values[n..].fill(0.0);
        run_in_four_f64s(Solve { cholesky: self });
        let values = self.solution.as_flattened();
        solution.iter_mut().zip(values[..n].iter().rev()).for_each(|(target, x)| *target = *x);
    }
}

struct Factor<'a, F> {
    cholesky: &'a mut Cholesky,
    matrix: &'a [f64],
    n: usize,
    added: F,
}

impl<F: Fn(usize) -> f64> WithSimd for Factor<'_, F> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { cholesky, matrix, n, added } = self;
        let Cholesky { factor, inverse, panels, filled, below, ends, scaled, .. } = cholesky;
        let panels = *panels;
        for panel in 0..panels {
            for group in panel..panels {
                let block = block_of(matrix, n, [group, panel]);
                filled[panel * panels + group] = !is_zero(&block);
                factor[panel * panels + group] = block;
            }
            let diagonal = &mut factor[panel * panels + panel];
            for column in 0..PANEL {
                let index = panel * PANEL + column;
                diagonal[column][column] += if index < n { added(n - 1 - index) } else { 1.0 };
            }
        }
        for panel in 0..panels {
            let (own, after) = factor[panel * panels..].split_at_mut(panels);
            let Some((diagonal, reciprocals)) = factor_diagonal(own[panel]) else { return false };
            (own[panel], inverse[panel]) = (diagonal, reciprocals);
            let first = below.len();
            below.extend(
                (panel + 1..panels).filter(|group| filled[panel * panels + group]).map(|group| group as u32),
            );
            ends.push(below.len());
            let below = &below[first..];
            for (&group, scaled) in below.iter().zip(&mut *scaled) {
                let block = &mut own[group as usize];
                factor_group(simd, block, scaled, &diagonal, &reciprocals);
            }
            for (place, (&column, scaled)) in below.iter().zip(&*scaled).enumerate() {
                let column = column as usize;
                for &group in &below[place..] {
                    let group = group as usize;
                    filled[column * panels + group] = true;
                    let target = &mut after[(column - panel - 1) * panels + group];
                    take_off(simd, target, &own[group], scaled);
                }
            }
        }
        true
    }
}

/// A block of the matrix with its rows and columns from the last to the first; zeros beyond.
#[inline(always)]
fn block_of(matrix: &[f64], n: usize, [group, panel]: [usize; 2]) -> Block {
    let mut block = Block::default();
    let (rows, columns) = (group * PANEL, panel * PANEL);
    for (offset, column) in block.iter_mut().enumerate() {
        if columns + offset >= n {
            continue;
        }
        let entries = &matrix[(n - 1 - columns - offset) * n..][..n - rows];
        if let Some(&[d, c, b, a]) = entries.last_chunk::<PANEL>() {
            *column = [a, b, c, d];
        } else {
            column.iter_mut().zip(entries.iter().rev()).for_each(|(target, entry)| *target = *entry);
        }
    }
    block
}

/// Whether a block is all zeros, of either sign.
#[inline(always)]
fn is_zero(block: &Block) -> bool {
    let mut bits = [0; PANEL];
    for column in block {
        for row in 0..PANEL {
            bits[row] |= column[row].to_bits();
        }
    }
    (bits[0] | bits[1] | bits[2] | bits[3]) << 1 == 0
}

/// L of a block on the diagonal, and 1/D; none if it is not positive.
#[inline(always)]
fn factor_diagonal(mut block: Block) -> Option<(Block, Quad)> {
    let mut reciprocals = Quad::default();
    for k in 0..PANEL {
        let pivot = block[k][k];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return None;
        }
        reciprocals[k] = 1.0 / pivot;
        for column in k + 1..PANEL {
            let factor = block[k][column] * reciprocals[k];
            for row in column..PANEL {
                block[column][row] -= factor * block[k][row];
            }
        }
        for row in k + 1..PANEL {
            block[k][row] *= reciprocals[k];
        }
    }
    Some((block, reciprocals))
}

/// Makes a block below the diagonal L, and `scaled` L D.
#[inline(always)]
fn factor_group<S: Simd>(simd: S, block: &mut Block, scaled: &mut Block, diagonal: &Block, inverse: &Quad) {
    let mut columns = *block;
    for k in 0..PANEL {
        let (before, rest) = columns.split_at_mut(k);
        for (m, before) in before.iter().enumerate() {
            subtract(simd, &mut rest[0], diagonal[m][k], before);
        }
    }
    *scaled = columns;
    for k in 0..PANEL {
        let factor = simd.splat_f64s(inverse[k]);
        let (target, column) = (S::as_mut_simd_f64s(&mut block[k]).0, S::as_simd_f64s(&columns[k]).0);
        for (target, &column) in target.iter_mut().zip(column) {
            *target = simd.mul_f64s(column, factor);
        }
    }
}

/// Takes L D Lᵀ of two groups of a panel off the block where they meet.
#[inline(always)]
fn take_off<S: Simd>(simd: S, target: &mut Block, rows: &Block, scaled: &Block) {
    for column in 0..PANEL {
        for k in 0..PANEL {
            subtract(simd, &mut target[column], scaled[k][column], &rows[k]);
        }
    }
}

/// target −= factor · row.
#[inline(always)]
fn subtract<S: Simd>(simd: S, target: &mut Quad, factor: f64, row: &Quad) {
    let factor = simd.splat_f64s(factor);
    let (target, row) = (S::as_mut_simd_f64s(target).0, S::as_simd_f64s(row).0);
    for (target, &row) in target.iter_mut().zip(row) {
        *target = simd.negate_mul_add_e_f64s(factor, row, *target);
    }
}

struct Solve<'a> {
    cholesky: &'a mut Cholesky,
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Cholesky { factor, inverse, panels, below, ends, solution: x, .. } = self.cholesky;
        let panels = *panels;
        let of_panel = |panel: usize| {
            let below = &below[if panel == 0 { 0 } else { ends[panel - 1] }..ends[panel]];
            (&factor[panel * panels..(panel + 1) * panels], below)
        };
        for panel in 0..panels {
            let (blocks, below) = of_panel(panel);
            let (mut own, diagonal) = (x[panel], &blocks[panel]);
            for k in 0..PANEL {
                for row in k + 1..PANEL {
                    own[row] -= own[k] * diagonal[k][row];
                }
            }
            x[panel] = own;
            for &group in below {
                let (target, block) = (&mut x[group as usize], &blocks[group as usize]);
                for k in 0..PANEL {
                    subtract(simd, target, own[k], &block[k]);
                }
            }
        }
        for panel in (0..panels).rev() {
            let (blocks, below) = of_panel(panel);
            let mut sums = Block::default();
            for &group in below {
                let (values, block) = (S::as_simd_f64s(&x[group as usize]).0, &blocks[group as usize]);
                for k in 0..PANEL {
                    let sums = S::as_mut_simd_f64s(&mut sums[k]).0;
                    for ((sum, &value), &entry) in
                        sums.iter_mut().zip(values).zip(S::as_simd_f64s(&block[k]).0)
                    {
                        *sum = simd.mul_add_e_f64s(entry, value, *sum);
                    }
                }
            }
            let (mut own, diagonal) = (Quad::default(), &blocks[panel]);
            for k in (0..PANEL).rev() {
                let [a, b, c, d] = sums[k];
                own[k] = x[panel][k] * inverse[panel][k] - ((a + b) + (c + d));
                for row in k + 1..PANEL {
                    own[k] -= own[row] * diagonal[k][row];
                }
            }
            x[panel] = own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A positive matrix whose entries follow no pattern.
    fn matrix(n: usize) -> DMatrix<f64> {
        let half = DMatrix::from_fn(n, n + 3, entry);
        &half * half.transpose() + DMatrix::identity(n, n) * 0.1
    }

    /// The same with two branches of a tree, rows 7 to 22 and those from 23 on, without a product between them.
    fn branched(n: usize) -> DMatrix<f64> {
        let is_apart = |i: usize, j: usize| i >= 7 && (i < 23) != (j < 23);
        let half = DMatrix::from_fn(n, n + 3, |i, j| if is_apart(i, j) { 0.0 } else { entry(i, j) });
        &half * half.transpose() + DMatrix::identity(n, n) * 0.1
    }

    fn entry(i: usize, j: usize) -> f64 {
        ((i * 37 + j * 101) as f64 * 0.618).sin()
    }

    #[test]
    fn solutions_are_those_of_a_library() {
        let mut cholesky = Cholesky::default();
        for n in [1, 2, 3, 4, 5, 8, 27, 33, 43, 48, 63, 5] {
            let (matrix, added) = (if n == 43 { branched(n) } else { matrix(n) }, 0.3);
            let right = DVector::from_fn(n, |i, _| (i as f64 * 1.7).cos());
            assert!(cholesky.factor(&matrix, |_| added));
            let mut found = DVector::zeros(n);
            cholesky.solve(&right, &mut found);
            let expected = (matrix + DMatrix::identity(n, n) * added).cholesky().unwrap().solve(&right);
            assert!((&found - &expected).amax() <= 1e-10 * expected.amax(), "{n}: {found} {expected}");
        }
    }

    #[test]
    fn matrices_that_are_not_positive_have_no_factor() {
        let mut cholesky = Cholesky::default();
        for n in [1, 7, 20] {
            let mut spoilt = matrix(n);
            spoilt[(n - 1, n - 1)] = -1.0;
            assert!(!cholesky.factor(&spoilt, |_| 0.0));
            spoilt[(n - 1, n - 1)] = f64::NAN;
            assert!(!cholesky.factor(&spoilt, |_| 0.0));
            assert!(cholesky.factor(&matrix(n), |_| 0.0));
        }
    }
}
