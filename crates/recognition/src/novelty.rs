//! Motions that are nothing known.
//!
//! Of each class the mean μ and deviation σ of every measure of a window is kept. A window's strangeness is the least over the classes of the mean of
//! min(((x − μ)/σ)², 16): about one for what is known. A window stranger than all but `KNOWN_PART` of the windows that were learnt
//! from, by a factor, is called unknown.

use serde::{Deserialize, Serialize};

use crate::discriminant::Sample;

/// Part of the training windows that counts as known.
const KNOWN_PART: f64 = 0.98;
/// People who are not known are stranger than those who are.
const STRANGERS: f64 = 1.15;
/// Most that one measure adds.
const MOST: f64 = 16.0;

/// What windows of known classes look like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Novelty {
    /// By class, means of the measures.
    pub means: Vec<Vec<f64>>,
    /// By class, their deviations.
    pub deviations: Vec<Vec<f64>>,
    /// Strangeness beyond which a window is unknown.
    pub threshold: f64,
}

impl Novelty {
    /// Learns from windows and their weights.
    #[must_use]
    pub fn learn(samples: &[Sample<'_>], weights: &[f64], class_count: usize) -> Self {
        let dimension = samples.first().map_or(0, |sample| sample.row.len());
        let (mut means, mut deviations) = (Vec::new(), Vec::new());
        let all = |of: usize| samples.iter().zip(weights).filter(move |(sample, _)| sample.class == of);
        for class in 0..class_count {
            let total: f64 = all(class).map(|(_, weight)| weight).sum();
            let mut mean = vec![0.0; dimension];
            for (sample, weight) in all(class) {
                mean.iter_mut().zip(sample.row).for_each(|(mean, x)| *mean += weight / total * x);
            }
            let mut variance = vec![1e-8; dimension];
            for (sample, weight) in all(class) {
                for ((variance, mean), x) in variance.iter_mut().zip(&mean).zip(sample.row) {
                    *variance += weight / total * (x - mean).powi(2);
                }
            }
            means.push(mean);
            deviations.push(variance.iter().map(|variance: &f64| variance.sqrt()).collect());
        }
        let mut found = Self { means, deviations, threshold: f64::INFINITY };
        let mut known: Vec<f64> = samples.iter().map(|sample| found.strangeness(sample.row)).collect();
        known.sort_by(f64::total_cmp);
        let at = (KNOWN_PART * known.len() as f64) as usize;
        found.threshold =
            STRANGERS * known.get(at.min(known.len().saturating_sub(1))).copied().unwrap_or(1.0);
        found
    }

    /// How far a window is from all that is known.
    #[must_use]
    pub fn strangeness(&self, row: &[f64]) -> f64 {
        let of_class = |(means, deviations): (&Vec<f64>, &Vec<f64>)| {
            let terms = row.iter().zip(means.iter().zip(deviations));
            let sum: f64 = terms.map(|(x, (mean, s))| ((x - mean) / s).powi(2).min(MOST)).sum();
            sum / row.len().max(1) as f64
        };
        self.means.iter().zip(&self.deviations).map(of_class).fold(f64::INFINITY, f64::min)
    }

    /// Whether a window of such strangeness is unknown.
    #[must_use]
    pub fn is_unknown(&self, strangeness: f64) -> bool {
        strangeness > self.threshold
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two classes of one measure each spread by one about (0, 0) and about (20, 0).
    fn learnt() -> (Novelty, Vec<[f64; 2]>) {
        let rows: Vec<[f64; 2]> = (0..200)
            .map(|index| {
                let at = f64::from(index);
                [20.0 * f64::from(index % 2) + 1.4 * (1.3 * at).sin(), 1.4 * (2.1 * at).cos()]
            })
            .collect();
        let samples: Vec<Sample<'_>> = rows
            .iter()
            .enumerate()
            .map(|(index, row)| Sample { row, class: index % 2, subject: 0 })
            .collect();
        (Novelty::learn(&samples, &vec![1.0; samples.len()], 2), rows)
    }

    #[test]
    fn what_was_learnt_from_is_known_and_what_lies_between_is_not() {
        let (novelty, rows) = learnt();
        assert!((novelty.means[1][0] - 20.0).abs() < 0.2 && (novelty.deviations[0][1] - 1.0).abs() < 0.1);
        assert!(rows.iter().all(|row| !novelty.is_unknown(novelty.strangeness(row))));
        let mean = rows.iter().map(|row| novelty.strangeness(row)).sum::<f64>() / rows.len() as f64;
        assert!((mean - 1.0).abs() < 0.1, "{mean}");
        // In the middle between both classes, and near each of them.
        assert!(novelty.is_unknown(novelty.strangeness(&[10.0, 0.0])));
        assert!(!novelty.is_unknown(novelty.strangeness(&[19.0, 0.5])));
    }

    #[test]
    fn one_measure_adds_no_more_than_its_share() {
        let (novelty, _) = learnt();
        let [far, farther] = [1e3, 1e9].map(|x| novelty.strangeness(&[0.0, x]));
        assert_eq!(far, farther);
        assert!((far - MOST / 2.0).abs() < 0.1, "{far}");
    }

    #[test]
    fn what_counts_more_draws_the_mean() {
        let rows = [[0.0], [1.0], [9.0]];
        let samples: Vec<Sample<'_>> = rows.iter().map(|row| Sample { row, class: 0, subject: 0 }).collect();
        let novelty = Novelty::learn(&samples, &[1.0, 2.0, 1.0], 1);
        assert!((novelty.means[0][0] - 2.75).abs() < 1e-12);
        let variance: f64 = (2.75_f64.powi(2) + 2.0 * 1.75_f64.powi(2) + 6.25_f64.powi(2)) / 4.0;
        assert!((novelty.deviations[0][0] - variance.sqrt()).abs() < 1e-6);
    }
}
