//! Distances of motions from the classes' means; what is far from all of them is nothing known.
//!
//! Standardised measures z of a window are brought to the coordinates in which what does not make a class, within a person and between
//! people, is the unit matrix N⁻¹ᐟ² ([`Nuisance::whitening`]). A window's strangeness is its squared distance there from the nearest class's mean m,
//! minₖ |N⁻¹ᐟ² (z − mₖ)|²/d. How strange known motions of strangers are is found by leaving each person out of N and m in turn; what is stranger
//! than all but `1 − KNOWN_PART` of those windows is called unknown.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::discriminant::{AxesOptions, Learnt, Nuisance, Sample};

/// Part of the windows of known motions of strangers that counts as known.
const KNOWN_PART: f64 = 0.85;

/// What windows of known classes look like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Novelty {
    /// N⁻¹ᐟ² of standardised measures, row by row.
    pub whitening: Vec<Vec<f64>>,
    /// By class, the mean in those coordinates.
    pub means: Vec<Vec<f64>>,
    /// Strangeness beyond which a window is unknown.
    pub threshold: f64,
}

impl Novelty {
    /// Learns from windows, their weights and the axes that were learnt from them.
    #[must_use]
    pub fn learn(learnt: &Learnt, samples: &[Sample], weights: &[f64], options: AxesOptions) -> Self {
        let standardised = |sample: &Sample| learnt.discriminant.standardised(&sample.row);
        let mut known: Vec<(f64, f64)> = Vec::new();
        let subjects = samples.iter().map(|sample| sample.subject + 1).max().unwrap_or(0);
        for subject in 0..subjects {
            let others = learnt.cells.without(Some(subject), options);
            let can_know = |class: usize| others.means.iter().any(|(of, _)| *of == class);
            let found = Self::of(&others);
            let own = samples.iter().zip(weights);
            let own = own.filter(|(sample, _)| sample.subject == subject && can_know(sample.class));
            known.extend(own.map(|(sample, weight)| (found.strangeness(&standardised(sample)), *weight)));
        }
        Self { threshold: threshold(known), ..Self::of(&learnt.nuisance) }
    }

    fn of(nuisance: &Nuisance) -> Self {
        let rows = |matrix: &DMatrix<f64>| {
            matrix.row_iter().map(|row| row.iter().copied().collect()).collect::<Vec<Vec<f64>>>()
        };
        let white = |mean: &DVector<f64>| (&nuisance.whitening * mean).as_slice().to_vec();
        Self {
            whitening: rows(&nuisance.whitening),
            means: nuisance.means.iter().map(|(_, mean)| white(mean)).collect(),
            threshold: f64::INFINITY,
        }
    }

    /// By class, the squared distance |N⁻¹ᐟ² (z − m)|² of a window's standardised measures from its mean.
    #[must_use]
    pub fn squared_distances(&self, standardised: &[f64]) -> Vec<f64> {
        let along = |row: &Vec<f64>| row.iter().zip(standardised).map(|(w, z)| w * z).sum::<f64>();
        let place: Vec<f64> = self.whitening.iter().map(along).collect();
        let from = |mean: &Vec<f64>| place.iter().zip(mean).map(|(x, mean)| (x - mean).powi(2)).sum();
        self.means.iter().map(from).collect()
    }

    /// How far a window is from all that is known; of its standardised measures.
    #[must_use]
    pub fn strangeness(&self, standardised: &[f64]) -> f64 {
        let nearest = self.squared_distances(standardised).into_iter().fold(f64::INFINITY, f64::min);
        nearest / self.whitening.len().max(1) as f64
    }
}

/// The strangeness that [`KNOWN_PART`] of the weight lies below; where nobody can be left out, any.
fn threshold(mut known: Vec<(f64, f64)>) -> f64 {
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut left = KNOWN_PART * known.iter().map(|(_, weight)| weight).sum::<f64>();
    let found = known.iter().find(|(_, weight)| {
        left -= weight;
        left <= 0.0
    });
    found.map_or(MOST, |(strangeness, _)| *strangeness)
}

/// A threshold that nothing reaches.
const MOST: f64 = 1e9;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discriminant::{Discriminant, balanced_weights};

    /// Two classes about (0, 0) and about (20, 0), three people who lie 0.5 apart along the second measure.
    fn learnt(people: usize) -> (Novelty, Discriminant) {
        let sample = |index: usize| {
            let (class, subject, at) = (index % 2, index / 2 % people, index as f64);
            let place = 20.0 * class as f64 + 1.4 * (1.3 * at).sin();
            Sample { row: vec![place, 0.5 * subject as f64 + 1.4 * (2.1 * at).cos()], class, subject }
        };
        let samples: Vec<Sample> = (0..300).map(sample).collect();
        let options = AxesOptions { shrinkage: 0.0, strangers: 1.0 };
        let axes = Discriminant::learn(&samples, options);
        (Novelty::learn(&axes, &samples, &balanced_weights(&samples), options), axes.discriminant)
    }

    #[test]
    fn what_strangers_do_is_known_and_what_lies_between_classes_is_not() {
        let (novelty, axes) = learnt(3);
        let at = |x: f64, y: f64| novelty.strangeness(&axes.standardised(&[x, y])) / novelty.threshold;
        assert!(at(0.0, 0.5) < 0.3 && at(20.0, 0.5) < 0.3, "{} {}", at(0.0, 0.5), at(20.0, 0.5));
        assert!(at(10.0, 0.5) > 1.0, "{}", at(10.0, 0.5));
        assert!(at(0.0, 4.0) > 2.0 * at(0.0, 1.5), "{} {}", at(0.0, 4.0), at(0.0, 1.5));
    }

    #[test]
    fn the_mean_of_a_class_is_near_to_that_class_alone() {
        let (novelty, axes) = learnt(3);
        let [own, other] = novelty.squared_distances(&axes.standardised(&[0.0, 0.5]))[..] else { panic!() };
        assert!(own < 0.5 && other > 20.0 * own, "{own} {other}");
    }

    #[test]
    fn one_person_alone_says_nothing_about_strangers() {
        assert_eq!(learnt(1).0.threshold, MOST);
    }

    #[test]
    fn what_counts_more_draws_the_threshold() {
        let known = |weight: f64| vec![(1.0, 1.0), (2.0, 1.0), (9.0, weight)];
        assert_eq!(threshold(known(0.1)), 2.0);
        assert_eq!(threshold(known(1.0)), 9.0);
    }
}
