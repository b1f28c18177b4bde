//! Levenberg's and Marquardt's loop for problems that solve their own normal equations: blocks that do not meet, points that
//! are eliminated.

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
