//! Joint errors against a reference.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::body::{Kinematics, Model, Pose};
use crate::statistics::Statistics;

/// Where a reference says that joints are, in one frame: limb index of the joint's limb (its second joint),
/// or `None` for the root, and the world position in metres.
pub type ReferenceJoints = Vec<(Option<usize>, DVec3)>;

/// Errors of all joints in all frames, put together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointErrors {
    /// From the reference to the fitted joint in the axes of the joint's limb, millimetres.
    by_joint: BTreeMap<String, Vec<DVec3>>,
}

impl JointErrors {
    /// Adds one frame's distances.
    pub fn add(&mut self, model: &Model, pose: &Pose, reference: &ReferenceJoints) {
        let kinematics = Kinematics::new(model, pose);
        for (limb, expected) in reference {
            let (name, found, of) = match limb {
                Some(limb) => (model.limbs()[*limb].name.clone(), kinematics.ends()[*limb], *limb),
                None => ("root".to_owned(), pose.root, 0),
            };
            let world_from_limb = kinematics.world_rotations()[model.limbs()[of].rotation];
            let error_mm = 1000.0 * (world_from_limb.transpose() * (found - *expected));
            self.by_joint.entry(name).or_default().push(error_mm);
        }
    }

    /// Distances of all joints and frames, millimetres; `None` if no joint was compared.
    pub fn overall(&self) -> Option<Statistics> {
        let all: Vec<f64> = self.by_joint.values().flatten().map(|error| error.length()).collect();
        Statistics::of(&all)
    }

    /// The same after each joint's constant offset in its limb's frame was taken off: what a reference that
    /// puts a joint elsewhere in the limb does not count for.
    pub fn overall_without_offsets(&self) -> Option<Statistics> {
        let without = |errors: &Vec<DVec3>| {
            let offset = errors.iter().sum::<DVec3>() / errors.len() as f64;
            errors.iter().map(|error| (*error - offset).length()).collect::<Vec<f64>>()
        };
        Statistics::of(&self.by_joint.values().flat_map(without).collect::<Vec<f64>>())
    }

    /// By the joint's name.
    pub fn by_joint(&self) -> BTreeMap<&str, Statistics> {
        self.by_joint
            .iter()
            .filter_map(|(name, errors)| {
                let distances: Vec<f64> = errors.iter().map(|error| error.length()).collect();
                Some((name.as_str(), Statistics::of(&distances)?))
            })
            .collect()
    }
}

/// Mean distance between the limbs' ends of two poses, millimetres. Twists that no joint shows do not count.
pub fn mean_joint_error_mm(model: &Model, pose: &Pose, truth: &Pose) -> f64 {
    let (found, truth) = (Kinematics::new(model, pose), Kinematics::new(model, truth));
    let sum: f64 = found.ends().iter().zip(truth.ends()).map(|(a, b)| a.distance(*b)).sum();
    1000.0 * sum / found.ends().len().max(1) as f64
}

/// How much a track trembles: mean length of the joints' second differences from frame to frame, millimetres.
///
/// `poses` are consecutive frames in their order; `None` for fewer than three.
pub fn jitter_mm<'a>(model: &Model, poses: impl IntoIterator<Item = &'a Pose>) -> Option<f64> {
    let joints: Vec<Vec<DVec3>> =
        poses.into_iter().map(|pose| Kinematics::new(model, pose).ends().to_vec()).collect();
    let lengths = joints.windows(3).flat_map(|three| {
        let [before, here, after] = [&three[0], &three[1], &three[2]];
        let second = |joint: usize| 1000.0 * (after[joint] - 2.0 * here[joint] + before[joint]).length();
        (0..here.len()).map(second).collect::<Vec<f64>>()
    });
    Statistics::of(&lengths.collect::<Vec<f64>>()).map(|statistics| statistics.mean)
}

/// Mean distance of all leaf joints and the root of two poses, millimetres.
pub fn leaf_error_mm(model: &Model, a: &Pose, b: &Pose) -> f64 {
    let is_leaf = |limb: &usize| model.limbs().iter().all(|other| other.parent != Some(*limb));
    let (found, truth) = (Kinematics::new(model, a), Kinematics::new(model, b));
    let mut distances = vec![a.root.distance(b.root)];
    let leaves = (0..model.limbs().len()).filter(is_leaf);
    distances.extend(leaves.map(|limb| found.ends()[limb].distance(truth.ends()[limb])));
    1e3 * distances.iter().sum::<f64>() / distances.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reference that sits elsewhere in every limb, but always at the same place of it, costs nothing once
    /// offsets are taken off; a pose that jumps trembles.
    #[test]
    fn constant_offsets_are_taken_off_and_jumps_tremble() {
        let model = crate::body::builtin::upper_body();
        let pose = |frame: usize| {
            let step = |column: usize| 0.1 * ((frame * 3 + column) as f64).sin();
            crate::fixtures::stepped(&model, crate::body::Parameters::Tangent, step)
        };
        let poses: Vec<Pose> = (0..6).map(pose).collect();
        let mut errors = JointErrors::default();
        for pose in &poses {
            let kinematics = Kinematics::new(&model, pose);
            let reference = (0..model.limbs().len())
                .map(|limb| {
                    let turn = kinematics.world_rotations()[model.limbs()[limb].rotation];
                    (Some(limb), kinematics.ends()[limb] + turn * DVec3::new(0.01, -0.02, 0.03))
                })
                .collect();
            errors.add(&model, pose, &reference);
        }
        let expected = DVec3::new(10.0, 20.0, 30.0).length();
        assert!((errors.overall().unwrap().mean - expected).abs() < 1e-9);
        assert!(errors.overall_without_offsets().unwrap().max < 1e-9);
        assert!(jitter_mm(&model, &poses).unwrap() > 10.0);
        assert!(jitter_mm(&model, [&poses[0]; 4]).unwrap() < 1e-12);
        assert_eq!(jitter_mm(&model, &poses[..2]), None);
    }
}
