//! Gaussian hidden Markov models (Rabiner, "A Tutorial on Hidden Markov Models", 1989).
//!
//! In state i an observation has the density bᵢ(x) = Πⱼ N(xⱼ; μᵢⱼ, σ²ᵢⱼ); πᵢ begins a sequence, aᵢⱼ leads from state i to j.

use serde::{Deserialize, Serialize};

mod learn;
mod network;

pub use learn::HmmOptions;
pub use network::Network;

/// Moments of a long sequence.
const LONG: usize = 1000;

/// A model of sequences of rows of numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HiddenMarkov {
    /// π: the probability that a sequence begins in each state.
    pub start: Vec<f64>,
    /// aᵢⱼ: row i has the probabilities of the state after i.
    pub transitions: Vec<Vec<f64>>,
    /// μ: a row a state.
    pub means: Vec<Vec<f64>>,
    /// σ²: a row a state.
    pub variances: Vec<Vec<f64>>,
}

impl HiddenMarkov {
    /// How many states there are.
    #[must_use]
    pub fn state_count(&self) -> usize {
        self.start.len()
    }

    /// Which part of a long sequence is spent in each state.
    #[must_use]
    pub fn occupancy(&self) -> Vec<f64> {
        let mut at = self.start.clone();
        let mut sum = vec![0.0; at.len()];
        for _ in 0..LONG {
            sum.iter_mut().zip(&at).for_each(|(sum, p)| *sum += p / LONG as f64);
            at = self.after_step(&at);
        }
        sum
    }

    /// Where probabilities of states lead in a step.
    fn after_step(&self, from: &[f64]) -> Vec<f64> {
        let to = |to: usize| from.iter().zip(&self.transitions).map(|(p, row)| p * row[to]).sum();
        (0..self.state_count()).map(to).collect()
    }

    /// ln b of each state for an observation.
    #[must_use]
    pub fn log_densities(&self, row: &[f64]) -> Vec<f64> {
        let density = |(mean, variance): (&Vec<f64>, &Vec<f64>)| {
            let terms = row.iter().zip(mean.iter().zip(variance));
            let sum: f64 = terms
                .map(|(x, (mean, variance))| {
                    (x - mean).powi(2) / variance + (std::f64::consts::TAU * variance).ln()
                })
                .sum();
            -0.5 * sum
        };
        self.means.iter().zip(&self.variances).map(density).collect()
    }

    /// ln of the density of a sequence, summed over all ways through the states.
    #[must_use]
    pub fn log_likelihood(&self, rows: &[Vec<f64>]) -> f64 {
        self.forward(rows).1
    }

    /// Beliefs αᵢ(t) that sum to one in each row, and ln of the sequence's density.
    fn forward(&self, rows: &[Vec<f64>]) -> (Vec<Vec<f64>>, f64) {
        let mut alphas: Vec<Vec<f64>> = Vec::with_capacity(rows.len());
        let mut total = 0.0;
        for row in rows {
            let logs = self.log_densities(row);
            let prior: Vec<f64> = match alphas.last() {
                None => self.start.clone(),
                Some(before) => self.after_step(before),
            };
            // States that cannot be do not set the scale.
            let possible = logs.iter().zip(&prior).filter(|(_, prior)| **prior > 0.0);
            let top = possible.map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
            let mut alpha: Vec<f64> = prior.iter().zip(&logs).map(|(p, log)| p * (log - top).exp()).collect();
            let sum: f64 = alpha.iter().sum();
            alpha.iter_mut().for_each(|a| *a /= sum);
            total += sum.ln() + top;
            alphas.push(alpha);
        }
        (alphas, total)
    }
}

/// ln Σ exp of some numbers.
pub(crate) fn log_sum(values: impl IntoIterator<Item = f64> + Clone) -> f64 {
    let top = values.clone().into_iter().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return top;
    }
    top + values.into_iter().map(|value| (value - top).exp()).sum::<f64>().ln()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) fn two_states(low: f64, high: f64) -> HiddenMarkov {
        HiddenMarkov {
            start: vec![0.7, 0.3],
            transitions: vec![vec![0.9, 0.1], vec![0.2, 0.8]],
            means: vec![vec![low], vec![high]],
            variances: vec![vec![0.5], vec![0.25]],
        }
    }

    #[test]
    fn a_long_sequence_is_where_its_states_lead() {
        // In balance as much leaves each state as comes to it: 0.1 p = 0.2 (1 − p).
        let [first, second] = two_states(0.0, 1.0).occupancy()[..] else { panic!() };
        assert!((first - 2.0 / 3.0).abs() < 1e-3 && (first + second - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_likelihood_is_the_sum_over_all_paths() {
        let model = two_states(-1.0, 1.5);
        let rows: Vec<Vec<f64>> = [-0.8, 0.3, 1.2, 2.0].iter().map(|&x| vec![x]).collect();
        let mut sum = 0.0;
        for code in 0..16_usize {
            let path: Vec<usize> = (0..4).map(|t| (code >> t) & 1).collect();
            let mut density = model.start[path[0]];
            for t in 0..4 {
                if t > 0 {
                    density *= model.transitions[path[t - 1]][path[t]];
                }
                density *= model.log_densities(&rows[t])[path[t]].exp();
            }
            sum += density;
        }
        assert!((model.log_likelihood(&rows) - sum.ln()).abs() < 1e-12);
        assert_eq!(model.log_likelihood(&[]), 0.0);
        assert!((log_sum([0.1_f64.ln(), 0.3_f64.ln()]) - 0.4_f64.ln()).abs() < 1e-12);
    }
}
