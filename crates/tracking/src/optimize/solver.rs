//! Options, records and the solver, which is stepped from outside.
//!
//! Gauss and Newton's method, the report's (4.10), solves (JᵀJ + λ mean(diag JᵀJ) I) δ = Jᵀρ and moves to X ⊕ δ, with a
//! fixed λ. The report writes a plain inverse; JᵀJ is never invertible, so λ = 0 means the pseudo-inverse. Levenberg and
//! Marquardt's scales every column by itself and takes a trial back that does not lower the cost: see
//! [`levenberg_marquardt`].

use std::str::FromStr;

use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::levenberg_marquardt::{self, Damping, HIGH_DAMPING, LOW_DAMPING};
use super::{NormalEquations, StepMemory, Termination, Tolerances};

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

    /// Root of the data's mean squared residual where the problem was evaluated last; 0 where it has none.
    fn rms(&self) -> f64 {
        0.0
    }

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
    /// Damping λ: fixed and in units of mean(diag JᵀJ) for Gauss-Newton's method; for Levenberg and Marquardt's that of
    /// the first step, in units of each column's own largest diagonal so far.
    pub damping: f64,
    /// Levenberg and Marquardt's: the least that a column counts as in the scale, as a fraction of mean(diag JᵀJ). 0: every
    /// column by itself, so that units do not matter. 1: a column that little depends on goes no farther than the
    /// average one.
    pub least_scale: f64,
    /// Most iterations, rejected ones included.
    pub max_iterations: usize,
    /// When it has converged.
    pub tolerances: Tolerances,
    /// Whether to go on to the last iteration whatever the cost does: for measuring times and for comparing
    /// solvers step by step. Only numbers out of range still end it.
    pub run_all: bool,
}

/// One iteration: a trial step and what became of it. Costs are comparable within a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Iteration<P> {
    /// Where the solver stands after it: unchanged if the trial was rejected.
    pub point: P,
    /// Index of the stage that it belongs to; 0 where there is but one.
    pub stage: usize,
    /// Cost there, priors included.
    pub cost: f64,
    /// Root of the data's mean squared residual there.
    pub rms: f64,
    /// Cost of the trial; equal to `cost` if it was accepted.
    pub trial_cost: f64,
    /// By how much the linear model predicted that the cost would fall.
    pub predicted_decrease: f64,
    /// By how much the trial lowered it; negative if it rose.
    pub actual_decrease: f64,
    /// Damping of the trial, as [`SolverOptions::damping`] counts it.
    pub damping: f64,
    /// Euclidean length of the step.
    pub step_norm: f64,
    /// Largest entry of Jᵀρ where the step began.
    pub gradient_max: f64,
    /// Whether the trial was kept.
    pub accepted: bool,
}

impl<P> Iteration<P> {
    /// Where a solver begins, at this cost: no step has been made.
    pub fn start(point: P, cost: f64) -> Self {
        Self {
            point,
            stage: 0,
            cost,
            rms: 0.0,
            trial_cost: cost,
            predicted_decrease: 0.0,
            actual_decrease: 0.0,
            damping: 0.0,
            step_norm: 0.0,
            gradient_max: 0.0,
            accepted: true,
        }
    }
}

/// A solver that is stepped from outside.
#[derive(Debug, Clone)]
pub struct Solver<P> {
    /// Where it stands.
    pub point: P,
    /// Normal equations where it stands.
    pub equations: NormalEquations,
    /// Root of the data's mean squared residual where it stands.
    pub rms: f64,
    /// Why it ended; `None` while it may go on.
    pub termination: Option<Termination>,
    options: SolverOptions,
    trial: NormalEquations,
    damping: Damping,
    /// D², of Levenberg and Marquardt's method.
    scale: DVector<f64>,
    step: DVector<f64>,
    /// The step that is judged where `step` is short because it was made so.
    full_step: DVector<f64>,
    memory: StepMemory,
    done: usize,
}

impl<P: Clone> Solver<P> {
    /// Evaluates the problem at its start.
    pub fn new(problem: &mut impl LeastSquares<Point = P>, start: P, options: SolverOptions) -> Self {
        let columns = problem.columns();
        let mut equations = NormalEquations::zeros(columns);
        problem.evaluate(&start, &mut equations);
        let termination = if !equations.is_finite() {
            Some(Termination::NotFinite)
        } else if options.max_iterations == 0 {
            Some(Termination::StepLimit { steps: 0 })
        } else {
            None
        };
        let rms = problem.rms();
        let damping = match options.method {
            Method::GaussNewton => Damping::fixed(options.damping),
            Method::LevenbergMarquardt => Damping::new(options.damping),
        };
        Self {
            options,
            point: start,
            trial: equations.clone(),
            equations,
            damping,
            scale: DVector::zeros(columns),
            step: DVector::zeros(columns),
            full_step: DVector::zeros(columns),
            memory: StepMemory::default(),
            rms,
            done: 0,
            termination,
        }
    }

    /// One iteration; `None` once it has ended.
    pub fn step(&mut self, problem: &mut impl LeastSquares<Point = P>) -> Option<Iteration<P>> {
        if self.termination.is_none() {
            self.termination = self.prepare_step(problem);
        }
        if self.termination.is_some() {
            return None;
        }
        self.attempt(problem).inspect_err(|termination| self.termination = Some(*termination)).ok()
    }

    /// Solves for the next step. Why there is none, if so.
    fn prepare_step(&mut self, problem: &impl LeastSquares<Point = P>) -> Option<Termination> {
        let Self { equations, options, scale, step, full_step, memory, .. } = self;
        if equations.jtr.amax() == 0.0 && !options.run_all {
            return Some(Termination::NoGradient);
        }
        let is_finite = match options.method {
            Method::GaussNewton => {
                equations.step_into(self.damping.value, memory, step);
                step.iter().all(|x| x.is_finite())
            }
            Method::LevenbergMarquardt => {
                levenberg_marquardt::widen(scale, equations, options.least_scale);
                equations.scaled_step_into(self.damping.value, scale, memory, step)
            }
        };
        if !is_finite {
            return Some(Termination::NotFinite);
        }
        full_step.copy_from(step);
        problem.cap(step);
        if options.run_all { None } else { self.converged() }
    }

    /// Whether the tests of convergence say that no further step is worth its while.
    fn converged(&mut self) -> Option<Termination> {
        let Tolerances { gain, step, gradient } = self.options.tolerances;
        let Self { equations, full_step, .. } = self;
        if let Some(tolerance) = gradient
            && equations.largest_cosine() <= tolerance
        {
            return Some(Termination::ConvergedByGradient { tolerance });
        }
        let gain = gain.filter(|_| self.options.method == Method::LevenbergMarquardt);
        let found = |full_step: &DVector<f64>| {
            if let Some(tolerance) = step.filter(|&step| full_step.amax() <= step) {
                return Some(Termination::ConvergedByStep { tolerance });
            }
            let gains_little = |&gain: &f64| equations.predicted_decrease(full_step) <= gain * equations.cost;
            gain.filter(gains_little).map(|tolerance| Termination::ConvergedByGain { tolerance })
        };
        let found_now = found(full_step);
        if found_now.is_none()
            || self.options.method == Method::GaussNewton
            || self.damping.value <= LOW_DAMPING
        {
            return found_now;
        }
        // The damping shortened it: what would one do that is hardly damped?
        let is_finite = equations.scaled_step_into(LOW_DAMPING, &self.scale, &mut self.memory, full_step);
        if is_finite { found(full_step) } else { None }
    }

    /// Makes a trial of the step and keeps it or takes it back.
    fn attempt(&mut self, problem: &mut impl LeastSquares<Point = P>) -> Result<Iteration<P>, Termination> {
        let (before, damping) = (self.equations.cost, self.damping.value);
        let gradient_max = self.equations.jtr.amax();
        let predicted_decrease = self.equations.predicted_decrease(&self.step);
        let point = problem.retract(&self.point, &self.step);
        self.trial.clear();
        problem.evaluate(&point, &mut self.trial);
        let (trial_cost, is_finite) = (self.trial.cost, self.trial.is_finite());
        let actual_decrease = before - trial_cost;
        let is_marquardt = self.options.method == Method::LevenbergMarquardt;
        if !is_finite && !is_marquardt {
            return Err(Termination::NotFinite);
        }
        let accepted = !is_marquardt || (is_finite && actual_decrease > 0.0);
        if accepted {
            std::mem::swap(&mut self.equations, &mut self.trial);
            self.point = point;
            self.rms = problem.rms();
        }
        match (is_marquardt, accepted) {
            (true, true) => self.damping.lower(actual_decrease / predicted_decrease),
            (true, false) => self.damping.raise(),
            _ => {}
        }
        self.done += 1;
        self.termination = self.judge(accepted, actual_decrease, before, damping);
        Ok(Iteration {
            point: self.point.clone(),
            stage: 0,
            cost: self.equations.cost,
            rms: self.rms,
            trial_cost,
            predicted_decrease,
            actual_decrease,
            damping,
            step_norm: self.step.norm(),
            gradient_max,
            accepted,
        })
    }

    /// Why this trial was the last one, if it was.
    fn judge(&self, accepted: bool, actual_decrease: f64, before: f64, damping: f64) -> Option<Termination> {
        let SolverOptions { method, max_iterations, tolerances, run_all, .. } = self.options;
        let limit = (self.done >= max_iterations).then_some(Termination::StepLimit { steps: self.done });
        if run_all {
            return limit;
        }
        match method {
            Method::GaussNewton => {
                let is_capped = self.step != self.full_step;
                let by_gain = |&gain: &f64| !is_capped && actual_decrease.abs() <= gain * before;
                let tolerance = tolerances.gain.filter(by_gain);
                tolerance.map(|tolerance| Termination::ConvergedByGain { tolerance }).or(limit)
            }
            Method::LevenbergMarquardt => {
                let is_stuck = !accepted && damping >= HIGH_DAMPING;
                is_stuck.then_some(Termination::NoDecrease).or(limit)
            }
        }
    }

    /// Cost where it stands.
    pub fn cost(&self) -> f64 {
        self.equations.cost
    }
}

#[cfg(test)]
pub(super) mod tests;
