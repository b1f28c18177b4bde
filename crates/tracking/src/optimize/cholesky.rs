//! A = L D Lᵀ for small symmetric positive matrices, in f64 lanes, without allocation once its memory has grown.
//!
//! A pose has some tens of columns: what costs elsewhere is the start and end of many short loops, and waiting for one
//! root or quotient after the other; L of unit diagonal needs no root. Panels of four columns, left-looking: a
//! panel first takes off what the columns before it say, four columns at a time, then its own four are factored.
//!
//! Columns are taken from the last to the first. A body is a tree whose root comes first, so that limbs of different
//! branches have no product; eliminated from the leaves on they get none, and blocks of zeros are passed over.

use nalgebra::{DMatrix, DVector};
use pulp::{Simd, WithSimd};

use crate::processor::run_in_four_f64s;

/// Columns of a panel, and rows of a group: lanes are never wider.
const PANEL: usize = 4;

/// L and D of A = L D Lᵀ, with memory that is used again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cholesky {
    /// L, column-major, `pitch` × `pitch`, its rows and columns from the last to the first; above the diagonal
    /// anything.
    factor: Vec<f64>,
    /// D and 1/D.
    diagonal: Vec<f64>,
    inverse: Vec<f64>,
    /// By group of rows, the panels in which it is not all zero.
    filled: Vec<Vec<bool>>,
    pitch: usize,
    /// Right-hand side and solution, padded.
    solution: Vec<f64>,
}

impl Cholesky {
    /// Factors `matrix` + `added(column)` on its diagonal. Only the upper triangle is read. False if it is not positive:
    /// there is no factor then.
    pub(crate) fn factor(&mut self, matrix: &DMatrix<f64>, added: impl Fn(usize) -> f64) -> bool {
        let n = matrix.nrows();
        let pitch = n.next_multiple_of(PANEL);
        if self.pitch != pitch {
            self.pitch = pitch;
            self.factor = vec![0.0; pitch * pitch];
            self.diagonal = vec![0.0; pitch];
            self.inverse = vec![0.0; pitch];
            self.filled = vec![vec![false; pitch / PANEL]; pitch / PANEL];
            self.solution = vec![0.0; pitch];
        }
        run_in_four_f64s(Factor { cholesky: self, matrix: matrix.as_slice(), n, added })
    }

    /// Solves A x = `right` with the last factor.
    pub(crate) fn solve(&mut self, right: &DVector<f64>, solution: &mut DVector<f64>) {
        let n = right.len();
        self.solution[..n].iter_mut().zip(right.iter().rev()).for_each(|(x, right)| *x = *right);
        self.solution[n..].fill(0.0);
        run_in_four_f64s(Solve { cholesky: self });
        solution.iter_mut().zip(self.solution[..n].iter().rev()).for_each(|(target, x)| *target = *x);
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
        let Self { cholesky: Cholesky { factor, diagonal, inverse, filled, pitch, .. }, matrix, n, added } =
            self;
        let pitch = *pitch;
        for (column, target) in factor.chunks_exact_mut(pitch).enumerate() {
            if column < n {
                let last = n - 1 - column;
                let entries = matrix[last * n..last * n + last + 1].iter().rev();
                target[column..n].iter_mut().zip(entries).for_each(|(target, entry)| *target = *entry);
                target[n..].fill(0.0);
                target[column] += added(last);
            } else {
                target[column..].fill(0.0);
                target[column] = 1.0;
            }
        }
        for first in (0..pitch).step_by(PANEL) {
            let (before, rest) = factor.split_at_mut(first * pitch);
            let panel = &mut rest[..PANEL * pitch];
            take_off(simd, (before, diagonal), filled, panel, first, pitch);
            if !factor_panel(simd, panel, [diagonal, inverse], first, pitch) {
                return false;
            }
            for (group, filled) in filled.iter_mut().enumerate().skip(first / PANEL) {
                let rows = group * PANEL..(group + 1) * PANEL;
                let mut any = 0;
                for column in panel.chunks_exact(pitch) {
                    for entry in &column[rows.clone()] {
                        any |= entry.to_bits() << 1;
                    }
                }
                filled[first / PANEL] = any != 0;
            }
        }
        true
    }
}

/// Panel −= L[.., before] D L[panel, before]ᵀ, from the panel's own rows on.
#[inline(always)]
fn take_off<S: Simd>(
    simd: S,
    (before, diagonal): (&[f64], &[f64]),
    filled: &[Vec<bool>],
    panel: &mut [f64],
    first: usize,
    pitch: usize,
) {
    let lanes = S::F64_LANES;
    for other in (0..first).step_by(PANEL) {
        if !filled[first / PANEL][other / PANEL] {
            continue;
        }
        let columns = &before[other * pitch..(other + PANEL) * pitch];
        // L D of the panel's own rows.
        let mut factors = [[simd.splat_f64s(0.0); PANEL]; PANEL];
        for (k, factors) in factors.iter_mut().enumerate() {
            for (column, factor) in factors.iter_mut().enumerate() {
                *factor = simd.splat_f64s(-columns[k * pitch + first + column] * diagonal[other + k]);
            }
        }
        for (group, filled) in filled.iter().enumerate().skip(first / PANEL) {
            if !filled[other / PANEL] {
                continue;
            }
            for row in (group * PANEL..(group + 1) * PANEL).step_by(lanes) {
                let mut entries = [simd.splat_f64s(0.0); PANEL];
                for (k, entry) in entries.iter_mut().enumerate() {
                    *entry = S::as_simd_f64s(&columns[k * pitch + row..][..lanes]).0[0];
                }
                for column in 0..PANEL {
                    let target = &mut S::as_mut_simd_f64s(&mut panel[column * pitch + row..][..lanes]).0[0];
                    let mut sum = *target;
                    for (factors, &entry) in factors.iter().zip(&entries) {
                        sum = simd.mul_add_e_f64s(factors[column], entry, sum);
                    }
                    *target = sum;
                }
            }
        }
    }
}

/// Factors a panel's columns, which know of all columns before them.
#[inline(always)]
fn factor_panel<S: Simd>(
    simd: S,
    panel: &mut [f64],
    [diagonal, inverse]: [&mut [f64]; 2],
    first: usize,
    pitch: usize,
) -> bool {
    let lanes = S::F64_LANES;
    for column in 0..PANEL {
        let (_, rest) = panel.split_at_mut(column * pitch);
        let pivot = rest[first + column];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let reciprocal = 1.0 / pivot;
        (diagonal[first + column], inverse[first + column]) = (pivot, reciprocal);
        // The panel's later columns take this one off; then it is divided.
        let (current, after) = rest.split_at_mut(pitch);
        for (offset, later) in after.chunks_exact_mut(pitch).take(PANEL - 1 - column).enumerate() {
            let factor = simd.splat_f64s(-current[first + column + 1 + offset] * reciprocal);
            let start = first / lanes * lanes;
            let (current, _) = S::as_simd_f64s(&current[start..]);
            let (later, _) = S::as_mut_simd_f64s(&mut later[start..]);
            for (entry, &other) in later.iter_mut().zip(current) {
                *entry = simd.mul_add_e_f64s(factor, other, *entry);
            }
        }
        let start = first / lanes * lanes;
        let (entries, _) = S::as_mut_simd_f64s(&mut current[start..]);
        for entry in entries {
            *entry = simd.mul_f64s(*entry, simd.splat_f64s(reciprocal));
        }
    }
    true
}

struct Solve<'a> {
    cholesky: &'a mut Cholesky,
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Cholesky { factor, inverse, filled, pitch, solution, .. } = self.cholesky;
        let (lanes, pitch) = (S::F64_LANES, *pitch);
        let x = &mut solution[..pitch];
        for first in (0..pitch).step_by(PANEL) {
            let panel = &factor[first * pitch..(first + PANEL) * pitch];
            let mut own = [0.0; PANEL];
            own.copy_from_slice(&x[first..first + PANEL]);
            for k in 0..PANEL {
                for below in k + 1..PANEL {
                    own[below] -= own[k] * panel[k * pitch + first + below];
                }
            }
            let mut values = [simd.splat_f64s(0.0); PANEL];
            for (value, own) in values.iter_mut().zip(own) {
                *value = simd.splat_f64s(-own);
            }
            let group = first / PANEL;
            x[first..first + PANEL].copy_from_slice(&own);
            for (group, filled) in filled.iter().enumerate().skip(group + 1) {
                if filled[first / PANEL] {
                    for row in (group * PANEL..(group + 1) * PANEL).step_by(lanes) {
                        let target = &mut S::as_mut_simd_f64s(&mut x[row..row + lanes]).0[0];
                        for (k, &value) in values.iter().enumerate() {
                            let entry = S::as_simd_f64s(&panel[k * pitch + row..][..lanes]).0[0];
                            *target = simd.mul_add_e_f64s(value, entry, *target);
                        }
                    }
                }
            }
        }
        x.iter_mut().zip(&*inverse).for_each(|(x, inverse)| *x *= inverse);
        for first in (0..pitch).step_by(PANEL).rev() {
            let panel = &factor[first * pitch..(first + PANEL) * pitch];
            let group = first / PANEL;
            let mut sums = [simd.splat_f64s(0.0); PANEL];
            for (group, filled) in filled.iter().enumerate().skip(group + 1) {
                if filled[first / PANEL] {
                    for row in (group * PANEL..(group + 1) * PANEL).step_by(lanes) {
                        let value = S::as_simd_f64s(&x[row..row + lanes]).0[0];
                        for (k, sum) in sums.iter_mut().enumerate() {
                            let entry = S::as_simd_f64s(&panel[k * pitch + row..][..lanes]).0[0];
                            *sum = simd.mul_add_e_f64s(entry, value, *sum);
                        }
                    }
                }
            }
            let mut own = [0.0; PANEL];
            for (k, own) in own.iter_mut().enumerate() {
                *own = x[first + k] - simd.reduce_sum_f64s(sums[k]);
            }
            for k in (0..PANEL).rev() {
                for below in k + 1..PANEL {
                    own[k] -= own[below] * panel[k * pitch + first + below];
                }
            }
            x[first..first + PANEL].copy_from_slice(&own);
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
