//! Poses that silhouettes confuse with a given one: sides exchanged, limbs mirrored in depth, the body turned round.

use glam::{DQuat, DVec3};

use super::Chains;
use crate::body::{Kinematics, Model, Pose};
use crate::posing;

/// Solves for the places of the joints.
const ROUNDS: usize = 3;

/// Chains and the chain of the other side, each pair once.
pub(crate) fn pairs(model: &Model, parts: &Chains) -> Vec<[usize; 2]> {
    let owner = |chain: usize| model.rotation_owners()[parts.chains[chain][0]];
    let other = |chain: usize| {
        let limb = model.mirrored_limb(owner(chain));
        (0..parts.chains.len()).find(|&other| owner(other) == limb)
    };
    let pair = |chain: usize| other(chain).filter(|&other| other > chain).map(|other| [chain, other]);
    (0..parts.chains.len()).filter_map(pair).collect()
}

/// The pose with the limbs of two chains where the other side's were.
pub(crate) fn swapped(model: &Model, parts: &Chains, pose: &Pose, pair: [usize; 2]) -> Pose {
    let before = Kinematics::new(model, pose);
    let in_pair = |limb: usize| {
        let rotation = model.limbs()[limb].rotation;
        pair.iter().any(|&chain| parts.chains[chain].contains(&rotation))
    };
    let place = |limb: usize| before.ends()[if in_pair(limb) { model.mirrored_limb(limb) } else { limb }];
    posing::reach_all(model, pose, ROUNDS, place)
}

/// The pose with some rotations of a chain mirrored in depth: their limbs point as far towards the viewer, who looks along `ahead`,
/// as they pointed away. The other rotations' limbs keep their directions.
///
/// C. Sminchisescu and B. Triggs, "Kinematic jump processes for monocular 3D human tracking" (2003).
pub(crate) fn flipped(model: &Model, chain: &[usize], pose: &Pose, flips: &[usize], ahead: DVec3) -> Pose {
    let before = Kinematics::new(model, pose);
    let mut flipped = pose.clone();
    let mut turned: Vec<(usize, DQuat)> = Vec::new();
    for &rotation in chain {
        let world = DQuat::from_mat3(&before.world_rotations()[rotation]);
        let direction = world * model.limbs()[model.rotation_owners()[rotation]].direction;
        let wanted = if flips.contains(&rotation) {
            direction - ahead * (2.0 * direction.dot(ahead))
        } else {
            direction
        };
        let now = DQuat::from_rotation_arc(direction.normalize(), wanted.normalize()) * world;
        let parent = model.rotation_parents()[rotation];
        let frame = parent.map_or(DQuat::IDENTITY, |parent| {
            let moved = turned.iter().find(|(rotation, _)| *rotation == parent).map(|(_, now)| *now);
            moved.unwrap_or_else(|| DQuat::from_mat3(&before.world_rotations()[parent]))
        });
        flipped.rotations[rotation] = (frame.inverse() * now).normalize();
        turned.push((rotation, now));
    }
    flipped
}
