//! How far a drawn pose is from the data of one camera: Σ w (D − Λ)², in all and for the pixels of each limb.
//!
//! Where no limb is near, Λ is 255, so the sum is that without a body, Σ w (D − 255)², and what the pixels of limbs
//! change in it. Only these are read.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::Prediction;
use super::prediction::NO_OWNER;
use super::ramp::BACKGROUND;
use crate::processor::run;
use crate::silhouette::Measurement;

/// Σ w (D − Λ)² of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Mismatch {
    /// Over all pixels, squared grey levels.
    pub cost: f64,
    /// Over the pixels of each limb, in the model's order.
    pub by_limb: Vec<f64>,
}

/// What a camera's mismatch is without a body: made once for each D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodilessMismatch {
    /// Σ w (D − 255)², squared grey levels.
    pub cost: f64,
    /// Σ w.
    pub weight: f64,
}

impl BodilessMismatch {
    /// Of this D.
    pub fn new(data: &Measurement) -> Self {
        let (mut weight, mut cost) = (0.0, 0.0);
        for (value, pixel_weight) in data.values().iter().zip(data.weights()) {
            let (residual, pixel_weight) = (f64::from(*value) - BACKGROUND, f64::from(*pixel_weight));
            weight += pixel_weight;
            cost += pixel_weight * residual * residual;
        }
        Self { cost, weight }
    }

    /// The mismatch with a body of this many limbs that is drawn so, of the same size as D. The same to the bit for
    /// all widths of vectors.
    pub fn with_body(self, drawn: &Prediction, data: &Measurement, limbs: usize) -> Mismatch {
        let mut by_limb = vec![0.0; limbs];
        let change = run(Change { drawn, data, by_limb: &mut by_limb });
        // Where a body explains all, rounding may leave less than nothing.
        Mismatch { cost: (self.cost + change).max(0.0), by_limb }
    }
}

/// Pixels whose squares are added up side by side, and whose owners are compared at once.
const LANES: usize = 8;

/// Σ w ((D − Λ)² − (D − 255)²) over the pixels of limbs. Adds Σ w (D − Λ)² to each limb's sum.
struct Change<'a> {
    drawn: &'a Prediction,
    data: &'a Measurement,
    by_limb: &'a mut [f64],
}

impl WithSimd for Change<'_> {
    type Output = f64;

    /// Nothing but loops over eight pixels: the compiler makes vectors of them, as wide as `S` allows.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let Self { drawn, data, by_limb } = self;
        let mut change = 0.0;
        for y in drawn.footprint.rows() {
            let (start, columns) = (y * drawn.width, drawn.footprint.columns(y));
            let end = start + columns.end;
            let mut pixel = start + columns.start;
            while pixel < end {
                let owner = drawn.owner[pixel];
                let run = pixel..pixel + run_length(&drawn.owner[pixel..end]);
                pixel = run.end;
                if owner != NO_OWNER
                    && let Some(limb) = by_limb.get_mut(usize::from(owner))
                {
                    let [cost, without] = squares(drawn, data, run);
                    change += cost - without;
                    *limb += cost;
                }
            }
        }
        change
    }
}

/// How many of the first pixels have one owner.
#[inline(always)]
fn run_length(owners: &[u16]) -> usize {
    let Some(first) = owners.first() else { return 0 };
    let (chunks, _) = owners.as_chunks::<LANES>();
    let alike = LANES * chunks.iter().take_while(|chunk| **chunk == [*first; LANES]).count();
    alike + owners[alike..].iter().take_while(|owner| *owner == first).count()
}

/// Σ w (D − Λ)² and Σ w (D − 255)² of these pixels.
#[inline(always)]
fn squares(drawn: &Prediction, data: &Measurement, pixels: Range<usize>) -> [f64; 2] {
    let mut sums = [[0.0; LANES]; 2];
    let mut add = |lane: usize, numbers: [f32; 3]| {
        let [lambda, value, weight] = numbers.map(f64::from);
        let [with, without] = [value - lambda, value - BACKGROUND];
        sums[0][lane] += weight * with * with;
        sums[1][lane] += weight * without * without;
    };
    let parts = [&drawn.lambda, data.values(), data.weights()];
    let parts = parts.map(|numbers| numbers[pixels.clone()].as_chunks::<LANES>());
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
    use glam::DVec3;

    use super::*;
    use crate::body::{Kinematics, Parameters, builtin};
    use crate::fixtures;
    use crate::render::{DrawOptions, Ramp, RendererKind, View, draw};
    use crate::silhouette::Label;

    #[test]
    fn runs_of_any_length_end_where_the_owner_changes() {
        for length in [1_u16, 2, 7, 8, 9, 15, 16, 17, 40] {
            let mut owners = vec![5_u16; usize::from(length)];
            assert_eq!(run_length(&owners), usize::from(length));
            owners.extend([6, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5, 5]);
            assert_eq!(run_length(&owners), usize::from(length));
        }
        assert_eq!(run_length(&[]), 0);
    }

    /// Against the sum over all pixels, one at a time.
    #[test]
    fn cost_and_limbs_are_the_plain_sums_over_pixels() {
        let model = builtin::upper_body();
        let pose = fixtures::stepped(&model, Parameters::Tangent, |index| 0.3 * (index as f64).sin());
        let kinematics = Kinematics::new(&model, &pose);
        let at = pose.root + DVec3::new(0.4, 0.2, 2.0);
        let camera = fixtures::camera([96, 80], [110.0, 110.0, 47.0, 41.0], at, pose.root, DVec3::NEG_Y);
        let view = View::new(&model, &kinematics, &camera, RendererKind::Capsule, Ramp::Half);
        let drawn = draw(&view, DrawOptions { gradient: false, motion: None }).prediction;
        let labels = [Label::Background, Label::Subject, Label::Subject, Label::Unknown];
        let mask = fixtures::painted([drawn.width, drawn.height], |x, y| labels[(x + 3 * y) / 5 % 4]);
        let data = Measurement::from_mask_averaged(&mask, 2);
        let limbs = model.limbs().len();
        let mut expected = Mismatch { cost: 0.0, by_limb: vec![0.0; limbs] };
        for (pixel, owner) in drawn.owner.iter().enumerate() {
            let numbers = [drawn.lambda[pixel], data.values()[pixel], data.weights()[pixel]];
            let [lambda, value, weight] = numbers.map(f64::from);
            let square = weight * (value - lambda).powi(2);
            expected.cost += square;
            if let Some(limb) = expected.by_limb.get_mut(usize::from(*owner)) {
                *limb += square;
            }
        }
        let mismatch = BodilessMismatch::new(&data).with_body(&drawn, &data, limbs);
        let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * expected.cost;
        assert!(expected.by_limb.iter().all(|cost| *cost > 0.0), "{expected:?}");
        assert!(is_near(mismatch.cost, expected.cost), "{mismatch:?}, {expected:?}");
        let mut limbs = mismatch.by_limb.iter().zip(&expected.by_limb);
        assert!(limbs.all(|(a, b)| is_near(*a, *b)), "{mismatch:?}, {expected:?}");
    }
}
