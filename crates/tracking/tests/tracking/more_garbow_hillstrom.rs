//! J. J. Moré, B. S. Garbow, K. E. Hillstrom, "Testing unconstrained optimization software", ACM Transactions on
//! Mathematical Software 7 (1981): Levenberg-Marquardt from the paper's starts to the paper's minima.

mod problems;

use backlit_tracking::optimize::{
    LeastSquares, Method, NormalEquations, Solver, SolverOptions, Termination, Tolerances,
};
use nalgebra::{DMatrix, DVector};
use problems::{C, Problem};

use crate::fixtures::Failures;

/// Published minima have six figures, the last one cut off.
const SIX_FIGURES: f64 = 1e-5;
/// What counts as a minimum of zero.
const ZERO: f64 = 1e-18;

impl LeastSquares for &Problem {
    type Point = Vec<f64>;

    fn evaluate(&mut self, point: &Vec<f64>, equations: &mut NormalEquations) {
        const STEP: f64 = 1e-30;
        let columns: Vec<Vec<C>> = (0..point.len())
            .map(|moved| {
                let imaginary = |j: usize| if j == moved { STEP } else { 0.0 };
                let at: Vec<C> = point.iter().enumerate().map(|(j, &x)| C::new(x, imaginary(j))).collect();
                (self.residuals)(&at)
            })
            .collect();
        // ρ = data − prediction: the paper's residuals are predictions of zero.
        let residual = DVector::from_iterator(columns[0].len(), columns[0].iter().map(|value| -value.re));
        let jacobian = DMatrix::from_fn(residual.len(), point.len(), |i, j| columns[j][i].im / STEP);
        equations.jtj = jacobian.tr_mul(&jacobian);
        equations.jtr = jacobian.tr_mul(&residual);
        equations.cost = residual.norm_squared();
    }

    fn columns(&self) -> usize {
        self.start.len()
    }

    fn retract(&self, point: &Vec<f64>, step: &DVector<f64>) -> Vec<f64> {
        point.iter().zip(step.iter()).map(|(x, step)| x + step).collect()
    }
}

fn is_at_a_minimum(problem: &Problem, cost: f64) -> bool {
    problem.minima.iter().any(|&minimum| {
        if minimum == 0.0 { cost < ZERO } else { (cost - minimum).abs() < SIX_FIGURES * minimum }
    })
}

/// Cost at the end, iterations and why it ended.
fn solve(mut problem: &Problem) -> (f64, usize, Termination) {
    let options = SolverOptions {
        method: Method::LevenbergMarquardt,
        damping: 0.01,
        least_scale: 0.0,
        max_iterations: 1000,
        tolerances: Tolerances { gain: Some(1e-14), step: Some(1e-12), gradient: Some(1e-12) },
        run_all: false,
    };
    let start = problem.start.clone();
    let mut solver = Solver::new(&mut problem, start, options);
    let iterations = std::iter::from_fn(|| solver.step(&mut problem)).count();
    (solver.cost(), iterations, solver.termination.unwrap())
}

#[test]
fn the_published_minima_are_found() {
    let mut failures = Failures::default();
    for problem in &problems::all() {
        let (cost, iterations, why) = solve(problem);
        let line = format!("{}: {cost:.6e} after {iterations} iterations: {why}", problem.name);
        println!("{line}");
        // Where all residuals come to zero to the bit, no pull is left.
        let is_converged = why.name().starts_with("converged") || why == Termination::NoGradient;
        failures.expect(
            is_converged && is_at_a_minimum(problem, cost),
            format_args!("{line}; published {:?}", problem.minima),
        );
    }
}

/// Where J is singular at the minimum every step goes half of the way, so there is no end, and none is claimed.
#[test]
fn a_singular_minimum_is_approached() {
    for problem in &problems::powell_singular() {
        let (cost, _, why) = solve(problem);
        let is_exact = cost < 1e-16 && why == Termination::StepLimit { steps: 1000 };
        assert!(is_exact, "{}: {cost:e}, {why}", problem.name);
    }
}
