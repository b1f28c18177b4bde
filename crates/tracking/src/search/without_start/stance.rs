//! The body as it stands: upright, at rest, facing any way.

use glam::{DMat3, DQuat, DVec3};

use super::super::chains::Chains;
use crate::body::{Kinematics, Model, Pose, Sides};

/// Limbs at rest that reach less than this out of the body's plane tell no front, metres.
const LEAST_FRONT: f64 = 1e-3;

/// Directions and extents of a body at rest. Unit vectors at right angles; metres from the root.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stance {
    /// Along the trunk.
    up: DVec3,
    /// Where the body looks; any direction at right angles to `up` where that cannot be told.
    ahead: DVec3,
    /// Whether front and back can be told.
    pub(crate) has_front: bool,
    /// How far the body reaches below and above the root, radii included.
    pub(crate) below: f64,
    pub(crate) above: f64,
}

impl Stance {
    pub(crate) fn new(model: &Model, parts: &Chains) -> Self {
        let kinematics = Kinematics::new(model, &Pose::rest(model));
        let (starts, ends) = (kinematics.starts(), kinematics.ends());
        let trunk = parts.trunk.iter().flat_map(|&rotation| &parts.groups[rotation]);
        let along: DVec3 = trunk.map(|&limb| ends[limb] - starts[limb]).sum();
        let (up, ahead, has_front) = match Sides::of(model, &kinematics) {
            Some(sides) => (sides.up, sides.ahead, true),
            None => {
                let up = along.normalize_or(DVec3::Y);
                let (ahead, has_front) = front(up, ends);
                (up, ahead, has_front)
            }
        };
        let [low, high] = reach(model, &kinematics, up);
        Self { up, ahead, has_front, below: -low, above: high }
    }

    /// How tall the body stands, metres.
    pub(crate) fn height(&self) -> f64 {
        self.below + self.above
    }

    /// The body at rest, standing along `up` and facing `ahead` (unit vectors at right angles, world axes).
    pub(crate) fn pose(&self, model: &Model, root: DVec3, up: DVec3, ahead: DVec3) -> Pose {
        let basis = |up: DVec3, ahead: DVec3| DMat3::from_cols(up.cross(ahead), up, ahead);
        let turn = DQuat::from_mat3(&(basis(up, ahead) * basis(self.up, self.ahead).transpose()));
        let mut pose = Pose::rest(model);
        pose.root = root;
        turn_whole(model, &mut pose, turn);
        pose
    }

    /// Along the trunk of a posed body, and where it looks: both by the rotation that turns all of it.
    pub(crate) fn up_of(&self, model: &Model, pose: &Pose) -> DVec3 {
        whole_turn(model, pose) * self.up
    }

    /// The same of where it looks.
    pub(crate) fn ahead_of(&self, model: &Model, pose: &Pose) -> DVec3 {
        whole_turn(model, pose) * self.ahead
    }
}

/// Lowest and highest place of a body along a direction, metres.
fn reach(model: &Model, kinematics: &Kinematics, up: DVec3) -> [f64; 2] {
    let joints = kinematics.starts().iter().zip(kinematics.ends()).zip(model.limbs());
    joints.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ((start, end), limb)| {
        let (start, end) = (start.dot(up), end.dot(up));
        [low.min(start.min(end) - limb.radius), high.max(start.max(end) + limb.radius)]
    })
}

/// The first rotation that no other turns.
fn whole_turn(model: &Model, pose: &Pose) -> DQuat {
    let first = model.rotation_parents().iter().position(Option::is_none);
    first.map_or(DQuat::IDENTITY, |rotation| pose.rotations[rotation])
}

/// Turns the whole body about its root.
pub(crate) fn turn_whole(model: &Model, pose: &mut Pose, turn: DQuat) {
    for (rotation, parent) in model.rotation_parents().iter().enumerate() {
        if parent.is_none() {
            pose.rotations[rotation] = (turn * pose.rotations[rotation]).normalize();
        }
    }
}

/// The front of a body without named sides: across its broadest direction, to where limbs at rest reach.
fn front(up: DVec3, ends: &[DVec3]) -> (DVec3, bool) {
    let (a, b) = up.any_orthonormal_pair();
    let moment = |u: DVec3, v: DVec3| ends.iter().map(|end| end.dot(u) * end.dot(v)).sum::<f64>();
    let angle = 0.5 * (2.0 * moment(a, b)).atan2(moment(a, a) - moment(b, b));
    let across = a * angle.cos() + b * angle.sin();
    let ahead = across.cross(up);
    let reach: f64 = ends.iter().map(|end| end.dot(ahead)).sum::<f64>() / ends.len().max(1) as f64;
    let has_front = reach.abs() > LEAST_FRONT;
    (if has_front && reach < 0.0 { -ahead } else { ahead }, has_front)
}
