//! What the convergence panel asks for.

use super::CurvesLook;

/// A wish of the convergence panel. Runs are named by their index in the session.
#[derive(Debug, Clone, PartialEq)]
pub enum CurvesRequest {
    /// Show something else.
    Look(CurvesLook),
    /// Call a run by a name; an empty one brings back the name that is made of its choices.
    Rename(usize, String),
    /// Forget a run.
    Remove(usize),
    /// Show this run's curve alone.
    ShowOnly(usize),
}
