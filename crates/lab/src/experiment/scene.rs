//! Simulated data of a pose: what the cameras of an experiment see.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::silhouette::{Label, Mask, MaskError, Measurement, MeasurementError, Overlap};
use serde::{Deserialize, Serialize};

use super::ExperimentError;

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

/// The exact silhouette of a pose's capsules: no grey levels, no noise.
///
/// # Errors
/// The camera's pictures are larger than a mask may be.
pub fn hard_mask(model: &Model, pose: &Pose, camera: &Camera) -> Result<Mask, MaskError> {
    // This ramp is half grey where the ray touches the surface.
    let levels = levels(model, pose, camera, RendererKind::Capsule, Ramp::Half);
    let label = |level: f64| if level < 127.5 { Label::Subject } else { Label::Background };
    Mask::new(camera.width(), camera.height(), levels.into_iter().map(label).collect())
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
    let evidence = match simulation {
        Simulation::Mask => Evidence::Mask(Arc::new(hard_mask(model, truth, camera)?)),
        Simulation::Prediction => {
            Evidence::Measurement(Arc::new(grey_levels(model, truth, camera, renderer, ramp)?))
        }
    };
    Ok(FitView { camera: Arc::clone(camera), evidence, weight: 1.0 })
}

/// The soft silhouette of a pose as data: every pixel of full weight.
///
/// # Errors
/// Numbers out of range, which no valid pose gives.
pub fn grey_levels(
    model: &Model,
    pose: &Pose,
    camera: &Camera,
    renderer: RendererKind,
    ramp: Ramp,
) -> Result<Measurement, MeasurementError> {
    let values: Vec<f32> =
        levels(model, pose, camera, renderer, ramp).into_iter().map(|level| level as f32).collect();
    let weights = vec![1.0; values.len()];
    Measurement::new(camera.width(), camera.height(), values, weights)
}

fn levels(model: &Model, pose: &Pose, camera: &Camera, renderer: RendererKind, ramp: Ramp) -> Vec<f64> {
    let kinematics = Kinematics::new(model, pose);
    prediction::levels(&View::new(model, &kinematics, camera, renderer, ramp))
}

/// How well a pose, drawn with hard edges, covers masks: all cameras together. A mask that is not of its camera's
/// size does not count.
#[must_use]
pub fn overlap(
    model: &Model,
    pose: &Pose,
    cameras: &[Arc<Camera>],
    masks: &[Mask],
    renderer: RendererKind,
) -> Overlap {
    let mut all = Overlap::default();
    for (camera, mask) in cameras.iter().zip(masks) {
        let drawn: Vec<f32> =
            levels(model, pose, camera, renderer, Ramp::Half).into_iter().map(|level| level as f32).collect();
        if let Ok(one) = Overlap::between(mask, &drawn) {
            all = all.merge(one);
        }
    }
    all
}
