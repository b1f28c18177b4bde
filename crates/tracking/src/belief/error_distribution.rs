//! From the signs of a limb to the distribution of its end's error.
//!
//! A network of one hidden layer says how likely each of [`BINS`] ranges of the error is. With signs x, their means m and
//! deviations s over the tracks that were learnt from,
//!
//! h = tanh(A (x − m)/s + a),  z = B h + b,  p = exp(z) / Σ exp(z).
//!
//! The mean of [`MEMBERS`] networks is told. Within a range the logarithm of the error is uniform. Learning descends
//! −Σ ln p(range of the error) + d ‖A, B‖²/2 with the steps of Adam (D. Kingma and J. Ba, "Adam: a method for stochastic
//! optimization", 2015). As that score is proper, the distribution is calibrated on tracks like those (T. Gneiting and A. Raftery,
//! "Strictly proper scoring rules, prediction, and estimation", 2007).

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use super::learnt_errors::LEARNT;
use super::signs::{SIGNS, Signs};

/// Ends of the ranges, metres.
const EDGES_M: [f64; BINS + 1] = [0.004, 0.015, 0.03, 0.05, 0.1, 0.25, 0.5, 2.0];
const BINS: usize = 7;
const HIDDEN: usize = 16;
/// Networks that are learnt from other beginnings. Their mean does not depend on where one began.
const MEMBERS: usize = 3;
/// Numbers of a network.
pub(super) const WEIGHTS: usize = HIDDEN * (SIGNS + 1) + BINS * (HIDDEN + 1);

/// A limb is right below this error, metres.
const RIGHT_M: f64 = 0.1;

/// How learning goes.
const PASSES: usize = 40;
const BATCH: usize = 256;
const RATE: f64 = 0.003;
const DECAY: f64 = 0.002;
const ADAM_MEAN: f64 = 0.9;
const ADAM_SQUARE: f64 = 0.999;

/// What was learnt.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorNetwork {
    /// Mean of every sign.
    pub means: [f64; SIGNS],
    /// One over its deviation.
    pub scales: [f64; SIGNS],
    /// Mean of every sign over limbs that are right.
    pub usual: [f64; SIGNS],
    /// By member: A and a, row by row, then B and b.
    pub members: [[f64; WEIGHTS]; MEMBERS],
}

/// How likely each range of an error is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorDistribution([f64; BINS]);

impl ErrorDistribution {
    /// From shares of the ranges that end at 15, 30, 50, 100, 250, 500 and 2000 mm. They sum to 1.
    #[must_use]
    pub fn of_shares(shares: [f64; BINS]) -> Self {
        Self(shares)
    }

    /// How likely it is that the error is above this one, metres.
    #[must_use]
    pub fn beyond(&self, error_m: f64) -> f64 {
        let above = |(bin, share): (usize, &f64)| {
            let [from, to] = [EDGES_M[bin], EDGES_M[bin + 1]];
            share * (to / error_m.max(1e-6)).ln().clamp(0.0, (to / from).ln()) / (to / from).ln()
        };
        self.0.iter().enumerate().map(above).sum()
    }

    /// The error below which it is with this probability, metres.
    #[must_use]
    pub fn quantile(&self, probability: f64) -> f64 {
        let mut left = probability.clamp(0.0, 1.0);
        for (bin, &share) in self.0.iter().enumerate() {
            if left <= share {
                let ratio = EDGES_M[bin + 1] / EDGES_M[bin];
                return EDGES_M[bin] * ratio.powf(left / share.max(1e-12));
            }
            left -= share;
        }
        EDGES_M[BINS]
    }
}

impl ErrorNetwork {
    /// What was learnt of the tracks of `backlit experiment trust`.
    #[must_use]
    pub fn learnt() -> &'static Self {
        &LEARNT
    }

    /// The distribution of the error of a limb with these signs.
    #[must_use]
    pub fn distribution(&self, signs: &Signs) -> ErrorDistribution {
        let inputs = self.inputs(signs);
        let of_members = self.members.each_ref().map(|weights| pass(weights, &inputs).shares);
        let mean = |bin: usize| of_members.iter().map(|shares| shares[bin]).sum::<f64>() / MEMBERS as f64;
        ErrorDistribution(std::array::from_fn(mean))
    }

    fn inputs(&self, signs: &Signs) -> [f64; SIGNS] {
        std::array::from_fn(|at| (signs[at] - self.means[at]) * self.scales[at])
    }
}

/// What the layers of a network hold for one limb.
struct Pass {
    hidden: [f64; HIDDEN],
    shares: [f64; BINS],
}

fn pass(weights: &[f64; WEIGHTS], inputs: &[f64; SIGNS]) -> Pass {
    let (first, second) = weights.split_at(HIDDEN * (SIGNS + 1));
    let sum = |row: &[f64], inputs: &[f64]| {
        row[inputs.len()] + row.iter().zip(inputs).map(|(weight, value)| weight * value).sum::<f64>()
    };
    let hidden = std::array::from_fn(|unit| sum(&first[unit * (SIGNS + 1)..][..=SIGNS], inputs).tanh());
    let logits: [f64; BINS] =
        std::array::from_fn(|bin| sum(&second[bin * (HIDDEN + 1)..][..=HIDDEN], &hidden));
    let largest = logits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let shares = logits.map(|logit| (logit - largest).exp());
    let total: f64 = shares.iter().sum();
    Pass { hidden, shares: shares.map(|share| share / total) }
}

/// The range in which an error lies.
fn bin_of(error_m: f64) -> usize {
    EDGES_M[1..BINS].iter().take_while(|edge| **edge < error_m).count()
}

/// Adds the gradient of −weight · ln p(range of the error) by the weights.
fn add_gradient(
    weights: &[f64; WEIGHTS],
    inputs: &[f64; SIGNS],
    known: &KnownError,
    gradient: &mut [f64; WEIGHTS],
) {
    let Pass { hidden, shares } = pass(weights, inputs);
    let bin = bin_of(known.error_m);
    let (first, second) = gradient.split_at_mut(HIDDEN * (SIGNS + 1));
    let later = &weights[HIDDEN * (SIGNS + 1)..];
    let mut by_hidden = [0.0; HIDDEN];
    for other in 0..BINS {
        let slope = known.weight * (shares[other] - f64::from(u8::from(other == bin)));
        let row = &mut second[other * (HIDDEN + 1)..][..=HIDDEN];
        for unit in 0..HIDDEN {
            row[unit] += slope * hidden[unit];
            by_hidden[unit] += slope * later[other * (HIDDEN + 1) + unit];
        }
        row[HIDDEN] += slope;
    }
    for unit in 0..HIDDEN {
        let slope = by_hidden[unit] * (1.0 - hidden[unit] * hidden[unit]);
        let row = &mut first[unit * (SIGNS + 1)..][..=SIGNS];
        row.iter_mut().zip(inputs).for_each(|(sum, input)| *sum += slope * input);
        row[SIGNS] += slope;
    }
}

/// A limb whose error is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownError {
    /// What is seen of it.
    pub signs: Signs,
    /// How far its end is off, metres.
    pub error_m: f64,
    /// How much it counts.
    pub weight: f64,
}

/// Learns from limbs whose errors are known. The same limbs give the same network to the bit.
#[must_use]
pub fn learn(known: &[KnownError], seed: u64) -> ErrorNetwork {
    let count = known.len().max(1) as f64;
    let mean =
        |at: usize, of: &dyn Fn(f64) -> f64| known.iter().map(|one| of(one.signs[at])).sum::<f64>() / count;
    let means: [f64; SIGNS] = std::array::from_fn(|at| mean(at, &|sign| sign));
    let scales = std::array::from_fn(|at| {
        let deviation = mean(at, &|sign| (sign - means[at]).powi(2)).sqrt();
        if deviation > 1e-6 { 1.0 / deviation } else { 0.0 }
    });
    let right: Vec<&Signs> = known.iter().filter(|one| one.error_m < RIGHT_M).map(|one| &one.signs).collect();
    let usual = std::array::from_fn(|at| {
        right.iter().map(|signs| signs[at]).sum::<f64>() / right.len().max(1) as f64
    });
    let mut network = ErrorNetwork { means, scales, usual, members: [[0.0; WEIGHTS]; MEMBERS] };
    let inputs: Vec<[f64; SIGNS]> = known.iter().map(|one| network.inputs(&one.signs)).collect();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    for weights in &mut network.members {
        descend(known, &inputs, weights, &mut random);
    }
    network
}

/// Learns one member.
fn descend(
    known: &[KnownError],
    inputs: &[[f64; SIGNS]],
    weights: &mut [f64; WEIGHTS],
    random: &mut Pcg64Mcg,
) {
    *weights = std::array::from_fn(|_| random.random_range(-0.3..0.3));
    let mut order: Vec<usize> = (0..known.len()).collect();
    let [mut mean, mut square] = [[0.0; WEIGHTS]; 2];
    let mut step = 0;
    for pass in 0..PASSES {
        order.shuffle(random);
        let rate = RATE * (1.0 - pass as f64 / PASSES as f64);
        for batch in order.chunks(BATCH) {
            let mut gradient = [0.0; WEIGHTS];
            for &index in batch {
                add_gradient(weights, &inputs[index], &known[index], &mut gradient);
            }
            step += 1;
            for at in 0..WEIGHTS {
                let slope = gradient[at] / batch.len() as f64 + DECAY * weights[at];
                mean[at] = ADAM_MEAN * mean[at] + (1.0 - ADAM_MEAN) * slope;
                square[at] = ADAM_SQUARE * square[at] + (1.0 - ADAM_SQUARE) * slope * slope;
                let unbiased = [(mean[at], ADAM_MEAN), (square[at], ADAM_SQUARE)]
                    .map(|(value, kept)| value / (1.0 - f64::powi(kept, step)));
                weights[at] -= rate * unbiased[0] / (unbiased[1].sqrt() + 1e-8);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A limb whose first sign is the logarithm of its error, and one that says nothing of it.
    fn known(count: usize, seed: u64) -> Vec<KnownError> {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let one = |_| {
            let mut signs: Signs = std::array::from_fn(|_| random.random_range(-1.0..1.0));
            let error_m = 0.05 * f64::exp(1.5 * signs[0] + random.random_range(-1.0..1.0));
            signs[SIGNS - 1] = 2.0;
            KnownError { signs, error_m, weight: 1.0 }
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn what_is_learnt_is_calibrated_on_limbs_that_were_not_seen() {
        let network = learn(&known(4000, 1), 7);
        let others = known(4000, 2);
        // Within a range the distribution is a guess.
        for probability in [0.5, 0.68, 0.9] {
            let region = |one: &KnownError| network.distribution(&one.signs).quantile(probability);
            let inside = others.iter().filter(|one| one.error_m <= region(one));
            let share = inside.count() as f64 / others.len() as f64;
            assert!((share - probability).abs() < 0.05, "{share} within the region of {probability}");
        }
        for edge in [0.03, 0.05, 0.1, 0.25] {
            let prediction: f64 =
                others.iter().map(|one| network.distribution(&one.signs).beyond(edge)).sum();
            let beyond = others.iter().filter(|one| one.error_m > edge).count() as f64;
            assert!(
                (prediction / beyond - 1.0).abs() < 0.06,
                "beyond {edge}: {prediction} told, {beyond} are"
            );
        }
    }

    #[test]
    fn shares_quantiles_and_tails_agree() {
        let distribution = ErrorDistribution([0.1, 0.2, 0.3, 0.2, 0.1, 0.06, 0.04]);
        for probability in [0.05, 0.3, 0.5, 0.77, 0.95, 0.999] {
            let quantile = distribution.quantile(probability);
            assert!((distribution.beyond(quantile) - (1.0 - probability)).abs() < 1e-9);
        }
        assert!((distribution.beyond(0.05) - 0.4).abs() < 1e-12);
        assert!((distribution.beyond(0.0) - 1.0).abs() < 1e-12);
        assert_eq!(distribution.beyond(9.0), 0.0);
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        let network = learn(&known(300, 3), 1);
        let mut weights = network.members[0];
        let one = KnownError { weight: 2.0, ..known(1, 9)[0] };
        let (inputs, mut gradient) = (network.inputs(&one.signs), [0.0; WEIGHTS]);
        add_gradient(&weights, &inputs, &one, &mut gradient);
        for at in (0..WEIGHTS).step_by(7) {
            let mut loss = |by: f64| {
                weights[at] += by;
                let loss = -2.0 * pass(&weights, &inputs).shares[bin_of(one.error_m)].ln();
                weights[at] -= by;
                loss
            };
            let slope = (loss(1e-6) - loss(-1e-6)) / 2e-6;
            assert!((slope - gradient[at]).abs() < 1e-6, "{at}: {slope} {}", gradient[at]);
        }
    }
}
