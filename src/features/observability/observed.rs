//! What the cameras see of a pose, and what they do not.

use backlit_tracking::body::Pose;
use backlit_tracking::fit::{Evidence, FitError, FitView};
use backlit_tracking::observability::{FrameInformation, Observability, SubsetFigures};

use crate::session::prediction::FitInputs;

/// What the cameras see of a pose.
#[derive(Debug)]
pub struct Observed {
    /// What it depends on besides the pose.
    pub(crate) inputs: FitInputs,
    pub(crate) pose: Pose,
    /// Of the cameras that count.
    pub shown: Observability,
    /// Sets of the cameras that have a silhouette, the best first.
    pub(crate) subsets: Vec<SubsetFigures>,
}

impl Observed {
    /// Looks through every camera that has a silhouette.
    ///
    /// # Errors
    /// See [`FrameInformation::new`].
    pub(crate) fn new(inputs: FitInputs, pose: Pose) -> Result<Self, FitError> {
        let view = |camera: usize| {
            let weight = inputs.uses.get(camera).map_or(1.0, |used| used.weight);
            let evidence = Evidence::Measurement(inputs.data(camera)?);
            Some(FitView { camera: inputs.cameras[camera].clone(), evidence, weight })
        };
        let views: Vec<Option<FitView>> = (0..inputs.cameras.len()).map(view).collect();
        let information = FrameInformation::new(&inputs.model, &views, &inputs.fit, &pose)?;
        let counts =
            |camera: &usize| inputs.uses.get(*camera).is_some_and(|used| used.used && used.weight > 0.0);
        let used: Vec<usize> = (0..views.len()).filter(counts).collect();
        let shown = information.observe(&used);
        let subsets = information.compare_subsets(shown.noise);
        Ok(Self { inputs, pose, shown, subsets })
    }
}
