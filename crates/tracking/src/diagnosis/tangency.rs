//! How far two cameras disagree about the half-planes that touch the person.

use super::outlines::Clock;
use crate::statistics::upper_median;
use crate::synchronise::Recording;
use crate::synchronise::signals::{Sample, Signal, tangents};

/// Degrees of freedom of the residuals' distribution (Student's): outliers are expected.
const FREEDOM: f64 = 4.0;
/// A median absolute deviation is this part of a standard deviation.
const MAD: f64 = 0.674_489_75;
/// No pair is believed to be more exact, pixels.
const LEAST_NOISE_PX: f64 = 0.3;
/// Residuals hang together over at most so many samples.
const LONGEST_CORRELATION: f64 = 60.0;

/// One number for each moment of the first camera, low angles first, pixels; `None` where there is nothing to compare.
pub(super) type Residuals = Vec<Option<f64>>;

/// What two cameras' silhouettes say of the half-planes through both centres, over time.
#[derive(Debug, Clone)]
pub(super) struct PairTangents {
    /// Low and high angles of both.
    sides: Vec<[Signal; 2]>,
    /// When the first camera took its frames, by its own clock.
    seconds: Vec<f64>,
}

impl PairTangents {
    pub(super) fn of(a: &Recording, b: &Recording) -> Self {
        let periods = [a.period(), b.period()];
        let sides = tangents([a, b]).into_iter();
        let sides = sides.map(|[a, b]| [Signal::new(a, periods[0]), Signal::new(b, periods[1])]).collect();
        Self { sides, seconds: a.sightings.iter().map(|sighting| sighting.seconds).collect() }
    }

    /// By how much the two cameras' angles differ, where their clocks are changed.
    pub(super) fn residuals(&self, clocks: [Clock; 2]) -> Residuals {
        let count = self.seconds.len();
        let mut all = vec![None; 2 * count];
        for (side, [a, b]) in self.sides.iter().enumerate() {
            let (mut near, mut at) = (0, 0);
            for sample in &a.samples {
                while self.seconds.get(at).is_some_and(|seconds| *seconds < sample.seconds) {
                    at += 1;
                }
                let other = b.at(clocks[1].own(clocks[0].common(sample.seconds)), &mut near);
                if let Some(slot) = all.get_mut(side * count + at) {
                    *slot = other.and_then(|other| difference(sample, &other));
                }
            }
        }
        all
    }
}

/// `None` where the two rays do not meet before the cameras: then nothing touches both.
fn difference(a: &Sample, b: &Sample) -> Option<f64> {
    let pixel = (0.5 * (a.pixel.powi(2) + b.pixel.powi(2))).sqrt();
    (a.along > b.along).then_some((a.value - b.value) / pixel)
}

/// The robust loss of a residual of so many deviations: half a squared one where it is small.
pub(super) fn loss(deviations: f64) -> f64 {
    0.5 * (FREEDOM + 1.0) * (deviations * deviations / FREEDOM).ln_1p()
}

/// The weight of a residual of so many deviations in the normal equations.
pub(super) fn weight(deviations: f64) -> f64 {
    (FREEDOM + 1.0) / (FREEDOM + deviations * deviations)
}

/// What residuals say for the calibration, nats, before it is divided by how they hang together.
pub(super) fn support(residuals: &[Option<f64>], noise: f64, spread: f64) -> f64 {
    let most = (spread / noise).ln().max(0.0);
    residuals.iter().flatten().map(|residual| (most - loss(residual / noise)).max(0.0)).sum()
}

/// Standard deviation from the median size; those that are missing count as far off. At most `most`.
pub(super) fn noise<'a>(all: impl IntoIterator<Item = &'a Residuals>, most: f64) -> f64 {
    let mut sizes: Vec<f64> =
        all.into_iter().flatten().map(|residual| residual.map_or(most, f64::abs)).collect();
    (upper_median(&mut sizes).unwrap_or(most) / MAD).clamp(LEAST_NOISE_PX, most.max(LEAST_NOISE_PX))
}

/// The median size, pixels; `None` without any.
pub(super) fn median_px(residuals: &[Option<f64>]) -> Option<f64> {
    let mut sizes: Vec<f64> = residuals.iter().flatten().map(|residual| residual.abs()).collect();
    upper_median(&mut sizes)
}

/// Over how many samples residuals hang together: (1 + ρ)/(1 − ρ) with their correlation ρ from one to the next.
pub(super) fn correlation_length<'a>(all: impl IntoIterator<Item = &'a Residuals>, noise: f64) -> f64 {
    let (mut own, mut next) = (0.0, 0.0);
    for residuals in all {
        for pair in residuals.windows(2) {
            let bounded = |residual: Option<f64>| residual.map(|px| px.clamp(-3.0 * noise, 3.0 * noise));
            if let [Some(a), Some(b)] = [bounded(pair[0]), bounded(pair[1])] {
                own += 0.5 * (a * a + b * b);
                next += a * b;
            }
        }
    }
    let rho = if own > 0.0 { (next / own).clamp(0.0, 0.98) } else { 0.0 };
    ((1.0 + rho) / (1.0 - rho)).min(LONGEST_CORRELATION)
}
