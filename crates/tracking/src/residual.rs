//! What pulls on a pose: each file is one kind of residual and adds itself to the normal equations. One of your own is a
//! [`Residual`].
//!
//! [`silhouette`]s are D − Λ of every pixel (4.10, 4.16), [`Loss`] holds large residuals back, [`Proportions`] says how far
//! lengths and radii are from a scaled body's.

#[doc(inline)]
pub use crate::prior;

use std::fmt;

use nalgebra::{SMatrix, SVector};

use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::optimize::NormalEquations;

pub(crate) mod body_size;
pub(crate) mod camera_columns;
mod composite;
pub mod cue;
pub mod interpenetration;
pub mod learnt_prior;
mod loss;
pub mod motion_prior;
pub mod point;
pub mod pose_prior;
pub(crate) mod proportion_prior;
pub mod silhouette;
mod state_map;

pub use loss::Loss;
pub use proportion_prior::Proportions;

/// A residual of one's own, which [`Fit::with_residual`](crate::fit::Fit::with_residual) adds to a fit.
///
/// With ρ = datum − prediction and J = ∂prediction/∂X it adds w ρ² to the cost, w JᵀJ and w Jᵀρ.
/// [`check_gradient`](crate::optimize::gradient_check::check_gradient) compares its derivatives with differences.
pub trait Residual: fmt::Debug + Send + Sync {
    /// Adds itself at a pose.
    fn add(&self, at: &ResidualPoint<'_>, equations: &mut NormalEquations);
}

/// Where a [`Residual`] is evaluated.
#[derive(Debug, Clone, Copy)]
pub struct ResidualPoint<'a> {
    /// The body.
    pub model: &'a Model,
    /// Its pose.
    pub pose: &'a Pose,
    /// Where the pose puts its joints, and how the state moves them.
    pub kinematics: &'a Kinematics,
    /// The state's columns.
    pub parameters: Parameters,
    /// Squared grey levels of a weight of 1, as priors have them, at the stage's stride.
    pub unit: f64,
}

/// Σ w h hᵀ and Σ w h ρ over rows h of J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RowSums<const N: usize> {
    pub(crate) products: SMatrix<f64, N, N>,
    pub(crate) forces: SVector<f64, N>,
}

impl<const N: usize> Default for RowSums<N> {
    fn default() -> Self {
        Self { products: SMatrix::zeros(), forces: SVector::zeros() }
    }
}

impl<const N: usize> RowSums<N> {
    /// Adds one row.
    pub(crate) fn add(&mut self, h: &SVector<f64, N>, weight: f64, residual: f64) {
        self.products.ger(weight, h, h, 1.0);
        self.forces.axpy(weight * residual, h, 1.0);
    }

    /// JᵀJ += w KᵀMK and Jᵀρ += w Kᵀm, by the columns of K that are not zero and their indices in the state.
    pub(crate) fn add_to(
        &self,
        columns: impl Iterator<Item = (usize, SVector<f64, N>)> + Clone,
        weight: f64,
        equations: &mut NormalEquations,
    ) {
        for (first, (i, a)) in columns.clone().enumerate() {
            let pushed = self.products * a * weight;
            equations.jtr[i] += weight * a.dot(&self.forces);
            for (j, b) in columns.clone().skip(first) {
                let sum = pushed.dot(&b);
                equations.jtj[(i, j)] += sum;
                if i != j {
                    equations.jtj[(j, i)] += sum;
                }
            }
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.products.trace() == 0.0
    }
}
