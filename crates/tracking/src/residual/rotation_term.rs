//! Adding a residual of one rotation to the normal equations of either parametrisation.
//!
//! Residuals of rotations are written by the tangent perturbation ω of q in its parent's frame. A raw
//! coefficient turns by ωᵢ of [`raw_rates`], so its columns are linear combinations of the tangent ones.

use glam::{DMat3, DQuat, DVec3};
use nalgebra::{SMatrix, SVector};

use crate::body::Parameters;
use crate::geometry::rotation::raw_rates;
use crate::optimize::NormalEquations;

/// Adds w ‖ρ‖² with ρ of three components and ∂(prediction)/∂ω = `jacobian`.
pub(super) fn add(
    equations: &mut NormalEquations,
    parameters: Parameters,
    rotation: usize,
    q: DQuat,
    jacobian: DMat3,
    residual: DVec3,
    weight: f64,
) {
    equations.cost += weight * residual.length_squared();
    let first = parameters.first_column(rotation);
    match parameters {
        Parameters::Tangent => {
            let columns = [jacobian.x_axis, jacobian.y_axis, jacobian.z_axis];
            add_columns(equations, first, &columns, residual, weight);
        }
        Parameters::Raw => {
            let columns = raw_rates(q).map(|(turn, _)| jacobian * turn);
            add_columns(equations, first, &columns, residual, weight);
        }
    }
}

fn add_columns<const N: usize>(
    equations: &mut NormalEquations,
    first: usize,
    columns: &[DVec3; N],
    residual: DVec3,
    weight: f64,
) {
    let products = SMatrix::<f64, N, N>::from_fn(|i, j| weight * columns[i].dot(columns[j]));
    let forces = SVector::<f64, N>::from_fn(|i, _| weight * columns[i].dot(residual));
    let mut block = equations.jtj.fixed_view_mut::<N, N>(first, first);
    block += products;
    let mut rows = equations.jtr.fixed_rows_mut::<N>(first);
    rows += forces;
}
