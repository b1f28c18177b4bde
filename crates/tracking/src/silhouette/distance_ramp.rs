//! D of a signed distance, D = 255 · clip((sd + wᵢ) / (wᵢ + wₒ), 0, 1), and what unknown pixels take from its weight.
//!
//! Unknown pixels weigh nothing, and a known one counts less where they could change its D. Let D₁ be its grey level if
//! all unknown pixels are subject and D₀ if all are background: whatever they are, D lies in [D₁, D₀]. If every level in
//! there is as likely, D is the middle with a variance of (D₀ − D₁)² / 12, and of 255² / 12 where nothing is known at all. The
//! weight is the share of that variance which is gone,
//!
//! w = 1 − (D₀ − D₁)² / 255²,
//!
//! 1 where the two agree, 0 where anything is possible. So by distance D is the middle of the interval, and w times its
//! error is at most 255 / √27 = 49 grey levels, whatever the unknown pixels are. By averages D is the share of background
//! among the known pixels, as normalised convolution has it (H. Knutsson & C.-F. Westin, CVPR 1993), and so is its w, the
//! share of known ones.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::SignedDistance;
use super::mask::Label;
use super::measurement::{BACKGROUND_LEVEL, MeasurementError, weight};
use crate::processor;

/// The grey level of a signed distance: D = 255 · clip((sd + wᵢ) / (wᵢ + wₒ), 0, 1).
#[derive(Clone, Copy, Debug)]
pub(crate) struct DistanceRamp {
    inner_px: f32,
    /// Grey levels a pixel.
    slope: f32,
}

impl DistanceRamp {
    /// A ramp of these widths inside and outside the border.
    pub(crate) fn new(inner_px: f32, outer_px: f32) -> Result<Self, MeasurementError> {
        let total_px = inner_px + outer_px;
        if !(inner_px >= 0.0
            && outer_px >= 0.0
            && total_px.is_normal()
            && (BACKGROUND_LEVEL / total_px).is_normal())
        {
            return Err(MeasurementError::InvalidRamp { inner_px, outer_px });
        }
        Ok(Self { inner_px, slope: BACKGROUND_LEVEL / total_px })
    }

    /// D at a signed distance in pixels.
    #[inline(always)]
    pub(crate) fn level(self, sd: f32) -> f32 {
        ((sd + self.inner_px) * self.slope).clamp(0.0, BACKGROUND_LEVEL)
    }

    /// D and the weight of a pixel that is so far from the nearest unknown one, less a half: the middle and the
    /// certainty of what it may be (see above).
    #[inline(always)]
    fn level_and_weight(self, sd: f32, to_unknown: f32, label: &Label) -> (f32, f32) {
        let [known, other] = [sd, sd.abs().min(to_unknown).copysign(sd)].map(|sd| self.level(sd));
        let open = (known - other) / BACKGROUND_LEVEL;
        (0.5 * (known + other), weight(label) * (1.0 - open * open))
    }

    /// D and the weights of some pixels of a field, whose labels are these.
    pub(crate) fn fill(
        self,
        distance: &SignedDistance,
        pixels: Range<usize>,
        labels: &[Label],
        values: &mut [f32],
        weights: &mut [f32],
    ) {
        let border = &distance.values()[pixels.clone()];
        if let Some(unknown) = distance.to_unknown() {
            let distances = [border, &unknown[pixels]];
            processor::run(Fill { ramp: self, distances, labels, values, weights });
            return;
        }
        for ((value, slot), (&sd, label)) in values.iter_mut().zip(weights).zip(border.iter().zip(labels)) {
            (*value, *slot) = (self.level(sd), weight(label));
        }
    }
}

/// [`DistanceRamp::fill`], whose work is compiled once more for wider vectors.
struct Fill<'a> {
    ramp: DistanceRamp,
    distances: [&'a [f32]; 2],
    labels: &'a [Label],
    values: &'a mut [f32],
    weights: &'a mut [f32],
}

impl WithSimd for Fill<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { ramp, distances: [border, unknown], labels, values, weights } = self;
        let pixels = border.iter().zip(unknown).zip(labels);
        for ((value, weight), ((&border, &unknown), label)) in values.iter_mut().zip(weights).zip(pixels) {
            (*value, *weight) = ramp.level_and_weight(border, unknown, label);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Mask, Measurement};
    use super::*;

    /// A mask, and the same with its unknown pixels turned out to be one thing or the other.
    fn veiled_and_true() -> impl Strategy<Value = (Mask, Mask)> {
        let label = prop_oneof![
            3 => Just([Label::Background; 2]),
            3 => Just([Label::Subject; 2]),
            1 => Just([Label::Unknown, Label::Background]),
            1 => Just([Label::Unknown, Label::Subject]),
        ];
        (1..9_usize, 1..9_usize, 0..3_usize, proptest::collection::vec(label, 64)).prop_map(
            |(width, height, scale, labels)| {
                let (width, height) = (width << scale, height << scale);
                let at = |i: usize| labels[((i / width) >> scale) * 8 + ((i % width) >> scale)];
                let mask = |which: usize| {
                    Mask::new(width, height, (0..width * height).map(|i| at(i)[which]).collect()).unwrap()
                };
                (mask(0), mask(1))
            },
        )
    }

    proptest! {
        /// Background beside a hidden part of the body was wrong by up to 187 grey levels, and counted fully.
        #[test]
        fn what_is_hidden_misleads_its_neighbours_little(
            (veiled, truth) in veiled_and_true(),
            inner in 0.0..3_f32,
            outer in 0.5..24_f32,
            radius in 0..4_usize,
        ) {
            let by_distance = |mask: &Mask| {
                Measurement::from_distance(&SignedDistance::from_mask(mask), mask, inner, outer).unwrap()
            };
            let averaged = |mask: &Mask| Measurement::from_mask_averaged(mask, radius);
            let pairs = [
                (by_distance(&veiled), by_distance(&truth), 255.0 / 27_f32.sqrt()),
                (averaged(&veiled), averaged(&truth), 255.0 / 4.0),
            ];
            for (found, truth, most) in pairs {
                for (i, (&value, &weight)) in found.values().iter().zip(found.weights()).enumerate() {
                    let error = (value - truth.values()[i]).abs();
                    prop_assert!(weight * error <= most + 1e-3, "{error} at weight {weight} in\n{veiled}");
                    // The weight of a Δ so small that f32 rounds 1 − Δ²/255² to one.
                    let rounding = 0.5 * 255.0 * f32::EPSILON.sqrt();
                    prop_assert!(weight < 1.0 || error < rounding, "{error} at full weight in\n{veiled}");
                }
            }
        }
    }
}
