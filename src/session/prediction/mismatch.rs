//! How far a pose is from the data: one measure for fits, tracks, searches and what is on the screen.

use std::sync::Arc;

use backlit_tracking::render::{BACKGROUND, Prediction};
use backlit_tracking::silhouette::{Mask, Measurement};
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
    pub(super) fn of<'a>(cameras: impl Iterator<Item = &'a Mismatch>) -> Self {
        let (mut mismatch, mut weight) = (0.0, 0.0);
        for camera in cameras {
            mismatch += camera.sum;
            weight += camera.weight;
        }
        Self { mismatch, rms: (weight > 0.0).then(|| (mismatch / weight).sqrt()) }
    }
}

/// D of a camera, with what does not depend on the pose.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ComparedData {
    measurement: Arc<Measurement>,
    /// Σ w.
    weight: f64,
    /// Σ w (D − 255)²: the mismatch without a body.
    bodiless: f64,
    /// Whether some pixel is unknown, and whether some pixel is shadow.
    pub(crate) has_unknown_and_shadow: [bool; 2],
}

impl ComparedData {
    pub(super) fn new(measurement: Arc<Measurement>, mask: Option<&Mask>) -> Self {
        let (mut weight, mut bodiless) = (0.0, 0.0);
        for (value, pixel_weight) in measurement.values().iter().zip(measurement.weights()) {
            let (residual, pixel_weight) = (f64::from(*value) - BACKGROUND, f64::from(*pixel_weight));
            weight += pixel_weight;
            bodiless += pixel_weight * residual * residual;
        }
        let size = [measurement.width(), measurement.height()];
        let input = PictureInput { mask, data: Some(&measurement), ..PictureInput::empty(size) };
        let has_unknown_and_shadow = [input.has_unknown(), input.has_shadow()];
        Self { measurement, weight, bodiless, has_unknown_and_shadow }
    }

    /// D.
    pub(crate) fn measurement(&self) -> &Measurement {
        &self.measurement
    }

    /// D, to be kept.
    pub(crate) fn shared(&self) -> Arc<Measurement> {
        self.measurement.clone()
    }
}

/// Σ w (D − Λ)² of a camera.
pub(super) struct Mismatch {
    sum: f64,
    weight: f64,
    pub(super) by_limb: Vec<f64>,
}

impl Mismatch {
    /// What the mismatch is without a body, and what the body's pixels change in it.
    pub(super) fn between(
        prediction: &Prediction,
        data: &ComparedData,
        camera_weight: f64,
        limbs: usize,
    ) -> Self {
        let mut by_limb = vec![0.0; limbs];
        let mut change = 0.0;
        for y in prediction.footprint.rows() {
            let (start, columns) = (y * prediction.width, prediction.footprint.columns(y));
            let row = start + columns.start..start + columns.end;
            let mut pixels = row.start;
            // Where no limb is near, λ is 255. Pixels of a limb follow one another.
            for pixels_of_limb in prediction.owner[row].chunk_by(|a, b| a == b) {
                let run = pixels..pixels + pixels_of_limb.len();
                pixels = run.end;
                let Some(limb) = by_limb.get_mut(usize::from(pixels_of_limb[0])) else { continue };
                let weights = &data.measurement.weights()[run.clone()];
                let levels = prediction.lambda[run.clone()].iter().zip(&data.measurement.values()[run]);
                let mut cost = 0.0;
                for ((lambda, value), weight) in levels.zip(weights) {
                    let [lambda, value, weight] = [lambda, value, weight].map(|number| f64::from(*number));
                    // (D − Λ)² − (D − 255)².
                    change += weight * (BACKGROUND - lambda) * (2.0 * value - lambda - BACKGROUND);
                    cost += weight * (value - lambda) * (value - lambda);
                }
                *limb += camera_weight * cost;
            }
        }
        // Where a body explains all, rounding may leave less than nothing.
        let sum = camera_weight * (data.bodiless + change).max(0.0);
        Self { sum, weight: camera_weight * data.weight, by_limb }
    }
}
