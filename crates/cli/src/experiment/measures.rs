//! What several experiments measure: named fits, a fit's way iteration by iteration, statistics of errors.

use std::sync::Arc;

use anyhow::Result;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::statistics::{Statistics, median};
use serde::Serialize;

use super::Run;

/// A fit ends well when its mean joint error is below this, millimetres.
pub(crate) const GOOD_MM: f64 = 20.0;

/// What is compared: a name for tables and plots, and every choice of the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct NamedFit {
    pub(crate) name: String,
    pub(crate) fit: FitOptions,
}

impl NamedFit {
    pub(crate) fn new(name: &str, fit: FitOptions) -> Self {
        Self { name: name.to_owned(), fit }
    }
}

/// One fit against its truth: entry 0 is the start, then one entry an iteration.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct FitCurve {
    pub(crate) name: String,
    /// Squared grey levels, by the measure of each iteration's stage.
    pub(crate) costs: Vec<f64>,
    pub(crate) joint_errors_mm: Vec<f64>,
    pub(crate) termination: &'static str,
}

impl FitCurve {
    /// Runs a fit to its end.
    pub(crate) fn of(
        name: &str,
        model: &Arc<Model>,
        truth: &Pose,
        views: Vec<FitView>,
        start: &Pose,
        options: FitOptions,
        run: &Run,
    ) -> Result<Self> {
        let mut fit = Fit::new(Arc::clone(model), views, start.clone(), options)?;
        let summary = fit.run(&run.cancel, |_| {});
        run.check()?;
        let later = &summary.iterations;
        let poses = std::iter::once(start).chain(later.iter().map(|record| &record.point));
        let costs = std::iter::once(summary.initial_cost).chain(later.iter().map(|record| record.cost));
        Ok(Self {
            name: name.to_owned(),
            costs: costs.collect(),
            joint_errors_mm: poses.map(|pose| mean_joint_error_mm(model, pose, truth)).collect(),
            termination: summary.termination.name(),
        })
    }

    /// Cost after every iteration in percent of the start's; all zero if that is.
    pub(crate) fn percent_of_start(&self) -> Vec<f64> {
        let start = self.costs.first().copied().unwrap_or_default();
        let percent = |cost: &f64| if start > 0.0 { 100.0 * cost / start } else { 0.0 };
        self.costs.iter().map(percent).collect()
    }

    pub(crate) fn final_percent(&self) -> f64 {
        last(&self.percent_of_start())
    }

    pub(crate) fn final_joint_error_mm(&self) -> f64 {
        last(&self.joint_errors_mm)
    }
}

/// Statistics of errors, millimetres; zero where there are none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub(crate) struct ErrorStatistics {
    pub(crate) mean_mm: f64,
    pub(crate) p95_mm: f64,
    pub(crate) max_mm: f64,
}

impl ErrorStatistics {
    pub(crate) fn of(errors: &[f64]) -> Option<Self> {
        Statistics::of(errors).map(|all| Self { mean_mm: all.mean, p95_mm: all.p95, max_mm: all.max })
    }
}

/// The last of a list; 0 if it is empty.
pub(crate) fn last(list: &[f64]) -> f64 {
    list.last().copied().unwrap_or_default()
}

/// Medians of lists, entry by entry; a list that is shorter than others goes on with its last entry.
pub(crate) fn medians(lists: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let lists: Vec<Vec<f64>> = lists.filter(|list| !list.is_empty()).collect();
    let length = lists.iter().map(Vec::len).max().unwrap_or(0);
    let entry = |at: usize| {
        let mut values: Vec<f64> = lists.iter().map(|list| list[at.min(list.len() - 1)]).collect();
        median(&mut values)
    };
    (0..length).filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_go_on_where_a_list_ends() {
        let lists = [vec![1.0, 2.0, 3.0], vec![5.0], vec![0.0, 9.0]];
        assert_eq!(medians(lists.into_iter()), [1.0, 5.0, 5.0]);
    }
}
