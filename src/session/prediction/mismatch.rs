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
                let measurement = &data.measurement;
                let levels = [&prediction.lambda[run.clone()], &measurement.values()[run.clone()]];
                let [cost, without] = squares(levels, &measurement.weights()[run]);
                change += cost - without;
                *limb += camera_weight * cost;
            }
        }
        // Where a body explains all, rounding may leave less than nothing.
        let sum = camera_weight * (data.bodiless + change).max(0.0);
        Self { sum, weight: camera_weight * data.weight, by_limb }
    }
}

/// Pixels whose squares are added up side by side.
const LANES: usize = 8;

/// Σ w (D − Λ)² and Σ w (D − 255)² of pixels with these levels Λ and D.
fn squares([lambda, values]: [&[f32]; 2], weights: &[f32]) -> [f64; 2] {
    let mut sums = [[0.0; LANES]; 2];
    let mut add = |lane: usize, numbers: [f32; 3]| {
        let [lambda, value, weight] = numbers.map(f64::from);
        let [with, without] = [value - lambda, value - BACKGROUND];
        sums[0][lane] += weight * with * with;
        sums[1][lane] += weight * without * without;
    };
    let parts = [lambda, values, weights].map(<[f32]>::as_chunks::<LANES>);
    let [(lambda, lambda_rest), (values, values_rest), (weights, weights_rest)] = parts;
    for ((lambda, values), weights) in lambda.iter().zip(values).zip(weights) {
        (0..LANES).for_each(|lane| add(lane, [lambda[lane], values[lane], weights[lane]]));
    }
    for (lane, ((lambda, value), weight)) in lambda_rest.iter().zip(values_rest).zip(weights_rest).enumerate()
    {
        add(lane, [*lambda, *value, *weight]);
    }
    sums.map(|lanes| lanes.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_of_any_number_of_pixels_are_all_added() {
        for count in [0_u8, 1, 7, 8, 9, 40] {
            let levels: Vec<f32> = (0..count).map(|pixel| f32::from(pixel) * 2.5).collect();
            let (values, weights) = (vec![100.0_f32; levels.len()], vec![0.5_f32; levels.len()]);
            let of = |level: f32| 0.5 * f64::from(100.0 - level).powi(2);
            let [with, without] = squares([&levels, &values], &weights);
            assert!((with - levels.iter().map(|level| of(*level)).sum::<f64>()).abs() < 1e-6);
            assert!((without - f64::from(count) * of(255.0)).abs() < 1e-6);
        }
    }
}
