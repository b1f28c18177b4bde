//! How far two cameras disagree about angles round the line through both centres: of the half-planes that touch the person, and of
//! those through joints that keypoints show.

use super::outlines::Clock;
use crate::statistics::{MAD, student_loss, upper_median};
use crate::synchronise::Recording;
use crate::synchronise::signals::{Pencil, Sample, Signal};

/// No pair is believed to be more exact, pixels.
const LEAST_NOISE_PX: f64 = 0.3;
/// Residuals hang together over at most so many samples.
const LONGEST_CORRELATION: f64 = 60.0;

/// A number each for what silhouettes say and what keypoints say, which are differently exact.
pub(super) type ByWitness = [f64; 2];

/// By how much two cameras' angles differ, pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Residuals {
    /// A number for each moment of the first camera, for low angles, for high ones, and then for each joint; `None` where there is
    /// nothing to compare.
    values: Vec<Option<f64>>,
    /// So many of them are silhouettes'.
    silhouettes: usize,
}

impl Residuals {
    /// All of them, silhouettes' first.
    pub(super) fn values(&self) -> &[Option<f64>] {
        &self.values
    }

    /// Those of silhouettes, and those of keypoints.
    pub(super) fn by_witness(&self) -> [&[Option<f64>]; 2] {
        self.values.split_at(self.silhouettes).into()
    }

    /// All of them, each with what is its witness's.
    pub(super) fn each_with<T: Copy>(&self, of: [T; 2]) -> impl Iterator<Item = (Option<f64>, T)> {
        let one = move |(at, value): (usize, &Option<f64>)| (*value, of[usize::from(at >= self.silhouettes)]);
        self.values.iter().enumerate().map(one)
    }

    /// Takes others in the place of those before a time. `seconds` are the first camera's moments.
    pub(super) fn keep_before(
        &mut self,
        before: &Self,
        seconds: impl Iterator<Item = f64> + Clone,
        split: f64,
    ) {
        for ((value, before), seconds) in self.values.iter_mut().zip(&before.values).zip(seconds.cycle()) {
            if seconds < split {
                *value = *before;
            }
        }
    }
}

/// What two cameras see of the half-planes through both centres, over time.
#[derive(Debug, Clone)]
pub(super) struct PairAngles {
    /// Low and high angles of both, and those of joints.
    kinds: Vec<[Signal; 2]>,
    /// When the first camera took its frames, by its own clock.
    seconds: Vec<f64>,
}

impl PairAngles {
    pub(super) fn of(a: &Recording, b: &Recording) -> Self {
        let periods = [a.period(), b.period()];
        let (tangents, joints) = Pencil::of([a, b])
            .map(|pencil| (pencil.tangents([a, b]), pencil.joints([a, b])))
            .unwrap_or_default();
        let kinds = tangents.into_iter().chain(joints);
        let kinds = kinds.map(|[a, b]| [Signal::new(a, periods[0]), Signal::new(b, periods[1])]).collect();
        Self { kinds, seconds: a.sightings.iter().map(|sighting| sighting.seconds).collect() }
    }

    /// By how much the two cameras' angles differ, where their clocks are changed.
    pub(super) fn residuals(&self, clocks: [Clock; 2]) -> Residuals {
        let count = self.seconds.len();
        let mut values = vec![None; self.kinds.len() * count];
        for (kind, [a, b]) in self.kinds.iter().enumerate() {
            let (mut near, mut at) = (0, 0);
            for sample in &a.samples {
                while self.seconds.get(at).is_some_and(|seconds| *seconds < sample.seconds) {
                    at += 1;
                }
                let other = b.at(clocks[1].own(clocks[0].common(sample.seconds)), &mut near);
                if let Some(slot) = values.get_mut(kind * count + at) {
                    *slot = other.and_then(|other| difference(sample, &other));
                }
            }
        }
        Residuals { values, silhouettes: 2 * count }
    }
}

/// `None` where the two rays do not meet before the cameras: then nothing touches both.
fn difference(a: &Sample, b: &Sample) -> Option<f64> {
    let pixel = (0.5 * (a.pixel.powi(2) + b.pixel.powi(2))).sqrt();
    (a.along > b.along).then_some((a.value - b.value) / pixel)
}

/// What a residual says for the calibration, nats, before it is divided by how they hang together.
pub(super) fn support_of(residual: Option<f64>, noise: f64, spread: f64) -> f64 {
    let most = (spread / noise).ln().max(0.0);
    residual.map_or(0.0, |residual| (most - student_loss(residual / noise)).max(0.0))
}

/// The same of all that are said.
pub(super) fn support(residuals: &Residuals, noise: ByWitness, spread: f64) -> ByWitness {
    let mut sums = [0.0; 2];
    for ((sum, values), noise) in sums.iter_mut().zip(residuals.by_witness()).zip(noise) {
        *sum = values.iter().map(|residual| support_of(*residual, noise, spread)).sum();
    }
    sums
}

/// Standard deviations from the median sizes, at most `most`. Angles of silhouettes that are missing count as far off. Joints that
/// keypoints do not show are hidden, and say nothing.
pub(super) fn noise<'a>(all: impl IntoIterator<Item = &'a Residuals>, most: f64) -> ByWitness {
    let mut sizes: [Vec<f64>; 2] = Default::default();
    for residuals in all {
        let [silhouettes, keypoints] = residuals.by_witness();
        sizes[0].extend(silhouettes.iter().map(|residual| residual.map_or(most, f64::abs)));
        sizes[1].extend(keypoints.iter().flatten().map(|residual| residual.abs()));
    }
    sizes.map(|mut sizes| {
        let median = upper_median(&mut sizes).unwrap_or(most);
        (median / MAD).clamp(LEAST_NOISE_PX, most.max(LEAST_NOISE_PX))
    })
}

/// The median size, pixels; `None` without any.
pub(super) fn median_px<'a>(residuals: impl IntoIterator<Item = &'a Option<f64>>) -> Option<f64> {
    let mut sizes: Vec<f64> = residuals.into_iter().flatten().map(|residual| residual.abs()).collect();
    upper_median(&mut sizes)
}

/// Over how many samples residuals hang together. Silhouettes' do from one moment to the next: (1 + ρ)/(1 − ρ) with their correlation
/// ρ. A detector puts a joint too far to one side all the time, which Σ (Σ r)² / Σ r² tells, inner sums over a pair's samples of one
/// joint.
pub(super) fn correlation_lengths<'a>(
    all: impl IntoIterator<Item = &'a Residuals>,
    noise: ByWitness,
) -> ByWitness {
    let (mut own, mut next) = (0.0, 0.0);
    let (mut squares, mut squared_sums) = (0.0, 0.0);
    for residuals in all {
        let [silhouettes, keypoints] = residuals.by_witness();
        let bounded =
            |residual: Option<f64>, noise: f64| residual.map(|px| px.clamp(-3.0 * noise, 3.0 * noise));
        for pair in silhouettes.windows(2) {
            if let [Some(a), Some(b)] = [bounded(pair[0], noise[0]), bounded(pair[1], noise[0])] {
                own += 0.5 * (a * a + b * b);
                next += a * b;
            }
        }
        for joint in keypoints.chunks((residuals.silhouettes / 2).max(1)) {
            let said = joint.iter().filter_map(|residual| bounded(*residual, noise[1]));
            squares += said.clone().map(|px| px * px).sum::<f64>();
            squared_sums += said.sum::<f64>().powi(2);
        }
    }
    let rho: f64 = if own > 0.0 { (next / own).clamp(0.0, 0.98) } else { 0.0 };
    let together = if squares > 0.0 { (squared_sums / squares).max(1.0) } else { 1.0 };
    [((1.0 + rho) / (1.0 - rho)).min(LONGEST_CORRELATION), together]
}
