//! The report's step (4.10): δ = (JᵀJ + λ mean(diag JᵀJ) I)⁻¹ Jᵀρ, always taken.
//!
//! The report writes a plain inverse; JᵀJ is never invertible, so λ = 0 means the pseudo-inverse.

use super::solver::{Iteration, LeastSquares, Solver, Termination};

/// One Gauss-Newton step.
pub(super) fn step<P: Clone>(
    solver: &mut Solver<P>,
    problem: &mut impl LeastSquares<Point = P>,
) -> Result<Iteration<P>, Termination> {
    let before = solver.equations.cost;
    let (point, step_norm, predicted_decrease) = solver.attempt(problem)?;
    if !solver.trial.is_finite() {
        return Err(Termination::NotFinite);
    }
    std::mem::swap(&mut solver.equations, &mut solver.trial);
    solver.point = point.clone();
    let cost = solver.equations.cost;
    Ok(Iteration {
        point,
        cost,
        trial_cost: cost,
        predicted_decrease,
        actual_decrease: before - cost,
        damping: solver.damping,
        step_norm,
        gradient_max: 0.0,
        accepted: true,
    })
}
