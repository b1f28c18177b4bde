//! What a camera sees of a model's own capsules: data that a prediction can match to the bit.

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::silhouette::{Label, Mask, MaskError, Measurement, MeasurementError};

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

/// Λ of a pose, row by row.
pub(crate) fn levels(
    model: &Model,
    pose: &Pose,
    camera: &Camera,
    renderer: RendererKind,
    ramp: Ramp,
) -> Vec<f64> {
    let kinematics = Kinematics::new(model, pose);
    prediction::levels(&View::new(model, &kinematics, camera, renderer, ramp))
}
