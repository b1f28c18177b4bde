//! Levenberg and Marquardt: the damping says how far the linear model is trusted.
//!
//! (JᵀJ + λ D²) δ = Jᵀρ, with D² the largest diagonal of JᵀJ so far, column by column: metres and radians are not
//! alike, and a step is the same in whatever units the columns are. λ follows the gain ratio ϱ = actual decrease /
//! predicted decrease: the better the prediction, the less damping.
//!
//! - J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory" (1978): D.
//! - H. B. Nielsen, "Damping parameter in Marquardt's method" (1999): λ.
//!
//! Levenberg's and Marquardt's loop for problems that solve their own normal equations: blocks that do not meet, points that
//! are eliminated.

use nalgebra::DVector;

use super::NormalEquations;

/// Most that one step lowers the damping.
const MOST_LOWERED: f64 = 1.0 / 3.0;
/// Factor on the damping after the first of some rejected steps; each further factor is twice the one before.
const FIRST_RAISE: f64 = 2.0;
/// The damping stays above this: (JᵀJ + λ D²) is far from singular for rounding.
const LEAST_DAMPING: f64 = 1e-9;
/// And below this: a step is then far below rounding.
const MOST_DAMPING: f64 = 1e15;
/// A rejected step with more damping means that no step lowers the cost: it was some millionth of a full one.
pub(super) const HIGH_DAMPING: f64 = 1e6;
/// Damping that shortens a step by little in every direction that is seen.
pub(super) const LOW_DAMPING: f64 = 0.01;

/// λ, from trial to trial.
#[derive(Debug, Clone, Copy)]
pub(super) struct Damping {
    pub(super) value: f64,
    raise: f64,
}

impl Damping {
    pub(super) fn new(value: f64) -> Self {
        Self { value: value.clamp(LEAST_DAMPING, MOST_DAMPING), raise: FIRST_RAISE }
    }

    /// One that stays as it is.
    pub(super) fn fixed(value: f64) -> Self {
        Self { value, raise: FIRST_RAISE }
    }

    /// After a step that was kept, with its gain ratio.
    pub(super) fn lower(&mut self, gain_ratio: f64) {
        let factor = (1.0 - (2.0 * gain_ratio - 1.0).powi(3)).max(MOST_LOWERED);
        *self = Self::new(self.value * factor);
    }

    /// After a step that was taken back.
    pub(super) fn raise(&mut self) {
        self.value = (self.value * self.raise).min(MOST_DAMPING);
        self.raise *= 2.0;
    }
}

/// Takes the diagonal of JᵀJ into the scale D², at least this fraction of its mean.
pub(super) fn widen(scale: &mut DVector<f64>, equations: &NormalEquations, least: f64) {
    let least = least * equations.mean_diagonal();
    for (column, scale) in scale.iter_mut().enumerate() {
        *scale = scale.max(equations.jtj[(column, column)]).max(least);
    }
}

/// A least-squares problem with normal equations of a structure of its own.
pub trait StructuredLeastSquares {
    /// Where the problem can be evaluated.
    type Point;

    /// Cost at a point.
    fn cost(&mut self, point: &Self::Point) -> f64;

    /// Takes up the normal equations at the point whose cost was asked for last.
    fn linearise(&mut self, point: &Self::Point);

    /// Where the step of the damped equations leads. `None` where they have no solution.
    fn trial(&mut self, point: &Self::Point, damping: f64) -> Option<Self::Point>;
}

/// When the loop ends and how the damping follows what becomes of trials.
#[derive(Debug, Clone, Copy)]
pub struct DescentOptions {
    /// Damping of the first trial.
    pub damping: f64,
    /// Damping after a trial that was kept.
    pub lower: fn(f64) -> f64,
    /// Damping after a trial that was taken back.
    pub raise: fn(f64) -> f64,
    /// No trial is made with so much damping.
    pub most_damping: f64,
    /// Most trials.
    pub max_trials: usize,
    /// Most trials that are kept.
    pub max_steps: usize,
    /// A step that lowers the cost by a smaller fraction is the last one.
    pub tolerance: f64,
}

/// Where trials that lower the cost lead from a point.
pub fn descend<P: StructuredLeastSquares>(
    problem: &mut P,
    mut point: P::Point,
    options: &DescentOptions,
) -> P::Point {
    let (mut cost, mut damping) = (problem.cost(&point), options.damping);
    let (mut trials, mut steps) = (0, 0);
    if options.max_steps > 0 {
        problem.linearise(&point);
    }
    while steps < options.max_steps && trials < options.max_trials && damping < options.most_damping {
        trials += 1;
        let next = problem.trial(&point, damping).map(|next| (problem.cost(&next), next));
        let Some((lower, next)) = next.filter(|(trial_cost, _)| *trial_cost < cost) else {
            damping = (options.raise)(damping);
            continue;
        };
        let gain = (cost - lower) / cost;
        (cost, point) = (lower, next);
        damping = (options.lower)(damping);
        steps += 1;
        problem.linearise(&point);
        if gain < options.tolerance {
            break;
        }
    }
    point
}
