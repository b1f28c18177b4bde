//! Baum-Welch from weighted sequences, begun at the means of clusters.
//!
//! With γᵢ(t) and ξᵢⱼ(t) the beliefs in states and steps given a whole sequence: μᵢ = Σ w γᵢ x/Σ w γᵢ, aᵢⱼ = (Σ w ξᵢⱼ + ε)/Σⱼ(…), and σ²ᵢ is the
//! weighted scatter about μᵢ together with `prior_count` observations of the whole class's variance, and never less than `least_variance`.

use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use super::HiddenMarkov;
use crate::augment::unit;

/// How a model is learnt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HmmOptions {
    /// States of the model.
    pub states: usize,
    /// Rounds of Baum-Welch, at most.
    pub rounds: usize,
    /// Rounds end where ln of the likelihood of an observation grows by less.
    pub tolerance: f64,
    /// Least variance along any axis.
    pub least_variance: f64,
    /// How many observations the whole class's variance counts for in a state's, of a hundred that a state has.
    pub prior_count: f64,
}

impl Default for HmmOptions {
    fn default() -> Self {
        Self { states: 4, rounds: 30, tolerance: 1e-4, least_variance: 0.05, prior_count: 60.0 }
    }
}

/// A probability that a step or a start has at least, before all are brought to one.
const LEAST_PROBABILITY: f64 = 1e-4;

/// What the beliefs of a round sum up to.
struct Sums {
    start: Vec<f64>,
    steps: Vec<Vec<f64>>,
    counts: Vec<f64>,
    firsts: Vec<Vec<f64>>,
    log_likelihood: f64,
}

impl HiddenMarkov {
    /// Learns from sequences and how much each observation of them counts. There is one observation at least.
    #[must_use]
    pub fn learn(sequences: &[(&[Vec<f64>], f64)], options: &HmmOptions) -> Self {
        let total: f64 = sequences.iter().map(|(rows, weight)| rows.len() as f64 * weight).sum();
        let spread = variances(sequences, total, options.least_variance);
        let mut model = begin(sequences, options, &spread);
        let mut before = f64::NEG_INFINITY;
        for _ in 0..options.rounds {
            let likelihood = model.round(sequences, options, &spread, total) / total;
            if likelihood - before < options.tolerance {
                break;
            }
            before = likelihood;
        }
        model
    }

    /// One round; returns the likelihood before it.
    fn round(
        &mut self,
        sequences: &[(&[Vec<f64>], f64)],
        options: &HmmOptions,
        spread: &[f64],
        total: f64,
    ) -> f64 {
        let (states, dimension) = (self.state_count(), spread.len());
        let mut sums = Sums {
            start: vec![LEAST_PROBABILITY; states],
            steps: vec![vec![LEAST_PROBABILITY; states]; states],
            counts: vec![0.0; states],
            firsts: vec![vec![0.0; dimension]; states],
            log_likelihood: 0.0,
        };
        let beliefs: Vec<Vec<Vec<f64>>> =
            sequences.iter().map(|(rows, weight)| self.beliefs(rows, *weight, &mut sums)).collect();
        let prior = options.prior_count / 100.0 * total / states as f64;
        for state in 0..states {
            let count = sums.counts[state];
            if count > 1e-9 * total {
                self.means[state] = sums.firsts[state].iter().map(|sum| sum / count).collect();
            }
            let mut scatter = vec![0.0; dimension];
            for ((rows, weight), beliefs) in sequences.iter().zip(&beliefs) {
                for (row, belief) in rows.iter().zip(beliefs) {
                    for ((sum, x), mean) in scatter.iter_mut().zip(row).zip(&self.means[state]) {
                        *sum += weight * belief[state] * (x - mean).powi(2);
                    }
                }
            }
            let variance = scatter
                .iter()
                .zip(spread)
                .map(|(sum, spread)| ((sum + prior * spread) / (count + prior)).max(options.least_variance));
            self.variances[state] = variance.collect();
            self.transitions[state] = shares(&sums.steps[state]);
        }
        self.start = shares(&sums.start);
        sums.log_likelihood
    }

    /// γ of a sequence; adds to the sums.
    fn beliefs(&self, rows: &[Vec<f64>], weight: f64, sums: &mut Sums) -> Vec<Vec<f64>> {
        let (alphas, log_likelihood) = self.forward(rows);
        sums.log_likelihood += weight * log_likelihood;
        let states = self.state_count();
        let mut after = vec![1.0; states];
        let mut all = vec![Vec::new(); rows.len()];
        for t in (0..rows.len()).rev() {
            let gamma = shares(&alphas[t].iter().zip(&after).map(|(a, b)| a * b).collect::<Vec<_>>());
            for ((count, first), gamma) in sums.counts.iter_mut().zip(&mut sums.firsts).zip(&gamma) {
                *count += weight * gamma;
                for (sum, x) in first.iter_mut().zip(&rows[t]) {
                    *sum += weight * gamma * x;
                }
            }
            if t == 0 {
                for (sum, gamma) in sums.start.iter_mut().zip(&gamma) {
                    *sum += weight * gamma;
                }
            } else {
                let logs = self.log_densities(&rows[t]);
                let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let seen: Vec<f64> = logs.iter().zip(&after).map(|(log, b)| (log - top).exp() * b).collect();
                let step = |from: usize, to: usize| self.transitions[from][to] * seen[to];
                let mass: f64 = (0..states)
                    .map(|from| alphas[t - 1][from] * (0..states).map(|to| step(from, to)).sum::<f64>())
                    .sum();
                for (from, steps) in sums.steps.iter_mut().enumerate() {
                    for (to, sum) in steps.iter_mut().enumerate() {
                        *sum += weight * alphas[t - 1][from] * step(from, to) / mass;
                    }
                }
                let before: Vec<f64> =
                    (0..states).map(|from| (0..states).map(|to| step(from, to)).sum()).collect();
                after = shares(&before);
            }
            all[t] = gamma;
        }
        all
    }
}

/// The numbers as parts of their sum.
fn shares(values: &[f64]) -> Vec<f64> {
    let sum: f64 = values.iter().sum();
    if sum > 0.0 {
        values.iter().map(|value| value / sum).collect()
    } else {
        vec![1.0 / values.len() as f64; values.len()]
    }
}

fn variances(sequences: &[(&[Vec<f64>], f64)], total: f64, least: f64) -> Vec<f64> {
    let all = || sequences.iter().flat_map(|(rows, weight)| rows.iter().map(move |row| (row, weight)));
    let dimension = all().next().map_or(0, |(row, _)| row.len());
    (0..dimension)
        .map(|axis| {
            let mean = all().map(|(row, weight)| weight * row[axis]).sum::<f64>() / total;
            let variance = all().map(|(row, weight)| weight * (row[axis] - mean).powi(2)).sum::<f64>();
            (variance / total).max(least)
        })
        .collect()
}

/// States at the means of clusters (k-means, its seeds far apart), that stay nine times of ten.
fn begin(sequences: &[(&[Vec<f64>], f64)], options: &HmmOptions, spread: &[f64]) -> HiddenMarkov {
    let rows: Vec<(&Vec<f64>, f64)> =
        sequences.iter().flat_map(|(rows, weight)| rows.iter().map(move |row| (row, *weight))).collect();
    let states = options.states.clamp(1, rows.len().max(1));
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut means: Vec<Vec<f64>> = Vec::new();
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    while means.len() < states {
        let far = |(row, weight): &(&Vec<f64>, f64)| {
            let near = means.iter().map(|mean| distance(row, mean)).fold(f64::INFINITY, f64::min);
            weight * if near.is_finite() { near } else { 1.0 }
        };
        let mut left = unit(&mut random) * rows.iter().map(far).sum::<f64>();
        let chosen = rows.iter().find(|row| {
            left -= far(row);
            left <= 0.0
        });
        means.push(chosen.map_or_else(|| rows[0].0.clone(), |(row, _)| (*row).clone()));
    }
    for _ in 0..10 {
        let mut sums = vec![(vec![0.0; spread.len()], 0.0); states];
        for (row, weight) in &rows {
            let nearest = (0..states)
                .min_by(|&a, &b| distance(row, &means[a]).total_cmp(&distance(row, &means[b])))
                .unwrap_or(0);
            for (sum, x) in sums[nearest].0.iter_mut().zip(*row) {
                *sum += weight * x;
            }
            sums[nearest].1 += weight;
        }
        for (mean, (sum, count)) in means.iter_mut().zip(sums) {
            if count > 0.0 {
                *mean = sum.iter().map(|sum| sum / count).collect();
            }
        }
    }
    let other = if states > 1 { 0.1 / (states - 1) as f64 } else { 0.0 };
    let stay = 1.0 - other * (states - 1) as f64;
    HiddenMarkov {
        start: vec![1.0 / states as f64; states],
        transitions: (0..states)
            .map(|from| (0..states).map(|to| if from == to { stay } else { other }).collect())
            .collect(),
        means,
        variances: vec![spread.to_vec(); states],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sequence that stays ten steps at −2 and ten at 2.
    fn sequence(count: i32, shift: f64) -> Vec<Vec<f64>> {
        (0..count)
            .map(|t| {
                let place = if (t / 10) % 2 == 0 { -2.0 } else { 2.0 };
                vec![place + 0.3 * (f64::from(t) * 1.3 + shift).sin()]
            })
            .collect()
    }

    #[test]
    fn it_finds_states_and_how_long_they_last() {
        let rows: Vec<Vec<Vec<f64>>> = (0..4).map(|k| sequence(100, f64::from(k))).collect();
        let sequences: Vec<(&[Vec<f64>], f64)> = rows.iter().map(|rows| (&rows[..], 1.0)).collect();
        let options = HmmOptions { states: 2, prior_count: 0.0, ..HmmOptions::default() };
        let model = HiddenMarkov::learn(&sequences, &options);
        let low = usize::from(model.means[0][0] > 0.0);
        assert!((model.means[low][0] + 2.0).abs() < 0.1 && (model.means[1 - low][0] - 2.0).abs() < 0.1);
        assert!((model.transitions[low][low] - 0.9).abs() < 0.03, "{:?}", model.transitions);
        assert!(model.start[low] > 0.99);
        assert!(model.variances.iter().all(|row| (row[0] - 0.05).abs() < 0.02), "{:?}", model.variances);
    }

    #[test]
    fn a_round_never_makes_the_likelihood_less() {
        let rows: Vec<Vec<f64>> =
            (0..80).map(|t| vec![(f64::from(t) * 0.37).sin(), (f64::from(t) * 0.11).cos()]).collect();
        let sequences = [(&rows[..50], 1.0), (&rows[20..], 0.5)];
        let options =
            HmmOptions { states: 3, prior_count: 0.0, least_variance: 1e-3, ..HmmOptions::default() };
        let total = 50.0 + 0.5 * 60.0;
        let spread = variances(&sequences, total, options.least_variance);
        let mut model = begin(&sequences, &options, &spread);
        let mut before = f64::NEG_INFINITY;
        for round in 0..15 {
            let likelihood = model.round(&sequences, &options, &spread, total);
            // The least probability of a step costs next to nothing.
            assert!(likelihood > before - 1e-2, "round {round}: {likelihood} after {before}");
            before = likelihood;
        }
    }
}
