//! The measurement D of the cost Σ w (D − λ)²: grey levels and weights, made from a mask.
//!
//! Three views of one mask, from the plainest to the most helpful to an optimiser:
//!
//! - hard: D = 0 on the subject, 255 elsewhere (4.24);
//! - area-averaged, which also stands for the smoothing of section 4.3: D = 255 · (background pixels) / (known pixels) in a small box, which gives the border sub-pixel grey levels;
//! - by distance: D = 255 · clip((sd + wᵢ) / (wᵢ + wₒ), 0, 1), with sd the signed distance and wᵢ, wₒ the widths of the
//!   ramp inside and outside the border, in pixels.
//!
//! Unknown pixels weigh nothing, and a known one counts less where they could change its D ([`super::distance_ramp`]).
//!
//! Equation numbers are those of P. Kaimakis, "Markerless Motion Capture", University of Cambridge, 2004.

use image::GrayImage;
use serde::{Deserialize, Serialize};

use super::box_average::box_average;
use super::distance::SignedDistance;
use super::distance_ramp::DistanceRamp;
use super::mask::{Label, Mask};

/// Grey level of background, and of everything that is surely not the subject.
pub(super) const BACKGROUND_LEVEL: f32 = 255.0;

/// Grey level shown for pixels about which nothing is known. It weighs nothing.
pub(super) const UNKNOWN_LEVEL: f32 = 127.5;

/// Why a measurement could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasurementError {
    /// The width or the height is zero.
    #[error("a measurement needs at least one pixel, not {} × {}", .0[0], .0[1])]
    Empty([usize; 2]),
    /// A buffer does not have width × height entries.
    #[error(
        "a measurement of {} × {} pixels cannot have {values} values and {weights} weights", size[0], size[1]
    )]
    WrongLength {
        /// Width and height in pixels.
        size: [usize; 2],
        /// Grey levels given.
        values: usize,
        /// Weights given.
        weights: usize,
    },
    /// A grey level is NaN or infinite, or a weight is that or negative.
    #[error("pixel {index} has the grey level {value} and the weight {weight}")]
    NotFinite {
        /// Index of the pixel, row by row.
        index: usize,
        /// Its grey level.
        value: f32,
        /// Its weight.
        weight: f32,
    },
    /// The distances belong to an image of another size than the mask.
    #[error("distances of {}×{} pixels do not fit a mask of {}×{}", distance.0, distance.1, mask.0, mask.1)]
    SizeMismatch {
        /// Width and height of the distances.
        distance: (usize, usize),
        /// Width and height of the mask.
        mask: (usize, usize),
    },
    /// The widths of the ramp are negative, not finite, or both zero.
    #[error("a ramp cannot be {inner_px} px wide inside and {outer_px} px outside")]
    InvalidRamp {
        /// Width inside the border, pixels.
        inner_px: f32,
        /// Width outside the border, pixels.
        outer_px: f32,
    },
}

/// A rectangle of pixels, as for a region of interest. It may reach beyond the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// First column.
    pub x: usize,
    /// First row.
    pub y: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

impl Region {
    /// Whether a pixel lies in the region.
    pub fn contains(&self, x: usize, y: usize) -> bool {
        (x >= self.x && x - self.x < self.width) && (y >= self.y && y - self.y < self.height)
    }
}

/// Grey levels D (0 subject to 255 background) and weights (0 for nothing, 1 for full) of one camera's frame.
///
/// Every value and weight is finite and no weight is negative.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    width: usize,
    height: usize,
    values: Vec<f32>,
    weights: Vec<f32>,
}

impl Measurement {
    /// A measurement from grey levels and weights, row by row.
    ///
    /// # Errors
    /// If there is no pixel, if a buffer does not have width × height entries, if an entry is not finite or if a weight
    /// is negative.
    pub fn new(
        width: usize,
        height: usize,
        values: Vec<f32>,
        weights: Vec<f32>,
    ) -> Result<Self, MeasurementError> {
        if width == 0 || height == 0 {
            return Err(MeasurementError::Empty([width, height]));
        }
        let pixels = width.checked_mul(height);
        if pixels != Some(values.len()) || pixels != Some(weights.len()) {
            let (values, weights) = (values.len(), weights.len());
            return Err(MeasurementError::WrongLength { size: [width, height], values, weights });
        }
        for (index, (&value, &weight)) in values.iter().zip(&weights).enumerate() {
            if !value.is_finite() || !weight.is_finite() || weight < 0.0 {
                return Err(MeasurementError::NotFinite { index, value, weight });
            }
        }
        Ok(Self { width, height, values, weights })
    }

    /// The mask as it is: 0 on the subject, 255 on background, no weight where nothing is known.
    pub fn from_mask_hard(mask: &Mask) -> Self {
        let values = mask.labels().iter().map(hard_level).collect();
        Self { width: mask.width(), height: mask.height(), values, weights: mask_weights(mask) }
    }

    /// The share of background among the known pixels of the box of (2 · `radius_px` + 1)² around each pixel, weighed by
    /// the share of known ones. The box is cut at the image's border. Radius 0 is [`Self::from_mask_hard`].
    pub fn from_mask_averaged(mask: &Mask, radius_px: usize) -> Self {
        let mut averaged = Self { width: 0, height: 0, values: Vec::new(), weights: Vec::new() };
        averaged.average(mask, radius_px);
        averaged
    }

    /// Becomes [`Self::from_mask_averaged`], in the memory that it has: for one frame after the other.
    pub fn average(&mut self, mask: &Mask, radius_px: usize) {
        (self.width, self.height) = (mask.width(), mask.height());
        box_average(mask, radius_px, &mut self.values, &mut self.weights);
    }

    /// D = 255 · clip((sd + `inner_px`) / (`inner_px` + `outer_px`), 0, 1), weighed by what unknown pixels could change.
    ///
    /// # Errors
    /// If the sizes differ, or if the widths are not finite, negative or both zero.
    pub fn from_distance(
        distance: &SignedDistance,
        mask: &Mask,
        inner_px: f32,
        outer_px: f32,
    ) -> Result<Self, MeasurementError> {
        let (width, height) = (mask.width(), mask.height());
        if (distance.width(), distance.height()) != (width, height) {
            let distance = (distance.width(), distance.height());
            return Err(MeasurementError::SizeMismatch { distance, mask: (width, height) });
        }
        let ramp = DistanceRamp::new(inner_px, outer_px)?;
        let (mut values, mut weights) = (vec![0.0; width * height], vec![0.0; width * height]);
        ramp.fill(distance, 0..width * height, mask.labels(), &mut values, &mut weights);
        Ok(Self { width, height, values, weights })
    }

    /// Grey levels as they are (0 = subject), each of full weight.
    pub fn from_gray(image: &GrayImage) -> Self {
        let values: Vec<f32> = image.as_raw().iter().map(|&level| f32::from(level)).collect();
        let weights = vec![1.0; values.len()];
        Self { width: image.width() as usize, height: image.height() as usize, values, weights }
    }

    /// The grey levels, rounded, as an image (black = subject). Weights are not shown.
    pub fn to_gray(&self) -> GrayImage {
        // A float cast saturates, so values beyond [0, 255] become its ends.
        GrayImage::from_fn(self.width as u32, self.height as u32, |x, y| {
            image::Luma([self.values[y as usize * self.width + x as usize].round() as u8])
        })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All grey levels, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// All weights, row by row.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }
}

/// Black for the subject, white for background, grey where nothing is known.
pub(crate) fn hard_level(label: &Label) -> f32 {
    match label {
        Label::Subject => 0.0,
        Label::Background => BACKGROUND_LEVEL,
        Label::Unknown => UNKNOWN_LEVEL,
    }
}

/// Full weight for what is known.
pub(crate) fn weight(label: &Label) -> f32 {
    if *label == Label::Unknown { 0.0 } else { 1.0 }
}

/// The weights of all pixels.
fn mask_weights(mask: &Mask) -> Vec<f32> {
    mask.labels().iter().map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Mask {
        Mask::from_ascii(".....\n.##?.\n.##..").unwrap()
    }

    #[test]
    fn hard_levels_are_the_mask() {
        let measurement = Measurement::from_mask_hard(&example());
        assert_eq!(measurement.values()[5..10], [255.0, 0.0, 0.0, 127.5, 255.0]);
        assert_eq!(measurement.weights()[5..10], [1.0, 1.0, 1.0, 0.0, 1.0]);
    }

    #[test]
    fn averages_count_known_pixels_of_the_box() {
        let mask = example();
        assert_eq!(Measurement::from_mask_averaged(&mask, 0), Measurement::from_mask_hard(&mask));
        let large = crate::fixtures::painted([83, 40], |x, y| match (y * 83 + x).pow(2) % 11 {
            3 => Label::Unknown,
            4 if (y * 83 + x) % 5 != 0 => Label::Subject,
            _ => Label::Background,
        });
        let mut averaged = Measurement::from_mask_hard(&large);
        for (mask, radii) in [(&mask, &[1, 2, 7, 8, usize::MAX - 1][..]), (&large, &[1, 2, 6, 7, 8, 20][..])]
        {
            let (width, height) = (mask.width(), mask.height());
            for &radius in radii {
                averaged.average(mask, radius);
                let found = (averaged.width(), averaged.height(), averaged.weights().len());
                assert_eq!(found, (width, height, width * height));
                for (i, &value) in averaged.values().iter().enumerate() {
                    let near = |at: usize, size: usize| {
                        at.saturating_sub(radius)..at.saturating_add(radius + 1).min(size)
                    };
                    let (rows, columns) = (near(i / width, height), near(i % width, width));
                    let all = (rows.len() * columns.len()) as f32;
                    let near = rows.flat_map(|y| mask.row(y).unwrap()[columns.clone()].iter());
                    let known: Vec<_> = near.filter(|&&label| label != Label::Unknown).collect();
                    let background = known.iter().filter(|&&&label| label == Label::Background).count();
                    let (background, known) = (background as f32, known.len() as f32);
                    assert_eq!(value, 255.0 * background / known, "radius {radius}, pixel {i}");
                    let weight = weight(&mask.labels()[i]) * known / all;
                    assert_eq!(averaged.weights()[i], weight, "radius {radius}, pixel {i}");
                }
            }
        }
    }

    #[test]
    fn a_ramp_of_distance_is_half_grey_on_the_border() {
        let mask = Mask::from_ascii("....####").unwrap();
        let distance = SignedDistance::from_mask(&mask);
        let measurement = Measurement::from_distance(&distance, &mask, 1.0, 2.0).unwrap();
        let third = 255.0 / 3.0;
        let expected = [3.0, 3.0, 2.5, 1.5, 0.5, 0.0, 0.0, 0.0].map(|n: f32| n * third);
        for (found, expected) in measurement.values().iter().zip(expected) {
            assert!((found - expected).abs() < 1e-4, "{:?}", measurement.values());
        }
    }

    #[test]
    fn impossible_ramps_are_errors() {
        let mask = example();
        let distance = SignedDistance::from_mask(&mask);
        for (inner, outer) in [
            (0.0, 0.0),
            (-1.0, 3.0),
            (f32::NAN, 1.0),
            (1.0, f32::INFINITY),
            (f32::MAX, f32::MAX),
            (1e-45, 0.0),
        ] {
            let result = Measurement::from_distance(&distance, &mask, inner, outer);
            assert!(matches!(result, Err(MeasurementError::InvalidRamp { .. })), "{inner} {outer}");
        }
        let other = Mask::filled(5, 4, Label::Subject).unwrap();
        let result = Measurement::from_distance(&distance, &other, 1.0, 1.0);
        assert_eq!(result, Err(MeasurementError::SizeMismatch { distance: (5, 3), mask: (5, 4) }));
    }

    #[test]
    fn gray_levels_survive_a_round_trip() {
        let image = GrayImage::from_raw(3, 1, vec![0, 128, 255]).unwrap();
        assert_eq!(Measurement::from_gray(&image).to_gray(), image);
    }

    #[test]
    fn unusable_numbers_are_errors() {
        let new = |size: [usize; 2], values: &[f32], weights: &[f32]| {
            Measurement::new(size[0], size[1], values.to_vec(), weights.to_vec())
        };
        assert!(new([2, 1], &[0.0, 255.0], &[1.0, 0.5]).is_ok());
        let found = new([2, 1], &[0.0, f32::NAN], &[1.0; 2]);
        assert!(matches!(found, Err(MeasurementError::NotFinite { index: 1, .. })));
        let found = new([2, 1], &[0.0; 2], &[-1.0; 2]);
        assert!(matches!(found, Err(MeasurementError::NotFinite { index: 0, .. })));
        let found = new([2, 2], &[0.0; 2], &[1.0; 2]);
        assert!(matches!(found, Err(MeasurementError::WrongLength { .. })));
    }
}
