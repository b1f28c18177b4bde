//! Joint errors against a reference.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::body::{Kinematics, Model, Pose};

/// Where a reference says that joints are, in one frame: limb index of the joint's limb (its second joint),
/// or `None` for the root, and the world position in metres.
pub type ReferenceJoints = Vec<(Option<usize>, DVec3)>;

/// Distances in millimetres of all joints in all frames, put together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointErrors {
    by_joint: BTreeMap<String, Vec<f64>>,
}

/// Statistics of distances, millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Arithmetic mean.
    pub mean: f64,
    /// Half lie below.
    pub median: f64,
    /// 95 % lie below.
    pub p95: f64,
    /// The largest.
    pub max: f64,
    /// How many.
    pub count: usize,
}

impl Statistics {
    /// Of any numbers; `None` of none.
    #[must_use]
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        Some(Self {
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
            median: percentile(&sorted, 0.5),
            p95: percentile(&sorted, 0.95),
            max,
            count: sorted.len(),
        })
    }
}

/// Linear between the two nearest ranks of sorted values.
fn percentile(sorted: &[f64], fraction: f64) -> f64 {
    let rank = fraction * (sorted.len() - 1) as f64;
    let (low, high) = (rank.floor() as usize, rank.ceil() as usize);
    sorted[low] + (sorted[high] - sorted[low]) * (rank - low as f64)
}

impl JointErrors {
    /// Adds one frame's distances.
    pub fn add(&mut self, model: &Model, pose: &Pose, reference: &ReferenceJoints) {
        let kinematics = Kinematics::new(model, pose);
        for (limb, expected) in reference {
            let (name, found) = match limb {
                Some(limb) => (model.limbs()[*limb].name.clone(), kinematics.ends()[*limb]),
                None => ("root".to_owned(), pose.root),
            };
            let error_mm = 1000.0 * found.distance(*expected);
            self.by_joint.entry(name).or_default().push(error_mm);
        }
    }

    /// All joints and frames; `None` if no joint was compared.
    #[must_use]
    pub fn overall(&self) -> Option<Statistics> {
        let all: Vec<f64> = self.by_joint.values().flatten().copied().collect();
        Statistics::of(&all)
    }

    /// By the joint's name.
    #[must_use]
    pub fn by_joint(&self) -> BTreeMap<&str, Statistics> {
        self.by_joint
            .iter()
            .filter_map(|(name, errors)| Some((name.as_str(), Statistics::of(errors)?)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_a_ladder() {
        let values: Vec<f64> = (0..=100).rev().map(f64::from).collect();
        let statistics = Statistics::of(&values).unwrap();
        assert_eq!(
            (statistics.mean, statistics.median, statistics.p95, statistics.max),
            (50.0, 50.0, 95.0, 100.0)
        );
        assert_eq!(Statistics::of(&[]), None);
    }
}
