//! Which way a body faces, by its right and left limbs.

use glam::DVec3;

use super::{Kinematics, Model};

/// A body whose sides are nearer to its long axis than this cosine has no side to tell.
const LEAST_ACROSS: f64 = 0.2;

/// The directions of a body with sides: unit vectors at right angles, world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// To the body's own left.
    pub left: DVec3,
    /// Along the trunk, from its lower end to its upper end.
    pub up: DVec3,
    /// Where the chest points.
    pub ahead: DVec3,
}

impl Sides {
    /// Of a pose. Left and right are told by where "right …" and "left …" limbs leave the trunk (hips and shoulders), so
    /// that crossed arms change nothing; up by the limbs in the middle. `None` for a body without sides.
    pub fn of(model: &Model, kinematics: &Kinematics) -> Option<Self> {
        let (starts, ends) = (kinematics.starts(), kinematics.ends());
        let (mut across, mut along) = (DVec3::ZERO, DVec3::ZERO);
        for (index, limb) in model.limbs().iter().enumerate() {
            let other = model.mirrored_limb(index);
            let leaves_trunk = limb.parent.is_none_or(|parent| model.mirrored_limb(parent) == parent);
            if other == index {
                along += ends[index] - starts[index];
            } else if leaves_trunk && limb.name.starts_with("right ") {
                across += ends[other] - ends[index];
            }
        }
        let left = across.try_normalize()?;
        let along = along.try_normalize()?;
        let up = along - left * left.dot(along);
        let up = (up.length() > LEAST_ACROSS).then(|| up.normalize())?;
        Some(Self { left, up, ahead: left.cross(up) })
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::body::{Pose, builtin};

    #[test]
    fn the_toes_of_a_body_at_rest_are_ahead_of_it() {
        let model = builtin::full_body();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        let sides = Sides::of(&model, &kinematics).unwrap();
        for side in ["right", "left"] {
            let foot = model.limb_index(&format!("{side} foot")).unwrap();
            let toes = kinematics.ends()[foot] - kinematics.starts()[foot];
            assert!(toes.dot(sides.ahead) > 0.5 * toes.length(), "{side}: {toes} {sides:?}");
            let hand = model.limb_index(&format!("{side} forearm")).unwrap();
            let is_left = kinematics.ends()[hand].dot(sides.left) > 0.0;
            assert_eq!(is_left, side == "left");
        }
        let head = model.limb_index("skull").unwrap();
        assert!(kinematics.ends()[head].dot(sides.up) > 0.3);
    }

    #[test]
    fn sides_turn_with_the_body() {
        let model = builtin::upper_body();
        let rest = Pose::rest(&model);
        let of = |pose: &Pose| Sides::of(&model, &Kinematics::new(&model, pose)).unwrap();
        let turn = DQuat::from_rotation_y(2.0) * DQuat::from_rotation_x(0.4);
        let mut turned = rest.clone();
        for (rotation, parent) in model.rotation_parents().iter().enumerate() {
            if parent.is_none() {
                turned.rotations[rotation] = turn * turned.rotations[rotation];
            }
        }
        let (before, after) = (of(&rest), of(&turned));
        assert!(after.ahead.distance(turn * before.ahead) < 1e-12);
        assert!(after.up.distance(turn * before.up) < 1e-12);
    }

    #[test]
    fn one_limb_has_no_sides() {
        let model = builtin::single_limb();
        assert_eq!(Sides::of(&model, &Kinematics::new(&model, &Pose::rest(&model))), None);
    }
}
