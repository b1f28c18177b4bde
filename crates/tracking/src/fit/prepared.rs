//! A fit's inputs, checked and made ready once.

use super::evidence::{FitError, FitView};
use super::options::FitOptions;
use crate::body::{Model, Pose};
use crate::silhouette::SignedDistance;

/// Views that have data, their distance fields, and a start of unit quaternions.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub(crate) views: Vec<FitView>,
    pub(crate) distances: Vec<Option<SignedDistance>>,
    pub(crate) start: Pose,
    /// Cameras that had nothing to say, by name.
    pub(crate) empty_cameras: Vec<String>,
}

impl Prepared {
    /// Checks all inputs. Distances are exact at least as far as the stages look, and as far as `reach_px`
    /// says for these views and this start.
    ///
    /// # Errors
    /// A pose that is not the model's, data that are not the camera's, options that make no sense, or no
    /// camera with a silhouette.
    pub(crate) fn new(
        model: &Model,
        views: Vec<FitView>,
        start: &Pose,
        options: &FitOptions,
        reach_px: impl Fn(&Model, &[FitView], &Pose) -> f64,
    ) -> Result<Self, FitError> {
        start.check(model)?;
        options.check()?;
        for view in &views {
            view.check()?;
        }
        let (views, empty): (Vec<FitView>, Vec<FitView>) = views.into_iter().partition(FitView::has_data);
        let empty_cameras: Vec<String> = empty.iter().map(|view| view.camera.name().to_owned()).collect();
        if views.is_empty() {
            let reasons = if empty_cameras.is_empty() {
                "no camera was given".to_owned()
            } else {
                format!("{} see no subject or have no weight", empty_cameras.join(", "))
            };
            return Err(FitError::NoData { reasons });
        }
        let start = start.normalized();
        let least = reach_px(model, &views, &start);
        let distances = views.iter().map(|view| view.distance_within(&options.stages, least)).collect();
        Ok(Self { views, distances, start, empty_cameras })
    }
}
