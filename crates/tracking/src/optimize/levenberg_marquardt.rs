//! Levenberg and Marquardt: the damping says how far the linear model is trusted.
//!
//! A trial that lowers the cost is kept and the damping shrinks; one that does not is taken back and the
//! damping grows. See K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems" (2004).

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

/// Damping of the trial after one with this damping.
pub(super) fn next_damping(damping: f64, accepted: bool) -> f64 {
    if accepted {
        (damping * ON_ACCEPT).max(LEAST_DAMPING)
    } else {
        (damping.max(LEAST_DAMPING) * ON_REJECT).min(MOST_DAMPING)
    }
}
