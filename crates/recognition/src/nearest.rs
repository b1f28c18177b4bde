//! Nearest neighbours, the baseline: what the nearest windows of the training motions are called.

use serde::{Deserialize, Serialize};

/// How many neighbours have a say.
const NEIGHBOURS: usize = 15;

/// Windows that are known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exemplars {
    /// Their places.
    pub places: Vec<Vec<f64>>,
    /// Their classes' numbers.
    pub classes: Vec<usize>,
    /// How much each counts.
    pub weights: Vec<f64>,
}

impl Exemplars {
    /// The shares of the classes among the nearest known windows; a neighbour counts its weight over its distance.
    #[must_use]
    pub fn shares(&self, place: &[f64], class_count: usize) -> Vec<f64> {
        let distance = |other: &Vec<f64>| other.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let mut near: Vec<(f64, usize)> = self.places.iter().map(distance).zip(0..).collect();
        let count = NEIGHBOURS.min(near.len());
        if count > 0 && count < near.len() {
            near.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        }
        near.truncate(count);
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut shares = vec![0.0; class_count];
        for (distance, index) in near {
            shares[self.classes[index]] += self.weights[index] / (distance.sqrt() + 0.1);
        }
        let sum: f64 = shares.iter().sum();
        if sum > 0.0 {
            shares.iter_mut().for_each(|share| *share /= sum);
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_have_the_say() {
        let known = Exemplars {
            places: (0..60).map(|index| vec![f64::from(index)]).collect(),
            classes: (0..60).map(|index| usize::from(index >= 30)).collect(),
            weights: vec![1.0; 60],
        };
        assert_eq!(known.shares(&[5.0], 2), [1.0, 0.0]);
        let [a, b] = known.shares(&[29.5], 2)[..] else { panic!() };
        assert!((a - 0.5).abs() < 0.05 && (a + b - 1.0).abs() < 1e-12);
    }
}
