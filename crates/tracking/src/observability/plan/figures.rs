//! What a set of cameras knows of bodies at one place, and over a floor.

use super::LOST_M;
use crate::statistics::upper_median;

/// What a set of cameras knows of the bodies at a place. Deviations are metres, in a joint's worst direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceFigures {
    /// Mean over joints and bodies; each counts as [`LOST_M`] at most.
    pub mean_m: f64,
    /// The joint in the middle, of all bodies; infinite where nothing bounds it.
    pub median_m: f64,
    /// The joint whose median over the bodies is largest, by the limb whose second joint it is (`None` is the root), and that
    /// median.
    pub worst: (Option<usize>, f64),
    /// Share of joints, over all bodies, that are known better than [`LOST_M`].
    pub known: f64,
}

impl PlaceFigures {
    /// Of deviations by body, then by joint.
    pub(super) fn of(joints: &[Option<usize>], by_body: &[&[f64]]) -> Self {
        let mut all: Vec<f64> = by_body.iter().flat_map(|body| body.iter().copied()).collect();
        let count = all.len().max(1) as f64;
        let mean_m = all.iter().map(|deviation| deviation.min(LOST_M)).sum::<f64>() / count;
        let known = all.iter().filter(|deviation| **deviation < LOST_M).count() as f64 / count;
        let of_joint = |(index, joint): (usize, &Option<usize>)| {
            let mut bodies: Vec<f64> = by_body.iter().map(|body| body[index]).collect();
            (*joint, upper_median(&mut bodies).unwrap_or(f64::INFINITY))
        };
        let worst = joints.iter().enumerate().map(of_joint);
        let worst = worst.reduce(|worst, next| if next.1 > worst.1 { next } else { worst });
        Self {
            mean_m,
            known,
            median_m: upper_median(&mut all).unwrap_or(f64::INFINITY),
            worst: worst.unwrap_or((None, f64::INFINITY)),
        }
    }
}

/// What a set of cameras knows over a floor.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedSet {
    /// The set, by index.
    pub cameras: Vec<usize>,
    /// By place, in the order of the area's.
    pub places: Vec<PlaceFigures>,
}

impl PlannedSet {
    /// Mean over the places of [`PlaceFigures::mean_m`]: what sets are ranked by.
    #[must_use]
    pub fn mean_m(&self) -> f64 {
        self.places.iter().map(|place| place.mean_m).sum::<f64>() / self.places.len().max(1) as f64
    }

    /// The joint in the middle at the place in the middle.
    #[must_use]
    pub fn median_m(&self) -> f64 {
        let mut medians: Vec<f64> = self.places.iter().map(|place| place.median_m).collect();
        upper_median(&mut medians).unwrap_or(f64::INFINITY)
    }

    /// The place that is known worst, by index.
    #[must_use]
    pub fn worst_place(&self) -> Option<usize> {
        let places = 0..self.places.len();
        places.reduce(
            |worst, next| {
                if self.places[next].mean_m > self.places[worst].mean_m { next } else { worst }
            },
        )
    }

    /// The joint that is known worst at the place in the middle of all, by how its worst joints are known, and its deviation.
    #[must_use]
    pub fn worst_joint(&self) -> (Option<usize>, f64) {
        let mut worst: Vec<(Option<usize>, f64)> = self.places.iter().map(|place| place.worst).collect();
        worst.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        worst.get(worst.len() / 2).copied().unwrap_or((None, f64::INFINITY))
    }

    /// Share of joints over bodies and places that are known better than [`LOST_M`].
    #[must_use]
    pub fn known(&self) -> f64 {
        self.places.iter().map(|place| place.known).sum::<f64>() / self.places.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_without_a_bound_counts_as_lost_and_the_worst_joint_is_the_worst_of_most_bodies() {
        let bodies: [&[f64]; 3] = [&[0.01, 0.03, f64::INFINITY], &[0.01, 0.05, 0.02], &[0.03, 0.04, 0.02]];
        let found = PlaceFigures::of(&[None, Some(3), Some(7)], &bodies);
        let expected = (0.01 + 0.03 + LOST_M + 0.01 + 0.05 + 0.02 + 0.03 + 0.04 + 0.02) / 9.0;
        assert!((found.mean_m - expected).abs() < 1e-12, "{found:?}");
        assert_eq!((found.median_m, found.worst), (0.03, (Some(3), 0.04)));
        assert!((found.known - 8.0 / 9.0).abs() < 1e-12);
        let other = PlaceFigures { mean_m: 0.2, ..found };
        let set = PlannedSet { cameras: vec![0], places: vec![found, other, found] };
        assert_eq!((set.worst_place(), set.worst_joint()), (Some(1), (Some(3), 0.04)));
        assert!((set.mean_m() - (2.0 * expected + 0.2) / 3.0).abs() < 1e-12);
    }
}
