//! A choice of how to fit: what basins are compared for.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::search::{SearchOptions, fit_best};
use serde::Serialize;

use super::ExperimentError;

/// How every start of an experiment is fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitChoice {
    /// What distinguishes it from the others beside it.
    pub name: String,
    /// The choices of the fit.
    pub fit: FitOptions,
    /// Looking for other hypotheses; `None` goes downhill from the start alone.
    pub hypotheses: Option<SearchOptions>,
}

impl FitChoice {
    /// A fit that goes downhill from the start, with the choices as they are.
    #[must_use]
    pub fn downhill(name: &str, fit: FitOptions) -> Self {
        Self { name: name.to_owned(), fit, hypotheses: None }
    }

    /// Fits from a start to the end and says where that is.
    ///
    /// # Errors
    /// A fit that cannot begin, or `cancel`.
    pub fn end(
        &self,
        model: &Arc<Model>,
        views: Vec<FitView>,
        start: &Pose,
        cancel: &CancelToken,
    ) -> Result<Pose, ExperimentError> {
        let (model, options) = (Arc::clone(model), self.fit.clone());
        let mut fit = match &self.hypotheses {
            Some(effort) => fit_best(model, views, start, options, effort, cancel)?.0,
            None => Fit::new(model, views, start.clone(), options)?,
        };
        let pose = fit.run(cancel, |_| {}).pose;
        if cancel.is_cancelled() { Err(ExperimentError::Cancelled) } else { Ok(pose) }
    }
}
