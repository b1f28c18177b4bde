//! How far a pose is from the data: one measure for fits, tracks, searches and what is on the screen.

use std::sync::Arc;

use backlit_tracking::render::{BodilessMismatch, Mismatch, Prediction};
use backlit_tracking::silhouette::{Label, Mask, Measurement};
use backlit_ui::drawing::PictureInput;

/// Σ w (D − Λ)² and its mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measured {
    /// Σ w (D − Λ)² over the cameras that count, squared grey levels.
    pub(crate) mismatch: f64,
    /// Root of its mean, grey levels.
    pub(crate) rms: Option<f64>,
}

impl Measured {
    /// Sums of cameras, in their order.
    pub(super) fn of<'a>(cameras: impl Iterator<Item = &'a CameraMismatch>) -> Self {
        let (mut mismatch, mut weight) = (0.0, 0.0);
        for camera in cameras {
            mismatch += camera.camera_weight * camera.mismatch.cost;
            weight += camera.camera_weight * camera.pixel_weight;
        }
        Self { mismatch, rms: (weight > 0.0).then(|| (mismatch / weight).sqrt()) }
    }
}

/// D of a camera, with what does not depend on the pose.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ComparedData {
    measurement: Arc<Measurement>,
    bodiless: BodilessMismatch,
    /// The mask's subject pixels.
    pub(super) subject_pixels: Option<usize>,
    /// Whether some pixel is unknown, and whether some pixel is shadow.
    pub(crate) has_unknown_and_shadow: [bool; 2],
}

impl ComparedData {
    pub(super) fn new(measurement: Arc<Measurement>, mask: Option<&Mask>) -> Self {
        let size = [measurement.width(), measurement.height()];
        let input = PictureInput { mask, data: Some(&measurement), ..PictureInput::empty(size) };
        let has_unknown_and_shadow = [input.has_unknown(), input.has_shadow()];
        let subject_pixels = mask.map(|mask| mask.count(Label::Subject));
        let bodiless = BodilessMismatch::new(&measurement);
        Self { measurement, bodiless, subject_pixels, has_unknown_and_shadow }
    }

    /// D.
    pub(crate) fn measurement(&self) -> &Measurement {
        &self.measurement
    }

    /// D, to be kept.
    pub(crate) fn shared(&self) -> Arc<Measurement> {
        self.measurement.clone()
    }

    /// How far a body of this many limbs that is drawn so is from it, in a camera of this weight.
    pub(super) fn mismatch(&self, drawn: &Prediction, camera_weight: f64, limbs: usize) -> CameraMismatch {
        let mismatch = self.bodiless.with_body(drawn, &self.measurement, limbs);
        CameraMismatch { camera_weight, pixel_weight: self.bodiless.weight, mismatch }
    }
}

/// A camera's share in [`Measured`].
pub(super) struct CameraMismatch {
    camera_weight: f64,
    /// Σ w.
    pixel_weight: f64,
    mismatch: Mismatch,
}

impl CameraMismatch {
    /// Σ w (D − Λ)² of each limb's pixels, with the camera's weight.
    pub(super) fn by_limb(&self) -> impl Iterator<Item = f64> + '_ {
        self.mismatch.by_limb.iter().map(|cost| self.camera_weight * cost)
    }
}
