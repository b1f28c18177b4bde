//! JᵀJ, Jᵀρ and the cost: all that a step needs to know of the data.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};
use pulp::{Simd, WithSimd};

use super::cholesky::Cholesky;
use crate::processor::run_in_four_f64s;

/// Eigenvalues below this fraction of the largest count as null in an undamped solution.
const NULL_EIGENVALUE: f64 = 1e-6;

/// The normal equations of a weighted least-squares problem; `+=` merges independent residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations {
    /// Σ w JᵀJ, columns × columns, symmetric.
    pub jtj: DMatrix<f64>,
    /// Σ w Jᵀρ, columns.
    pub jtr: DVector<f64>,
    /// Σ w ρ².
    pub cost: f64,
}

impl NormalEquations {
    /// No residual yet.
    pub fn zeros(columns: usize) -> Self {
        Self { jtj: DMatrix::zeros(columns, columns), jtr: DVector::zeros(columns), cost: 0.0 }
    }

    /// Forgets everything, keeps the memory.
    pub fn clear(&mut self) {
        self.jtj.as_mut_slice().fill(0.0);
        self.jtr.as_mut_slice().fill(0.0);
        self.cost = 0.0;
    }

    /// Number of columns of the state.
    pub fn columns(&self) -> usize {
        self.jtr.len()
    }

    /// Whether every number is one.
    pub fn is_finite(&self) -> bool {
        self.cost.is_finite() && self.jtr.iter().chain(self.jtj.iter()).all(|x| x.is_finite())
    }

    /// Mean of JᵀJ's diagonal: the scale of the damping.
    pub fn mean_diagonal(&self) -> f64 {
        self.jtj.trace() / self.columns() as f64
    }

    /// The step δ of (JᵀJ + `damping` · mean(diag JᵀJ) · I) δ = Jᵀρ.
    ///
    /// JᵀJ is singular by nature (limb twists): without damping, or where rounding spoils it, the
    /// pseudo-inverse's step is taken, which leaves null directions alone. Zeros if nothing pulls.
    pub fn step(&self, damping: f64) -> DVector<f64> {
        let mut step = DVector::zeros(self.columns());
        self.step_into(damping, &mut Cholesky::default(), &mut step);
        step
    }

    /// The same into `step`, which must have as many entries as there are columns. Damped steps allocate
    /// nothing once `memory` has grown.
    pub fn step_into(&self, damping: f64, memory: &mut Cholesky, step: &mut DVector<f64>) {
        let added = damping * self.mean_diagonal();
        if added > 0.0 && memory.factor(&self.jtj, |_| added) {
            memory.solve(&self.jtr, step);
            return;
        }
        let eigen = self.jtj.clone().symmetric_eigen();
        let floor = NULL_EIGENVALUE * eigen.eigenvalues.amax();
        let mut along = eigen.eigenvectors.tr_mul(&self.jtr);
        for (value, eigenvalue) in along.iter_mut().zip(eigen.eigenvalues.iter()) {
            *value = if *eigenvalue > floor { *value / (eigenvalue + added) } else { 0.0 };
        }
        step.copy_from(&(eigen.eigenvectors * along));
    }

    /// The step δ of (JᵀJ + `damping` · D²) δ = Jᵀρ, Levenberg and Marquardt's, into `step`; `scale` is the diagonal D²,
    /// 0 for a column that nothing depends on. False, and no step, where the numbers run out of range.
    pub(super) fn scaled_step_into(
        &self,
        damping: f64,
        scale: &DVector<f64>,
        memory: &mut Cholesky,
        step: &mut DVector<f64>,
    ) -> bool {
        // A column of zeros may have any scale: its step is zero.
        let added = |column: usize| damping * if scale[column] > 0.0 { scale[column] } else { 1.0 };
        let is_positive = memory.factor(&self.jtj, added);
        if is_positive {
            memory.solve(&self.jtr, step);
        }
        is_positive && step.iter().all(|x| x.is_finite())
    }

    /// Largest cosine of a column of J with the residuals.
    pub(super) fn largest_cosine(&self) -> f64 {
        let cosine = |(column, jtr): (usize, &f64)| {
            let norms = (self.jtj[(column, column)] * self.cost).sqrt();
            if norms > 0.0 { jtr.abs() / norms } else { 0.0 }
        };
        self.jtr.iter().enumerate().map(cosine).fold(0.0, f64::max)
    }

    /// Adds w ρ² of one residual whose row of J has these columns that are not zero.
    pub(crate) fn add_row(&mut self, row: &[(usize, f64)], residual: f64, weight: f64) {
        self.cost += weight * residual * residual;
        for &(i, a) in row {
            self.jtr[i] += weight * a * residual;
            for &(j, b) in row {
                self.jtj[(i, j)] += weight * a * b;
            }
        }
    }

    /// By how much the linear model says that the cost falls with a step: 2 δᵀJᵀρ − δᵀJᵀJ δ.
    pub fn predicted_decrease(&self, step: &DVector<f64>) -> f64 {
        2.0 * step.dot(&self.jtr) - run_in_four_f64s(Curvature { jtj: &self.jtj, step: step.as_slice() })
    }
}

/// δᵀJᵀJ δ.
struct Curvature<'a> {
    jtj: &'a DMatrix<f64>,
    step: &'a [f64],
}

impl WithSimd for Curvature<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { jtj, step } = self;
        let (vectors, rest) = S::as_simd_f64s(step);
        let (mut lanes, mut sum) = (simd.splat_f64s(0.0), 0.0);
        for (&x, column) in step.iter().zip(jtj.as_slice().chunks_exact(step.len().max(1))) {
            let (entries, last) = S::as_simd_f64s(column);
            let factor = simd.splat_f64s(x);
            for (&entry, &vector) in entries.iter().zip(vectors) {
                lanes = simd.mul_add_e_f64s(simd.mul_f64s(factor, entry), vector, lanes);
            }
            for (&entry, &other) in last.iter().zip(rest) {
                sum += x * entry * other;
            }
        }
        sum + simd.reduce_sum_f64s(lanes)
    }
}

impl AddAssign<&Self> for NormalEquations {
    fn add_assign(&mut self, other: &Self) {
        self.jtj += &other.jtj;
        self.jtr += &other.jtr;
        self.cost += other.cost;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_problem_leaves_its_null_direction_alone() {
        // One residual on x + y: the direction x − y is null.
        let mut equations = NormalEquations::zeros(2);
        equations.jtj = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0]);
        equations.jtr = DVector::from_vec(vec![2.0, 2.0]);
        for damping in [0.0, 1e-9] {
            let step = equations.step(damping);
            assert!((step[0] - 1.0).abs() < 1e-6 && (step[1] - 1.0).abs() < 1e-6, "{step}");
        }
        assert_eq!(NormalEquations::zeros(3).step(0.1), DVector::zeros(3));
    }
}
