//! How steps change when the pose that they start from moves.
//!
//! A step δ has three numbers of a position and then three of each rotation, q ← exp(φ) q. Of the same pose seen from a mean
//! that has moved by s, and of a mean that has gone on with velocity v for a time Δ, to first order:
//!
//! | | | |
//! |---|---|---|
//! | [`reset`] | G = ∂δ′/∂δ at δ = s, δ′ = log(exp(δ) exp(−s)) | J(s), the left Jacobian of each rotation |
//! | [`undo_reset`] | G⁻¹, by δ′ about zero | J⁻¹(s) |
//! | [`transition`] | F of (δ, v), δ′ = log(exp((v + ∂v) Δ) exp(δ) exp(−v Δ)) | [exp(vΔ) ΔJ(vΔ); 0 I] |
//!
//! For positions all three are what they are in a flat space. G is the reset of an error-state filter (J. Solà, "Quaternion
//! kinematics for the error-state Kalman filter", 2017, section 6.3).

use glam::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector};

use crate::geometry::rotation::{exp, left_jacobian, left_jacobian_inverse, log};

/// ∂δ′/∂δ when the mean has moved by `step`, n × n: steps about the new mean by those about the old one, near it.
pub fn reset(step: &DVector<f64>) -> DMatrix<f64> {
    blocks(step, left_jacobian)
}

/// The inverse of [`reset`]: steps about the old mean by those about the new one.
pub fn undo_reset(step: &DVector<f64>) -> DMatrix<f64> {
    blocks(step, left_jacobian_inverse)
}

/// F of a motion with a velocity that stays, for a time in seconds, negative backwards: 2n × 2n.
pub fn transition(velocity: &DVector<f64>, seconds: f64) -> DMatrix<f64> {
    let n = velocity.len();
    let step = velocity * seconds;
    let mut transition = DMatrix::identity(2 * n, 2 * n);
    transition.view_mut((0, 0), (n, n)).copy_from(&blocks(&step, |phi| DMat3::from_quat(exp(phi))));
    transition.view_mut((0, n), (n, n)).copy_from(&(blocks(&step, left_jacobian) * seconds));
    transition
}

/// The step that leads where `first` and then `then` lead: log(exp(then) exp(first)) of each rotation.
pub fn compose(first: &DVector<f64>, then: &DVector<f64>) -> DVector<f64> {
    let mut both = first + then;
    for at in (3..both.len()).step_by(3) {
        let turn = |step: &DVector<f64>| exp(DVec3::new(step[at], step[at + 1], step[at + 2]));
        let turned = log(turn(then) * turn(first)).to_array();
        both.rows_mut(at, 3).copy_from_slice(&turned);
    }
    both
}

/// Ones for the position, then a block for each rotation.
fn blocks(step: &DVector<f64>, of_rotation: impl Fn(DVec3) -> DMat3) -> DMatrix<f64> {
    let mut matrix = DMatrix::identity(step.len(), step.len());
    for first in (3..step.len()).step_by(3) {
        let block = of_rotation(DVec3::new(step[first], step[first + 1], step[first + 2]));
        for (row, column) in (0..9).map(|at| (at % 3, at / 3)) {
            matrix[(first + row, first + column)] = block.col(column)[row];
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Failures;

    fn vector(values: impl Fn(usize) -> f64) -> DVector<f64> {
        DVector::from_fn(9, |index, _| values(index))
    }

    /// Both resets and the transition against differences, every entry.
    #[test]
    fn jacobians_match_differences() {
        let (step, velocity) =
            (vector(|i| 0.4 * (1.3 * i as f64).sin()), vector(|i| 2.0 * (0.7 * i as f64).cos()));
        let h = 1e-6;
        let mut failures = Failures::default();
        let mut compare = |name: &str, found: &DMatrix<f64>, of: &dyn Fn(&DVector<f64>) -> DVector<f64>| {
            for column in 0..found.ncols() {
                let mut by = DVector::zeros(found.ncols());
                by[column] = h;
                let numeric = (of(&by) - of(&-&by)) / (2.0 * h);
                let worst = (numeric - found.column(column)).amax();
                failures.expect(worst <= 1e-8, format_args!("{name}, column {column}: {worst:.1e}"));
            }
        };
        compare("reset", &reset(&step), &|by| compose(&-&step, &(&step + by)));
        compare("undone", &undo_reset(&step), &|by| compose(&step, by));
        let seconds = -0.15;
        let carried = |by: &DVector<f64>| {
            let (pose, faster) = (by.rows(0, 9).into_owned(), &velocity + by.rows(9, 9));
            let there = compose(&pose, &(&faster * seconds));
            let mut out = by.clone();
            out.rows_mut(0, 9).copy_from(&compose(&(&velocity * -seconds), &there));
            out
        };
        compare("transition", &transition(&velocity, seconds), &carried);
    }
}
