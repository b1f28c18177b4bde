//! Where a fit begins: a pose from known joints, and honest noise on it.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::geometry::rotation::exp;
use crate::metrics::ReferenceJoints;
use crate::posing;
use crate::residual::point::PointTarget;

/// Headings tried about each axis, since a chain cannot find its way round from behind.
const HEADINGS: usize = 8;
/// Weight of a joint, per m²: far above the stiffness of posing by hand.
const JOINT_WEIGHT: f64 = 100.0;
/// Rounds of reaching, each from where the last one ended, so that stiffness does not hold back.
const ROUNDS: usize = 4;

/// How far starts are from their truth: every joint is turned, the root is moved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Level {
    /// Turn of every joint, degrees, as tables name the level.
    pub degrees: u32,
    /// Move of the root, metres.
    pub metres: f64,
}

/// The levels that experiments begin with.
pub const LEVELS: [Level; 5] = [
    Level { degrees: 5, metres: 0.02 },
    Level { degrees: 10, metres: 0.05 },
    Level { degrees: 20, metres: 0.10 },
    Level { degrees: 30, metres: 0.15 },
    Level { degrees: 45, metres: 0.20 },
];

/// The pose whose joints are nearest to the given ones (world, metres); `None` if there are none.
///
/// Several headings of the whole body are tried; limits of the model are respected. What the joints do not
/// say (twists of limbs without children, the head without a marker) stays at rest.
#[must_use]
pub fn from_joints(model: &Model, joints: &ReferenceJoints) -> Option<Pose> {
    if joints.is_empty() {
        return None;
    }
    let targets: Vec<PointTarget> =
        joints.iter().map(|&(limb, target)| PointTarget { limb, target, weight: JOINT_WEIGHT }).collect();
    let middle = joints.iter().map(|(_, point)| *point).sum::<DVec3>() / joints.len() as f64;
    let candidates = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| {
        (0..HEADINGS).map(move |heading| exp(axis * (TAU * heading as f64 / HEADINGS as f64)))
    });
    let first = candidates.map(|turn| placed(model, turn, joints, middle));
    // The best few by where they begin, then the best of those by where they end.
    let mut starts: Vec<(f64, Pose)> = first.map(|pose| (misfit(model, &pose, joints), pose)).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts.truncate(4);
    starts
        .into_iter()
        .map(|(_, start)| (0..ROUNDS).fold(start, |pose, _| posing::reach(model, &pose, &targets)))
        .map(|pose| (misfit(model, &pose, joints), pose))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, pose)| pose)
}

/// The rest pose with the whole body turned, its joints' middle on the given middle.
fn placed(model: &Model, turn: DQuat, joints: &ReferenceJoints, middle: DVec3) -> Pose {
    let mut pose = Pose::rest(model);
    for (rotation, parent) in model.rotation_parents().iter().enumerate() {
        if parent.is_none() {
            pose.rotations[rotation] = turn;
        }
    }
    let kinematics = Kinematics::new(model, &pose);
    let found = joints.iter().map(|(limb, _)| limb.map_or(pose.root, |limb| kinematics.ends()[limb]));
    pose.root += middle - found.sum::<DVec3>() / joints.len() as f64;
    pose
}

fn misfit(model: &Model, pose: &Pose, joints: &ReferenceJoints) -> f64 {
    let kinematics = Kinematics::new(model, pose);
    let squared = joints.iter().map(|(limb, target)| {
        limb.map_or(pose.root, |limb| kinematics.ends()[limb]).distance_squared(*target)
    });
    squared.sum()
}

/// A pose off by exactly `angle_rad` in every rotation, each about a random axis, and by `distance_m` at the
/// root, in a random direction. The same seed gives the same pose.
#[must_use]
pub fn perturb(model: &Model, pose: &Pose, angle_rad: f64, distance_m: f64, seed: u64) -> Pose {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut step: Vec<f64> = (direction(&mut random) * distance_m).to_array().to_vec();
    for _ in 0..model.rotation_count() {
        step.extend((direction(&mut random) * angle_rad).to_array());
    }
    pose.retract(Parameters::Tangent, &step)
}

/// Uniform on the unit sphere (Archimedes: height and longitude are independent).
fn direction(random: &mut Pcg64Mcg) -> DVec3 {
    let height: f64 = random.random_range(-1.0..1.0);
    let longitude: f64 = random.random_range(0.0..TAU);
    let radius = (1.0 - height * height).sqrt();
    DVec3::new(radius * longitude.cos(), radius * longitude.sin(), height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;

    #[test]
    fn joints_give_their_pose_back() {
        let model = builtin::full_body();
        for seed in 0..6 {
            let mut truth = perturb(&model, &Pose::rest(&model), 0.25, 0.5, seed);
            truth.rotations[0] = exp(DVec3::Z * (1.1 * seed as f64)) * truth.rotations[0];
            let kinematics = Kinematics::new(&model, &truth);
            let joints: ReferenceJoints =
                (0..model.limbs().len()).map(|l| (Some(l), kinematics.ends()[l])).collect();
            let found = Kinematics::new(&model, &from_joints(&model, &joints).unwrap());
            let worst = joints.iter().map(|(l, p)| found.ends()[l.unwrap()].distance(*p)).fold(0.0, f64::max);
            assert!(worst < 0.03, "seed {seed}: {worst} m");
        }
        assert_eq!(from_joints(&model, &Vec::new()), None);
    }

    #[test]
    fn noise_is_as_large_as_it_says() {
        let model = builtin::upper_body();
        let pose = Pose::rest(&model);
        let noisy = perturb(&model, &pose, 0.1, 0.03, 7);
        let step = noisy.local(&pose);
        assert!((DVec3::from_slice(&step[..3]).length() - 0.03).abs() < 1e-12);
        for block in step[3..].chunks(3) {
            assert!((DVec3::from_slice(block).length() - 0.1).abs() < 1e-12);
        }
        assert_eq!(noisy, perturb(&model, &pose, 0.1, 0.03, 7));
    }
}
