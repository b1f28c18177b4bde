//! Simulated data of a pose: what the cameras of an experiment see.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::render::{Ramp, RendererKind};
use backlit_tracking::silhouette::Overlap;
use serde::{Deserialize, Serialize};

use super::ExperimentError;
use crate::synthetic::capsules::{grey_levels, hard_mask, levels};

/// How data are made of a known pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Simulation {
    /// The renderer's own grey levels Λ(truth): data and model agree perfectly, as in the report's simulations.
    #[default]
    Prediction,
    /// A hard mask, as segmentation gives one: subject where the ray through the pixel's centre meets a capsule.
    Mask,
}

/// What one camera sees of a pose, as a fit takes it. `renderer` and `ramp` make the grey levels of
/// [`Simulation::Prediction`].
///
/// # Errors
/// The camera's pictures are larger than data may be.
pub fn view(
    model: &Model,
    truth: &Pose,
    camera: &Arc<Camera>,
    simulation: Simulation,
    renderer: RendererKind,
    ramp: Ramp,
) -> Result<FitView, ExperimentError> {
    if simulation == Simulation::Mask {
        return Ok(FitView::of_mask(Arc::clone(camera), hard_mask(model, truth, camera)?));
    }
    let evidence = Evidence::Measurement(Arc::new(grey_levels(model, truth, camera, renderer, ramp)?));
    Ok(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 })
}

/// How well a pose, drawn with hard edges, covers masks: all cameras together. A camera without a mask, or with one that
/// is not of its size, does not count.
#[must_use]
pub fn overlap(model: &Model, pose: &Pose, views: &[FitView], renderer: RendererKind) -> Overlap {
    let mut all = Overlap::default();
    for view in views {
        let Evidence::Mask(mask) = &view.evidence else { continue };
        let drawn = levels(model, pose, &view.camera, renderer, Ramp::Half);
        let drawn: Vec<f32> = drawn.into_iter().map(|level| level as f32).collect();
        if let Ok(one) = Overlap::between(mask, &drawn) {
            all = all.merge(one);
        }
    }
    all
}
