//! The same silhouettes with the body facing the other way: what a fit that has right and left swapped ought to be.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};

use super::{mirror, reach_all};
use crate::body::{Kinematics, Model, Pose, Sides};

/// Solves for the places of the joints.
const ROUNDS: usize = 4;

/// The body facing the other way, in place: half a turn about its own long axis, and every right limb about where the
/// left one was.
///
/// Cameras can hardly tell the two poses apart by silhouettes, since limbs stay where limbs are. Knees and elbows bend
/// as they can, so that joints come as near to the other side's as the limits let them. A body without sides is turned
/// about the upright axis of its first limb's rotation, y at rest.
#[must_use]
pub fn turn_round(model: &Model, pose: &Pose) -> Pose {
    let before = Kinematics::new(model, pose);
    let up = Sides::of(model, &before).map_or(DVec3::Y, |sides| sides.up);
    let turn = DQuat::from_axis_angle(up, PI);
    // Mirrored first: after half a turn limbs are to the same side as before, and as far ahead as they were behind.
    let mut turned = mirror(model, pose);
    for (rotation, parent) in model.rotation_parents().iter().enumerate() {
        if parent.is_none() {
            turned.rotations[rotation] = (turn * turned.rotations[rotation]).normalize();
        }
    }
    reach_all(model, &turned, ROUNDS, |limb| before.ends()[model.mirrored_limb(limb)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Parameters, builtin};

    /// A person who stands with one arm out and one foot ahead.
    fn posed(model: &Model) -> Pose {
        let mut pose = Pose::rest(model);
        for (limb, turn) in [
            ("right upper arm", DVec3::new(0.1, 0.2, 0.6)),
            ("left upper arm", DVec3::new(-0.5, 0.0, 0.1)),
            ("right thigh", DVec3::new(-0.4, 0.0, 0.0)),
        ] {
            let rotation = model.limbs()[model.limb_index(limb).unwrap()].rotation;
            pose.rotations[rotation] *= DQuat::from_scaled_axis(turn);
        }
        pose
    }

    #[test]
    fn it_faces_the_other_way_with_its_limbs_where_the_others_were() {
        let model = builtin::full_body();
        let pose = posed(&model);
        let turned = turn_round(&model, &pose);
        let (before, after) = (Kinematics::new(&model, &pose), Kinematics::new(&model, &turned));
        let ahead = |kinematics| Sides::of(&model, kinematics).unwrap().ahead;
        assert!(ahead(&before).dot(ahead(&after)) < -0.9);
        for (limb, spec) in model.limbs().iter().enumerate() {
            let apart = after.ends()[limb].distance(before.ends()[model.mirrored_limb(limb)]);
            // Feet point the other way: their toes cannot stay.
            let most = if spec.name.ends_with("foot") { 0.45 } else { 0.12 };
            assert!(apart < most, "{}: {apart:.3} m", spec.name);
        }
    }

    #[test]
    fn twice_is_about_the_pose_itself() {
        let model = builtin::full_body();
        let pose = posed(&model);
        let again = turn_round(&model, &turn_round(&model, &pose));
        let (before, after) = (Kinematics::new(&model, &pose), Kinematics::new(&model, &again));
        for (limb, spec) in model.limbs().iter().enumerate() {
            let apart = after.ends()[limb].distance(before.ends()[limb]);
            assert!(apart < 0.12, "{}: {apart:.3} m", spec.name);
        }
    }

    #[test]
    fn a_body_without_sides_is_turned_too() {
        let model = builtin::single_limb();
        let pose = Pose::rest(&model).retract(Parameters::Tangent, &[0.1, 0.2, 0.3, 0.2, 0.1, 0.4]);
        assert_eq!(turn_round(&model, &pose).check(&model), Ok(()));
    }
}
