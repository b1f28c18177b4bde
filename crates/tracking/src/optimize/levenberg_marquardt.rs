//! Levenberg and Marquardt: the damping says how far the linear model is trusted.
//!
//! A trial that lowers the cost is kept and the damping shrinks; one that does not is taken back and the
//! damping grows. See K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems" (2004).

use super::solver::{Iteration, LeastSquares, Solver, Termination};

/// Factor on the damping after a rejected step.
const ON_REJECT: f64 = 5.0;
/// Factor on the damping after an accepted step.
const ON_ACCEPT: f64 = 0.3;
/// The damping stays above this.
const LEAST_DAMPING: f64 = 1e-9;
/// And below this: a step is then far below rounding.
const MOST_DAMPING: f64 = 1e15;
/// So many rejections in a row mean that no step lowers the cost.
pub(super) const MOST_REJECTED: usize = 8;

/// One trial.
pub(super) fn step<P: Clone>(
    solver: &mut Solver<P>,
    problem: &mut impl LeastSquares<Point = P>,
) -> Result<Iteration<P>, Termination> {
    let before = solver.equations.cost;
    let damping = solver.damping;
    let (point, step_norm, predicted_decrease) = solver.attempt(problem)?;
    let trial_cost = solver.trial.cost;
    let accepted = solver.trial.is_finite() && trial_cost < before;
    if accepted {
        std::mem::swap(&mut solver.equations, &mut solver.trial);
        solver.point = point;
        solver.damping = (damping * ON_ACCEPT).max(LEAST_DAMPING);
        solver.rejected_in_a_row = 0;
    } else {
        solver.damping = (damping.max(LEAST_DAMPING) * ON_REJECT).min(MOST_DAMPING);
        solver.rejected_in_a_row += 1;
    }
    Ok(Iteration {
        point: solver.point.clone(),
        cost: solver.equations.cost,
        trial_cost,
        predicted_decrease,
        actual_decrease: before - trial_cost,
        damping,
        step_norm,
        gradient_max: 0.0,
        accepted,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::super::{LeastSquares, Method, NormalEquations, Solver, SolverOptions, Termination};

    /// Rosenbrock's valley as two residuals: 1 − x and 10 (y − x²).
    struct Valley;

    impl LeastSquares for Valley {
        type Point = [f64; 2];

        fn evaluate(&mut self, &[x, y]: &[f64; 2], equations: &mut NormalEquations) {
            let jacobian = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, -20.0 * x, 10.0]);
            let residual = DVector::from_vec(vec![1.0 - x, -10.0 * (y - x * x)]);
            equations.jtj = jacobian.tr_mul(&jacobian);
            equations.jtr = jacobian.tr_mul(&residual);
            equations.cost = residual.norm_squared();
        }

        fn columns(&self) -> usize {
            2
        }

        fn retract(&self, point: &[f64; 2], step: &DVector<f64>) -> [f64; 2] {
            [point[0] + step[0], point[1] + step[1]]
        }
    }

    fn options(method: Method) -> SolverOptions {
        SolverOptions { method, damping: 0.01, max_iterations: 200, tolerance: Some(1e-14), run_all: false }
    }

    #[test]
    fn levenberg_marquardt_descends_the_valley() {
        let mut solver = Solver::new(&mut Valley, [-1.2, 1.0], options(Method::LevenbergMarquardt));
        let mut cost = solver.cost();
        let mut rejected = 0;
        while let Some(iteration) = solver.step(&mut Valley) {
            assert!(iteration.cost <= cost, "an accepted step never raises the cost");
            assert_eq!(iteration.accepted, iteration.trial_cost < cost);
            rejected += usize::from(!iteration.accepted);
            cost = iteration.cost;
        }
        assert!(rejected > 0, "the valley bends: some step must fail");
        let [x, y] = *solver.point();
        assert!((x - 1.0).abs() < 1e-5 && (y - 1.0).abs() < 1e-5, "{x} {y}");
    }

    #[test]
    fn gauss_newton_takes_every_step() {
        let mut solver = Solver::new(&mut Valley, [-1.2, 1.0], options(Method::GaussNewton));
        let mut rose = false;
        while let Some(iteration) = solver.step(&mut Valley) {
            assert!(iteration.accepted);
            rose |= iteration.actual_decrease < 0.0;
        }
        assert!(rose, "undamped steps overshoot here");
    }

    #[test]
    fn a_stationary_start_says_so() {
        let mut solver = Solver::new(&mut Valley, [1.0, 1.0], options(Method::LevenbergMarquardt));
        assert!(solver.step(&mut Valley).is_none());
        assert_eq!(solver.termination(), Some(Termination::NoGradient));
    }

    #[test]
    fn run_all_runs_all() {
        for method in [Method::GaussNewton, Method::LevenbergMarquardt] {
            for start in [[-1.2, 1.0], [1.0, 1.0]] {
                let options = SolverOptions { max_iterations: 600, run_all: true, ..options(method) };
                let mut solver = Solver::new(&mut Valley, start, options);
                while solver.step(&mut Valley).is_some() {}
                assert_eq!(solver.termination(), Some(Termination::StepLimit { steps: 600 }));
            }
        }
    }

    #[test]
    fn infinite_costs_end_without_losing_the_point() {
        let mut solver = Solver::new(&mut Valley, [f64::NAN, 1.0], options(Method::LevenbergMarquardt));
        assert!(solver.step(&mut Valley).is_none());
        assert_eq!(solver.termination(), Some(Termination::NotFinite));
    }
}
