//! Radial basis functions: how near a place is to each of some known ones (D. S. Broomhead and D. Lowe, "Multivariable functional
//! interpolation and adaptive networks", 1988). A plane among them is a curved border among the places themselves.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::discriminant::Sample;

/// γ of exp(−γ d²); classes have about unit spread along each axis.
const NARROWNESS: f64 = 0.04;

/// Where people do what they do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RadialBasis {
    /// The mean place of what each person does of each class.
    pub centres: Vec<Vec<f64>>,
}

impl RadialBasis {
    /// Learns the centres from samples and their places, one each.
    #[must_use]
    pub fn learn(samples: &[Sample], places: &[Vec<f64>]) -> Self {
        let mut cells: BTreeMap<(usize, usize), (f64, Vec<f64>)> = BTreeMap::new();
        for (sample, place) in samples.iter().zip(places) {
            let (count, sum) =
                cells.entry((sample.class, sample.subject)).or_insert_with(|| (0.0, vec![0.0; place.len()]));
            *count += 1.0;
            sum.iter_mut().zip(place).for_each(|(sum, x)| *sum += x);
        }
        let mean = |(count, sum): (f64, Vec<f64>)| sum.into_iter().map(|x| x / count).collect();
        Self { centres: cells.into_values().map(mean).collect() }
    }

    /// exp(−γ d²) for each centre at distance d of a place.
    #[must_use]
    pub fn values(&self, place: &[f64]) -> Vec<f64> {
        let squared = |centre: &Vec<f64>| centre.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        self.centres.iter().map(|centre| (-NARROWNESS * squared(centre)).exp()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_person_does_of_a_class_is_one_centre_and_the_nearest_says_most() {
        let sample = |class, subject| Sample { row: Vec::new(), class, subject };
        let samples = [sample(0, 0), sample(0, 0), sample(0, 1), sample(1, 0)];
        let places = [[0.0, 1.0], [2.0, 1.0], [9.0, 0.0], [0.0, 9.0]].map(|place| place.to_vec());
        let basis = RadialBasis::learn(&samples, &places);
        assert_eq!(basis.centres, [[1.0, 1.0], [9.0, 0.0], [0.0, 9.0]]);
        let values = basis.values(&[1.0, 1.0]);
        assert!((values[0] - 1.0).abs() < 1e-12);
        assert!((values[1] - (-NARROWNESS * 65.0).exp()).abs() < 1e-12);
    }
}
