//! Moving a body by hand. A dragged joint's chain follows through the same optimiser that fits silhouettes:
//! a point residual for the joint, one for every pin, and a proximal prior that shares the bend out.

use glam::{DQuat, DVec3};
use nalgebra::DVector;

use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::optimize::{LeastSquares, Method, NormalEquations, Solver, SolverOptions};
use crate::residual::point::PointTarget;
use crate::residual::{joint_limit, point, proximal_prior};

/// Weight of the dragged joint, per m².
const TARGET_WEIGHT: f64 = 1.0;
/// Weight of a pin, per m²: pins give way last.
const PIN_WEIGHT: f64 = 30.0;
/// Pull of every rotation towards where it was, per rad².
const STIFFNESS: f64 = 1e-4;
/// Pull of the root towards where it was, per m²: limbs bend before the body goes along.
const ROOT_STIFFNESS: f64 = 0.3;
/// Weight of joint limits, per rad².
const LIMIT_WEIGHT: f64 = 1.0;
/// Most iterations of one drag event.
const ITERATIONS: usize = 40;

struct Chain<'a> {
    model: &'a Model,
    reference: &'a Pose,
    targets: &'a [PointTarget],
    kinematics: Kinematics,
}

impl LeastSquares for Chain<'_> {
    type Point = Pose;

    fn evaluate(&mut self, pose: &Pose, equations: &mut NormalEquations) {
        self.kinematics.update(self.model, pose);
        for target in self.targets {
            point::add(equations, Parameters::Tangent, &self.kinematics, pose.root, target);
        }
        let parameters = Parameters::Tangent;
        proximal_prior::add(equations, parameters, pose, self.reference, STIFFNESS, ROOT_STIFFNESS);
        joint_limit::add(equations, parameters, self.model, pose, LIMIT_WEIGHT);
    }

    fn columns(&self) -> usize {
        Parameters::Tangent.columns(self.model.rotation_count())
    }

    fn retract(&self, pose: &Pose, step: &DVector<f64>) -> Pose {
        pose.retract(Parameters::Tangent, step.as_slice())
    }
}

/// Solves for the pose nearest to `reference` that puts joints where `targets` say.
#[must_use]
pub fn reach(model: &Model, reference: &Pose, targets: &[PointTarget]) -> Pose {
    let mut chain = Chain { model, reference, targets, kinematics: Kinematics::new(model, reference) };
    let options = SolverOptions {
        method: Method::LevenbergMarquardt,
        damping: 1e-3,
        max_iterations: ITERATIONS,
        tolerance: Some(1e-6),
        run_all: false,
    };
    let mut solver = Solver::new(&mut chain, reference.clone(), options);
    while solver.step(&mut chain).is_some() {}
    solver.point().clone()
}

/// Drags a limb's second joint to a point of the world (metres); pinned limbs' second joints stay.
///
/// `reference` is the pose in which the drag began: dragging back undoes itself.
#[must_use]
pub fn drag_limb_end(model: &Model, reference: &Pose, limb: usize, target: DVec3, pins: &[usize]) -> Pose {
    let kinematics = Kinematics::new(model, reference);
    let mut targets = vec![PointTarget { limb: Some(limb), target, weight: TARGET_WEIGHT }];
    targets.extend(pins.iter().filter(|&&pin| pin != limb).map(|&pin| PointTarget {
        limb: Some(pin),
        target: kinematics.ends()[pin],
        weight: PIN_WEIGHT,
    }));
    reach(model, reference, &targets)
}

/// Turns a limb about its first joint by a rotation given in world axes; what grows from it turns along.
///
/// A limb that is rigid with another turns that one's rotation.
#[must_use]
pub fn turn_limb(model: &Model, pose: &Pose, limb: usize, turn_in_world: DQuat) -> Pose {
    let kinematics = Kinematics::new(model, pose);
    let rotation = model.limbs()[limb].rotation;
    let frame = DQuat::from_mat3(&kinematics.parent_frames()[rotation]);
    let mut turned = pose.clone();
    turned.rotations[rotation] =
        (frame.inverse() * turn_in_world * frame * pose.rotations[rotation]).normalize();
    turned
}

/// Turns a limb about its own axis by an angle in radians.
#[must_use]
pub fn twist_limb(model: &Model, pose: &Pose, limb: usize, angle: f64) -> Pose {
    let kinematics = Kinematics::new(model, pose);
    let axis = (kinematics.ends()[limb] - kinematics.starts()[limb]).normalize();
    turn_limb(model, pose, limb, DQuat::from_axis_angle(axis, angle))
}

/// The pose mirrored between right and left, about the body's own plane: "right …" and "left …" limbs trade
/// places, the root and the first rotation stay where they are.
#[must_use]
pub fn mirror(model: &Model, pose: &Pose) -> Pose {
    let mut mirrored = pose.clone();
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        if model.rotation_parents()[rotation].is_none() {
            continue;
        }
        let other = model.limbs()[model.mirrored_limb(owner)].rotation;
        // Mirroring x ↦ −x turns a rotation vector (x, y, z) into (x, −y, −z).
        let q = pose.rotations[other];
        mirrored.rotations[rotation] = DQuat::from_xyzw(q.x, -q.y, -q.z, q.w);
    }
    mirrored
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;

    #[test]
    fn a_dragged_wrist_arrives_and_pinned_feet_stay() {
        let model = builtin::full_body();
        let rest = Pose::rest(&model);
        let wrist = model.limb_index("right forearm").unwrap();
        let feet = ["right foot", "left foot"].map(|name| model.limb_index(name).unwrap());
        let before = Kinematics::new(&model, &rest);
        let target = before.ends()[wrist] + DVec3::new(0.15, 0.2, 0.25);
        let after = Kinematics::new(&model, &drag_limb_end(&model, &rest, wrist, target, &feet));
        assert!(after.ends()[wrist].distance(target) < 0.005, "{}", after.ends()[wrist].distance(target));
        for foot in feet {
            assert!(after.ends()[foot].distance(before.ends()[foot]) < 0.005);
        }
    }

    #[test]
    fn out_of_reach_the_joint_comes_as_near_as_it_can() {
        let model = builtin::full_body();
        let rest = Pose::rest(&model);
        let wrist = model.limb_index("left forearm").unwrap();
        let pose = drag_limb_end(&model, &rest, wrist, DVec3::new(-5.0, 3.0, 9.0), &[]);
        assert_eq!(pose.check(&model), Ok(()));
    }

    #[test]
    fn turning_moves_only_what_grows_from_the_limb() {
        let model = builtin::upper_body();
        let rest = Pose::rest(&model);
        let arm = model.limb_index("left upper arm").unwrap();
        let turned = turn_limb(&model, &rest, arm, DQuat::from_rotation_z(0.7));
        let (before, after) = (Kinematics::new(&model, &rest), Kinematics::new(&model, &turned));
        for (index, limb) in model.limbs().iter().enumerate() {
            let moved = before.ends()[index].distance(after.ends()[index]) > 1e-9;
            assert_eq!(
                moved,
                ["left upper arm", "left forearm"].contains(&limb.name.as_str()),
                "{}",
                limb.name
            );
        }
        let expected = DQuat::from_rotation_z(0.7) * (before.ends()[arm] - before.starts()[arm]);
        assert!((after.ends()[arm] - after.starts()[arm]).distance(expected) < 1e-12);
    }

    #[test]
    fn mirroring_twice_changes_nothing() {
        let model = builtin::full_body();
        let step: Vec<f64> = (0..48).map(|i| 0.3 * (f64::from(i) * 1.3).sin()).collect();
        let pose = Pose::rest(&model).retract(Parameters::Tangent, &step);
        let again = mirror(&model, &mirror(&model, &pose));
        assert!(again.local(&pose).iter().all(|x| x.abs() < 1e-12));
    }
}
