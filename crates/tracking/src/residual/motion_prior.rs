//! What the frames before say of this pose: R δᵀ Λ δ, δ the tangent step from the predicted pose, Λ = Pₓₓ⁻¹.
//!
//! With R the measurement's variance in squared grey levels, the minimum of this and the silhouettes' cost is the
//! iterated Kalman filter's update (see [`filter`](crate::filter)). ∂δ/∂ω is the inverse of the left Jacobian of
//! each rotation's part of δ.

use glam::DVec3;
use nalgebra::{DMatrix, DVector};

use crate::body::{Parameters, Pose};
use crate::geometry::rotation::{left_jacobian_inverse, log, raw_rates};
use crate::optimize::NormalEquations;

/// A Gaussian over poses: its mean and its information in tangent columns.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionPrior {
    /// The predicted pose.
    pub mean: Pose,
    /// Λ, tangent columns × tangent columns, symmetric.
    pub information: DMatrix<f64>,
    /// R: squared grey levels.
    pub variance: f64,
}

/// Adds the prior; `scale` is the weight of a pixel at the stage's stride.
pub fn add(
    equations: &mut NormalEquations,
    parameters: Parameters,
    pose: &Pose,
    prior: &MotionPrior,
    scale: f64,
) {
    let weight = scale * prior.variance;
    let (step, rates) = step_and_rates(parameters, pose, &prior.mean);
    let pushed = &prior.information * &step;
    equations.cost += weight * step.dot(&pushed);
    // The rates are block diagonal: each column of the state moves one block of three.
    for (column, rate) in rates.iter().enumerate() {
        let force: f64 = (0..3).map(|row| rate.by[row] * pushed[rate.first + row]).sum();
        equations.jtr[column] -= weight * force;
        for (other, other_rate) in rates.iter().enumerate() {
            let block = prior.information.fixed_view::<3, 3>(rate.first, other_rate.first);
            let sum: f64 = (0..3)
                .map(|row| rate.by[row] * (0..3).map(|at| block[(row, at)] * other_rate.by[at]).sum::<f64>())
                .sum();
            equations.jtj[(column, other)] += weight * sum;
        }
    }
}

/// How one column of the state moves δ: three entries from `first` on.
struct StepRate {
    first: usize,
    by: DVec3,
}

fn step_and_rates(parameters: Parameters, pose: &Pose, mean: &Pose) -> (DVector<f64>, Vec<StepRate>) {
    let mut step = (pose.root - mean.root).to_array().to_vec();
    let mut rates: Vec<StepRate> = DVec3::AXES.into_iter().map(|by| StepRate { first: 0, by }).collect();
    for (q, from) in pose.rotations.iter().zip(&mean.rotations) {
        let phi = log((*q * from.inverse()).normalize());
        let jacobian = left_jacobian_inverse(phi);
        let first = step.len();
        step.extend(phi.to_array());
        let turns = match parameters {
            Parameters::Tangent => DVec3::AXES.to_vec(),
            Parameters::Raw => raw_rates(*q).map(|(turn, _)| turn).to_vec(),
        };
        rates.extend(turns.into_iter().map(|turn| StepRate { first, by: jacobian * turn }));
    }
    (DVector::from_vec(step), rates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::fixtures::{BOTH, Failures, bent, check_gradient, differences};

    /// Jᵀρ against differences of the cost, JᵀJ against differences of δ.
    #[test]
    fn derivatives_match_differences() {
        let model = builtin::upper_body();
        let (pose, mean) = (bent(&model, 0.5, 0.0), bent(&model, -0.4, 0.0));
        let n = Parameters::Tangent.columns(model.rotation_count());
        let half = DMatrix::from_fn(n, n, |i, j| ((i * 5 + j * 11) as f64 * 0.37).sin());
        let prior = MotionPrior { mean, information: &half * half.transpose(), variance: 1.5 };
        let mut failures = Failures::default();
        for parameters in BOTH {
            let residual = |equations: &mut NormalEquations, pose: &Pose| {
                add(equations, parameters, pose, &prior, 0.25);
            };
            let here = check_gradient("motion", parameters, &pose, residual, 5e-7, &mut failures);
            let steps = |pose: &Pose| step_and_rates(parameters, pose, &prior.mean).0.as_slice().to_vec();
            let jacobian = differences(parameters, &pose, steps);
            let expected = jacobian.transpose() * &prior.information * jacobian * (1.5 * 0.25);
            let worst = (&expected - &here.jtj).amax() / expected.amax();
            failures.expect(worst <= 1e-7, format_args!("{parameters:?}: JᵀJ differs by {worst:.1e}"));
        }
    }
}
