//! A fit of a frame, before it is taken for the frame's pose.

use super::lost::Lost;
use crate::cancel::CancelToken;
use crate::fit::{Fit, SolverSummary};
use crate::search::Hypothesis;
use crate::silhouette::Overlap;

/// A frame's fit that has run.
pub(super) struct FittedPose {
    pub(super) fit: Fit,
    pub(super) summary: SolverSummary,
    pub(super) hypotheses: Vec<Hypothesis>,
}

impl FittedPose {
    pub(super) fn run(mut fit: Fit, hypotheses: Vec<Hypothesis>, cancel: &CancelToken) -> Self {
        let summary = fit.run(cancel, |_| {});
        Self { fit, summary, hypotheses }
    }
}

/// The same, and how it is judged.
pub(super) struct Attempt {
    pub(super) found: FittedPose,
    pub(super) overlap: Vec<Option<Overlap>>,
    pub(super) lost: Option<Lost>,
}

impl Attempt {
    /// A fit whose numbers ran out of range is never better, and any other is better than that.
    pub(super) fn is_better(&self, other: &Self) -> bool {
        rms(&self.found.summary).total_cmp(&rms(&other.found.summary)).is_lt()
    }
}

/// What a fit is judged by: infinite where the numbers ran out of range.
pub(super) fn rms(summary: &SolverSummary) -> f64 {
    if summary.is_broken() { f64::INFINITY } else { summary.final_rms }
}
