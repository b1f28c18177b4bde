//! A = L Lᵀ for small symmetric positive matrices, in f64 lanes, without allocation once its memory has grown.
//!
//! Panels of four columns, left-looking: a panel first takes off what the columns before it say, four rows and
//! four columns at a time, then its own four columns are factored. A pose has some tens of columns: what costs
//! elsewhere is the start and end of many short loops. Rows and columns are padded with those of the unit
//! matrix.

use nalgebra::{DMatrix, DVector};
use pulp::{Arch, Simd, WithSimd};

/// Rows and columns are padded to a multiple of this: lanes are never wider.
const PADDING: usize = 8;
/// Columns of a panel.
const PANEL: usize = 4;

/// L of A = L Lᵀ, with memory that is used again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cholesky {
    /// Column-major, `pitch` × `pitch`; above the diagonal anything.
    factor: Vec<f64>,
    pitch: usize,
    /// Right-hand side and solution, padded.
    solution: Vec<f64>,
}

impl Cholesky {
    /// Factors `matrix` + `added` on its diagonal. Only the lower triangle is read. False if it is not positive:
    /// there is no factor then.
    pub(crate) fn factor(&mut self, matrix: &DMatrix<f64>, added: f64) -> bool {
        let n = matrix.nrows();
        let pitch = n.next_multiple_of(PADDING);
        if self.pitch != pitch {
            self.pitch = pitch;
            self.factor = vec![0.0; pitch * pitch];
            self.solution = vec![0.0; pitch];
        }
        for (column, target) in self.factor.chunks_exact_mut(pitch).enumerate() {
            if column < n {
                target[column..n].copy_from_slice(&matrix.column(column).as_slice()[column..]);
                target[n..].fill(0.0);
                target[column] += added;
            } else {
                target.fill(0.0);
                target[column] = 1.0;
            }
        }
        Arch::new().dispatch(Factor { factor: &mut self.factor, pitch })
    }

    /// Solves A x = `right` with the last factor.
    pub(crate) fn solve(&mut self, right: &DVector<f64>, solution: &mut DVector<f64>) {
        let n = right.len();
        self.solution[..n].copy_from_slice(right.as_slice());
        self.solution[n..].fill(0.0);
        Arch::new().dispatch(Solve { factor: &self.factor, pitch: self.pitch, x: &mut self.solution });
        solution.as_mut_slice().copy_from_slice(&self.solution[..n]);
    }
}

struct Factor<'a> {
    factor: &'a mut [f64],
    pitch: usize,
}

impl WithSimd for Factor<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { factor, pitch } = self;
        for first in (0..pitch).step_by(PANEL) {
            let (before, rest) = factor.split_at_mut(first * pitch);
            let panel = &mut rest[..PANEL * pitch];
            take_off(simd, before, panel, first, pitch);
            if !factor_panel(panel, first, pitch) {
                return false;
            }
        }
        true
    }
}

/// Panel −= L[.., before] L[panel, before]ᵀ, from the panel's own rows on.
#[inline(always)]
fn take_off<S: Simd>(simd: S, before: &[f64], panel: &mut [f64], first: usize, pitch: usize) {
    let lanes = S::F64_LANES;
    for row in (first / lanes * lanes..pitch).step_by(lanes) {
        let rows = |column: usize| column * pitch + row..column * pitch + row + lanes;
        let mut sums: [S::f64s; PANEL] =
            std::array::from_fn(|column| S::as_simd_f64s(&panel[rows(column)]).0[0]);
        for column in before.chunks_exact(pitch) {
            let entry = S::as_simd_f64s(&column[row..row + lanes]).0[0];
            for (sum, &other) in sums.iter_mut().zip(&column[first..first + PANEL]) {
                *sum = simd.negate_mul_add_e_f64s(simd.splat_f64s(other), entry, *sum);
            }
        }
        for (column, sum) in sums.into_iter().enumerate() {
            S::as_mut_simd_f64s(&mut panel[rows(column)]).0[0] = sum;
        }
    }
}

/// Factors a panel's columns, which know of all columns before them.
#[inline(always)]
fn factor_panel(panel: &mut [f64], first: usize, pitch: usize) -> bool {
    for column in 0..PANEL {
        let (before, rest) = panel.split_at_mut(column * pitch);
        let current = &mut rest[first + column..pitch];
        for other in before.chunks_exact(pitch) {
            let other = &other[first + column..];
            let factor = other[0];
            current.iter_mut().zip(other).for_each(|(entry, other)| *entry -= factor * other);
        }
        let pivot = current[0];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        current.iter_mut().for_each(|entry| *entry *= inverse);
    }
    true
}

struct Solve<'a> {
    factor: &'a [f64],
    pitch: usize,
    x: &'a mut [f64],
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Self { factor, pitch, x } = self;
        for (k, column) in factor.chunks_exact(pitch).enumerate() {
            let value = x[k] / column[k];
            x[k] = value;
            x[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, entry)| *x -= value * entry);
        }
        for (k, column) in factor.chunks_exact(pitch).enumerate().rev() {
            let mut sums = [0.0; 4];
            let (entries, entries_left) = column[k + 1..].as_chunks::<4>();
            let (values, values_left) = x[k + 1..].as_chunks::<4>();
            for (entries, values) in entries.iter().zip(values) {
                for (sum, (entry, value)) in sums.iter_mut().zip(entries.iter().zip(values)) {
                    *sum += entry * value;
                }
            }
            let left: f64 = entries_left.iter().zip(values_left).map(|(entry, value)| entry * value).sum();
            x[k] = (x[k] - (sums[0] + sums[1] + sums[2] + sums[3] + left)) / column[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A positive matrix whose entries follow no pattern.
    fn matrix(n: usize) -> DMatrix<f64> {
        let half = DMatrix::from_fn(n, n + 3, |i, j| ((i * 37 + j * 101) as f64 * 0.618).sin());
        &half * half.transpose() + DMatrix::identity(n, n) * 0.1
    }

    #[test]
    fn solutions_are_those_of_a_library() {
        let mut cholesky = Cholesky::default();
        for n in [1, 2, 3, 4, 5, 8, 27, 33, 43, 48, 63, 5] {
            let (matrix, added) = (matrix(n), 0.3);
            let right = DVector::from_fn(n, |i, _| (i as f64 * 1.7).cos());
            assert!(cholesky.factor(&matrix, added));
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
            assert!(!cholesky.factor(&spoilt, 0.0));
            spoilt[(n - 1, n - 1)] = f64::NAN;
            assert!(!cholesky.factor(&spoilt, 0.0));
            assert!(cholesky.factor(&matrix(n), 0.0));
        }
    }
}
