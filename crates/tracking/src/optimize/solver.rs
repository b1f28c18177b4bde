//! Options, records and the solver, which is stepped from outside.
//!
//! A trial solves (JᵀJ + λ mean(diag JᵀJ) I) δ = Jᵀρ and evaluates the problem at X ⊕ δ. Gauss and Newton's method,
//! the report's (4.10), takes every trial with a fixed λ. The report writes a plain inverse; JᵀJ is never invertible,
//! so λ = 0 means the pseudo-inverse. Levenberg and Marquardt's takes a trial back that does not lower the cost, and
//! λ is its trust: see [`levenberg_marquardt`].

use std::fmt;
use std::str::FromStr;

use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{NormalEquations, StepMemory, levenberg_marquardt};

/// A least-squares problem on points that may be curved.
pub trait LeastSquares {
    /// Where the problem can be evaluated.
    type Point: Clone;

    /// Cost, JᵀJ and Jᵀρ at a point. `equations` come cleared and have the problem's columns.
    fn evaluate(&mut self, point: &Self::Point, equations: &mut NormalEquations);

    /// Columns of a step.
    fn columns(&self) -> usize;

    /// Moves a point by a step.
    fn retract(&self, point: &Self::Point, step: &DVector<f64>) -> Self::Point;

    /// Shortens a step that goes further than the problem trusts itself. By default none does.
    fn cap(&self, _step: &mut DVector<f64>) {}
}

/// How a step is made of the normal equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The report's (4.10): every step is taken, with a fixed damping.
    GaussNewton,
    /// Levenberg and Marquardt: a step that raises the cost is taken back and the damping grows.
    #[default]
    #[serde(alias = "lm")]
    LevenbergMarquardt,
}

/// Text that is not a method.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
#[error("\"{0}\" is not a method; expected gauss-newton or lm")]
pub struct ParseMethodError(String);

impl FromStr for Method {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "gauss-newton" => Ok(Self::GaussNewton),
            "lm" | "levenberg-marquardt" => Ok(Self::LevenbergMarquardt),
            _ => Err(ParseMethodError(text.to_owned())),
        }
    }
}

/// What a solver may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverOptions {
    /// How steps are made.
    pub method: Method,
    /// Damping at the start, in units of mean(diag JᵀJ).
    pub damping: f64,
    /// Most iterations, rejected ones included.
    pub max_iterations: usize,
    /// Stop when an accepted step lowers the cost by less than this fraction; `None`: never for that reason.
    pub tolerance: Option<f64>,
    /// Whether to go on to the last iteration whatever the cost does: for measuring times and for comparing
    /// solvers step by step. Only numbers out of range still end it.
    pub run_all: bool,
}

/// Why a solver stopped. Not converging is an answer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Termination {
    /// The cost fell by less than `tolerance` of itself in one step.
    Converged {
        /// The fraction asked for.
        tolerance: f64,
    },
    /// All steps asked for are done.
    StepLimit {
        /// How many.
        steps: usize,
    },
    /// No step lowered the cost, however short.
    NoDecrease,
    /// Nothing pulls: the gradient is zero.
    NoGradient,
    /// Somebody asked to stop.
    Cancelled,
    /// The cost or a step was not a finite number; the last good point is kept.
    NotFinite,
}

impl Termination {
    /// Its word in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged { .. } => "converged",
            Self::StepLimit { .. } => "step-limit",
            Self::NoDecrease => "no-decrease",
            Self::NoGradient => "no-gradient",
            Self::Cancelled => "cancelled",
            Self::NotFinite => "not-finite",
        }
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Converged { tolerance } => {
                write!(f, "the cost fell by less than {tolerance:e} in one step")
            }
            Self::StepLimit { steps: 1 } => write!(f, "1 step done"),
            Self::StepLimit { steps } => write!(f, "{steps} steps done"),
            Self::NoDecrease => write!(f, "no step lowered the cost"),
            Self::NoGradient => write!(f, "the gradient is zero"),
            Self::Cancelled => write!(f, "cancelled"),
            Self::NotFinite => write!(f, "the numbers ran out of range"),
        }
    }
}

/// One iteration: a trial step and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration<P> {
    /// Where the solver stands after it.
    pub point: P,
    /// Cost there.
    pub cost: f64,
    /// Cost of the trial; equal to `cost` if it was accepted.
    pub trial_cost: f64,
    /// By how much the linear model foretold the cost to fall.
    pub predicted_decrease: f64,
    /// By how much it fell in the trial; negative if it rose.
    pub actual_decrease: f64,
    /// Damping of the trial, in units of mean(diag JᵀJ).
    pub damping: f64,
    /// Euclidean length of the step.
    pub step_norm: f64,
    /// Largest entry of Jᵀρ where the step began.
    pub gradient_max: f64,
    /// Whether the trial was kept.
    pub accepted: bool,
}

/// A solver that is stepped from outside.
#[derive(Debug, Clone)]
pub struct Solver<P> {
    options: SolverOptions,
    point: P,
    equations: NormalEquations,
    trial: NormalEquations,
    damping: f64,
    rejected_in_a_row: usize,
    step: DVector<f64>,
    memory: StepMemory,
    done: usize,
    termination: Option<Termination>,
}

impl<P: Clone> Solver<P> {
    /// Evaluates the problem at its start.
    pub fn new(problem: &mut impl LeastSquares<Point = P>, start: P, options: SolverOptions) -> Self {
        let mut equations = NormalEquations::zeros(problem.columns());
        problem.evaluate(&start, &mut equations);
        let termination = if !equations.is_finite() {
            Some(Termination::NotFinite)
        } else if options.max_iterations == 0 {
            Some(Termination::StepLimit { steps: 0 })
        } else {
            None
        };
        Self {
            options,
            point: start,
            trial: equations.clone(),
            equations,
            damping: options.damping,
            rejected_in_a_row: 0,
            step: DVector::zeros(problem.columns()),
            memory: StepMemory::default(),
            done: 0,
            termination,
        }
    }

    /// One iteration; `None` once it has ended.
    pub fn step(&mut self, problem: &mut impl LeastSquares<Point = P>) -> Option<Iteration<P>> {
        if self.termination.is_some() {
            return None;
        }
        let gradient_max = self.equations.jtr.amax();
        if gradient_max == 0.0 && !self.options.run_all {
            self.termination = Some(Termination::NoGradient);
            return None;
        }
        match self.attempt(problem, gradient_max) {
            Ok(iteration) => {
                self.done += 1;
                self.judge(&iteration);
                Some(iteration)
            }
            Err(termination) => {
                self.termination = Some(termination);
                None
            }
        }
    }

    fn judge(&mut self, iteration: &Iteration<P>) {
        if self.termination.is_some() {
            return;
        }
        if self.done >= self.options.max_iterations {
            self.termination = Some(Termination::StepLimit { steps: self.done });
        }
        if self.options.run_all {
            return;
        }
        if let Some(tolerance) = self.options.tolerance
            && iteration.accepted
            && iteration.actual_decrease.abs() <= tolerance * (iteration.cost + iteration.actual_decrease)
        {
            self.termination = Some(Termination::Converged { tolerance });
        } else if self.rejected_in_a_row >= levenberg_marquardt::MOST_REJECTED {
            self.termination = Some(Termination::NoDecrease);
        }
    }

    /// Makes a trial and keeps it or takes it back.
    fn attempt(
        &mut self,
        problem: &mut impl LeastSquares<Point = P>,
        gradient_max: f64,
    ) -> Result<Iteration<P>, Termination> {
        let (before, damping) = (self.equations.cost, self.damping);
        let (point, predicted_decrease) = self.try_step(problem)?;
        let (trial_cost, is_finite) = (self.trial.cost, self.trial.is_finite());
        let accepted = match self.options.method {
            Method::GaussNewton if !is_finite => return Err(Termination::NotFinite),
            Method::GaussNewton => true,
            Method::LevenbergMarquardt => is_finite && trial_cost < before,
        };
        if accepted {
            std::mem::swap(&mut self.equations, &mut self.trial);
            self.point = point;
            self.rejected_in_a_row = 0;
        } else {
            self.rejected_in_a_row += 1;
        }
        if self.options.method == Method::LevenbergMarquardt {
            self.damping = levenberg_marquardt::next_damping(damping, accepted);
        }
        Ok(Iteration {
            point: self.point.clone(),
            cost: self.equations.cost,
            trial_cost,
            predicted_decrease,
            actual_decrease: before - trial_cost,
            damping,
            step_norm: self.step.norm(),
            gradient_max,
            accepted,
        })
    }

    /// Evaluates the problem a step further, into `trial`. The point there and the foretold decrease.
    fn try_step(&mut self, problem: &mut impl LeastSquares<Point = P>) -> Result<(P, f64), Termination> {
        let step = &mut self.step;
        self.equations.step_into(self.damping, &mut self.memory, step);
        problem.cap(step);
        if !step.iter().all(|x| x.is_finite()) {
            return Err(Termination::NotFinite);
        }
        let predicted = self.equations.predicted_decrease(step);
        let point = problem.retract(&self.point, step);
        self.trial.clear();
        problem.evaluate(&point, &mut self.trial);
        Ok((point, predicted))
    }

    /// Where it stands.
    #[must_use]
    pub fn point(&self) -> &P {
        &self.point
    }

    /// Cost where it stands.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.equations.cost
    }

    /// Normal equations where it stands.
    #[must_use]
    pub fn equations(&self) -> &NormalEquations {
        &self.equations
    }

    /// Damping of the next trial.
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// Why it ended; `None` while it may go on.
    #[must_use]
    pub fn termination(&self) -> Option<Termination> {
        self.termination
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

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
