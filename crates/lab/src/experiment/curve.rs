//! One fit, iteration by iteration, against its truth.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::metrics::mean_joint_error_mm;
use serde::Serialize;

use super::ExperimentError;

/// What a fit did: entry 0 is the start, then one entry an iteration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// What distinguishes this fit from the others beside it.
    pub name: String,
    /// Cost, squared grey levels, by the measure of each iteration's stage.
    pub costs: Vec<f64>,
    /// Mean distance of the limbs' ends from the truth's, millimetres.
    pub joint_errors_mm: Vec<f64>,
    /// Why it ended, as files have it.
    pub termination: &'static str,
}

impl Curve {
    /// Runs a fit to its end.
    ///
    /// # Errors
    /// A fit that cannot begin, or `cancel`.
    pub fn of(
        name: &str,
        model: &Arc<Model>,
        truth: &Pose,
        views: Vec<FitView>,
        start: &Pose,
        options: FitOptions,
        cancel: &CancelToken,
    ) -> Result<Self, ExperimentError> {
        let mut fit = Fit::new(Arc::clone(model), views, start.clone(), options)?;
        let summary = fit.run(cancel, |_| {});
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let later = &summary.iterations;
        let poses = std::iter::once(start).chain(later.iter().map(|record| &record.point));
        Ok(Self {
            name: name.to_owned(),
            costs: std::iter::once(summary.initial_cost)
                .chain(later.iter().map(|record| record.cost))
                .collect(),
            joint_errors_mm: poses.map(|pose| mean_joint_error_mm(model, pose, truth)).collect(),
            termination: summary.termination.name(),
        })
    }

    /// Cost after every iteration in percent of the start's; all zero if that is.
    #[must_use]
    pub fn percent_of_start(&self) -> Vec<f64> {
        let start = self.costs.first().copied().unwrap_or_default();
        let percent = |cost: &f64| if start > 0.0 { 100.0 * cost / start } else { 0.0 };
        self.costs.iter().map(percent).collect()
    }

    /// The last cost in percent of the first.
    #[must_use]
    pub fn final_percent(&self) -> f64 {
        self.percent_of_start().last().copied().unwrap_or_default()
    }

    /// The last joint error, millimetres.
    #[must_use]
    pub fn final_joint_error_mm(&self) -> f64 {
        self.joint_errors_mm.last().copied().unwrap_or_default()
    }
}
