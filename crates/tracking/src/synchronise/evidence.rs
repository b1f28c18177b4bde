//! How well one camera's silhouettes predict another's at every offset of their clocks.

use super::answer::{PairOffset, SynchroniseOptions};
use super::signals::{Common, PairSignals};
use crate::statistics::{MAD, student_loss};

/// By cue: motion of this speed counts half, pixels a second; the same share of the spread for signals without pixels.
const HALF_SPEED: [f64; 2] = [5.0, 0.25];
/// A sample that does not move still counts this much.
const STILL_WEIGHT: f64 = 0.02;
/// By cue: the least noise that is believed, pixels; the same share of the spread for signals without pixels.
const LEAST_NOISE: [f64; 2] = [0.5, 0.1];
/// An edge may always be off by this many pixels, or spreads, in one camera beside the other.
const MOST_BIAS: f64 = 12.0;
/// The noise is that of the best offset among those that see at least this share of the most motion that any sees.
const ENOUGH_MOTION: f64 = 0.25;
/// Samples that two cameras must have in common at an offset.
const LEAST_SAMPLES: usize = 12;

/// E(τ) of a pair on a grid of offsets.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    /// The first offset, seconds.
    pub(super) first: f64,
    pub(super) step: f64,
    /// Nats; `None` where the two have too little in common.
    pub(super) values: Vec<Option<f64>>,
}

impl Curve {
    /// Offset of a place in the grid.
    pub(super) fn offset(&self, index: usize) -> f64 {
        self.first + self.step * index as f64
    }

    /// Between the grid's offsets; nothing is known beyond it.
    pub(super) fn at(&self, offset: f64) -> f64 {
        let place = (offset - self.first) / self.step;
        let below = place.floor();
        if below < 0.0 || !place.is_finite() {
            return 0.0;
        }
        let value = |index: usize| self.values.get(index).copied().flatten();
        let (index, share) = (below as usize, place - below);
        match [value(index), value(index + 1)] {
            [Some(a), Some(b)] => a + share * (b - a),
            [Some(a), None] if share == 0.0 => a,
            _ => 0.0,
        }
    }

    /// The largest evidence of all.
    pub(super) fn best(&self) -> f64 {
        self.values.iter().flatten().copied().fold(0.0, f64::max)
    }
}

/// Two cameras, compared.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Comparison {
    /// Indices of their recordings, the smaller first.
    pub(super) cameras: [usize; 2],
    signals: PairSignals,
    pub(super) curve: Curve,
    /// Pixels, or shares of the spread.
    noise: f64,
    /// Samples over which residuals hang together.
    correlated: f64,
}

/// One sample of a camera beside the other's at an offset.
#[derive(Debug, Clone, Copy)]
struct Residual {
    /// Units of noise: pixels or spreads.
    value: f64,
    weight: f64,
    /// ln(s) of its signal.
    ln_spread: f64,
    /// By how much it changes with the offset beside its bias, units a second.
    slope: f64,
}

impl Comparison {
    /// `None` where the two never have enough in common.
    pub(super) fn new(
        cameras: [usize; 2],
        signals: PairSignals,
        spans: [[f64; 2]; 2],
        step: f64,
        options: &SynchroniseOptions,
    ) -> Option<Self> {
        let [a, b] = spans;
        let common = options.least_overlap * (a[1] - a[0]).min(b[1] - b[0]);
        let lowest = (b[0] - a[1] + common).max(-options.farthest_s);
        let highest = (b[1] - a[0] - common).min(options.farthest_s);
        // 0 is among the offsets, so that clocks that agree are found to agree.
        let (below, above) = ((lowest / step).ceil(), (highest / step).floor());
        if !(below <= above && step > 0.0) {
            return None;
        }
        let count = (above - below) as usize + 1;
        let curve = Curve { first: below * step, step, values: vec![None; count] };
        let least_noise = LEAST_NOISE[signals.cue as usize];
        let mut this = Self { cameras, signals, curve, noise: least_noise, correlated: 1.0 };
        let looks: Vec<Option<(f64, f64)>> =
            (0..count).map(|index| scale(&this.residuals(this.curve.offset(index)))).collect();
        let most = looks.iter().flatten().map(|look| look.1).fold(0.0, f64::max);
        let is_moving = |look: &&(f64, f64)| look.1 >= ENOUGH_MOTION * most;
        let least = looks.iter().flatten().filter(is_moving).map(|look| look.0).min_by(f64::total_cmp)?;
        this.noise = least.max(least_noise);
        let plain: Vec<Option<f64>> =
            (0..count).map(|index| this.evidence(this.curve.offset(index))).collect();
        let best = (0..count)
            .filter(|&index| plain[index].is_some())
            .max_by(|&a, &b| plain[a].unwrap_or(0.0).total_cmp(&plain[b].unwrap_or(0.0)))?;
        this.correlated = correlation_length(&this.residuals(this.curve.offset(best)));
        this.curve.values = plain.iter().map(|value| value.map(|nats| nats / this.correlated)).collect();
        Some(this)
    }

    /// E(τ) before it is divided by how residuals hang together.
    fn evidence(&self, offset: f64) -> Option<f64> {
        let residuals = self.residuals(offset);
        if residuals.len() < LEAST_SAMPLES {
            return None;
        }
        let gain = |residual: &Residual| {
            let share = residual.value / self.noise;
            residual.weight * (residual.ln_spread - self.noise.ln() - student_loss(share))
        };
        Some(residuals.iter().map(gain).sum())
    }

    /// All samples of the first camera that the second has a number for, each signal without its bias.
    fn residuals(&self, offset: f64) -> Vec<Residual> {
        let mut all = Vec::new();
        for common in &self.signals.common {
            let from = all.len();
            self.residuals_of(common, offset, &mut all);
            let bias = weighted_median(&all[from..]).clamp(-MOST_BIAS, MOST_BIAS);
            let weights: f64 = all[from..].iter().map(|residual| residual.weight).sum();
            let slopes: f64 = all[from..].iter().map(|residual| residual.weight * residual.slope).sum();
            for residual in &mut all[from..] {
                residual.value -= bias;
                residual.slope -= slopes / weights;
            }
        }
        all
    }

    fn residuals_of(&self, common: &Common, offset: f64, all: &mut Vec<Residual>) {
        let [a, b] = &common.of;
        let mut near = 0;
        let half = HALF_SPEED[self.signals.cue as usize];
        let ln_spread = common.spread.max(1e-9).ln();
        for sample in &a.samples {
            let Some(other) = b.at(sample.seconds + offset, &mut near) else { continue };
            let pixel = (0.5 * (sample.pixel.powi(2) + other.pixel.powi(2))).sqrt();
            let speed = sample.velocity.abs().max(other.velocity.abs());
            let moving = speed * speed / (speed * speed + half * half);
            let slope = other.velocity * other.pixel / pixel;
            let value = (sample.value - other.value) / pixel;
            all.push(Residual { value, weight: moving.max(STILL_WEIGHT), ln_spread, slope });
        }
    }

    /// The pair's own peak next to an offset, no more than so far away; how far it is off the others is still to be said.
    pub(super) fn peak(&self, about: f64, within: f64) -> Option<PairOffset> {
        /// Offsets that are tried on each side.
        const TRIED: i32 = 12;
        let step = within / f64::from(TRIED);
        let at = |k: i32| about + step * f64::from(k);
        let values: Vec<(f64, f64)> =
            (-TRIED..=TRIED).filter_map(|k| Some((at(k), self.evidence(at(k))?))).collect();
        let best = (0..values.len()).max_by(|&a, &b| values[a].1.total_cmp(&values[b].1))?;
        if best == 0 || best + 1 == values.len() {
            return None;
        }
        // The parabola through the offsets about the best, by least squares.
        let reach = (TRIED as usize / 2).min(best).min(values.len() - 1 - best);
        let middle = values[best].0;
        let about_best = values[best - reach..=best + reach].iter();
        let [mut s2, mut s4, mut sy, mut sxy, mut sxxy, mut n] = [0.0; 6];
        for (x, y) in about_best.map(|(offset, value)| (offset - middle, value)) {
            n += 1.0;
            s2 += x * x;
            s4 += x.powi(4);
            sy += y;
            sxy += x * y;
            sxxy += x * x * y;
        }
        let (linear, square) = (sxy / s2, (n * sxxy - s2 * sy) / (n * s4 - s2 * s2));
        let shift = if square < 0.0 { (-0.5 * linear / square).clamp(-step * 2.0, step * 2.0) } else { 0.0 };
        let seconds = middle + shift;
        let residuals = self.residuals(seconds);
        let scatter =
            scale(&residuals).map_or(self.noise, |look| look.0.max(LEAST_NOISE[self.signals.cue as usize]));
        let information: f64 =
            residuals.iter().map(|residual| residual.weight * residual.slope * residual.slope).sum();
        let deviation_s = scatter * (self.correlated / information.max(1e-12)).sqrt();
        Some(PairOffset {
            cameras: self.cameras,
            cue: self.signals.cue,
            seconds,
            deviation_s,
            evidence: values[best].1 / self.correlated,
            residual_s: 0.0,
            noise: self.noise,
            is_used: true,
        })
    }
}

/// Standard deviation of the residuals, from the median of their sizes, and how much motion they see; `None` of too few.
fn scale(residuals: &[Residual]) -> Option<(f64, f64)> {
    if residuals.len() < LEAST_SAMPLES {
        return None;
    }
    let sizes: Vec<Residual> =
        residuals.iter().map(|residual| Residual { value: residual.value.abs(), ..*residual }).collect();
    let motion = residuals.iter().map(|residual| residual.weight).sum();
    Some((weighted_median(&sizes) / MAD, motion))
}

fn weighted_median(residuals: &[Residual]) -> f64 {
    let mut sorted: Vec<(f64, f64)> =
        residuals.iter().map(|residual| (residual.value, residual.weight)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * sorted.iter().map(|pair| pair.1).sum::<f64>();
    let mut sum = 0.0;
    for (value, weight) in &sorted {
        sum += weight;
        if sum >= half {
            return *value;
        }
    }
    0.0
}

/// Over how many samples residuals hang together: (1 + ρ)/(1 − ρ) with their correlation ρ from one to the next.
fn correlation_length(residuals: &[Residual]) -> f64 {
    let weighted: Vec<f64> =
        residuals.iter().map(|residual| residual.weight.sqrt() * residual.value).collect();
    let all: f64 = weighted.iter().map(|value| value * value).sum();
    let next: f64 = weighted.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let rho = if all > 0.0 { (next / all).clamp(0.0, 0.98) } else { 0.0 };
    (1.0 + rho) / (1.0 - rho)
}
