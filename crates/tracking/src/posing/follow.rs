//! A body that follows somebody's joints: the motion of another person, of other lengths, on this one.
//!
//! Directions are taken over, lengths are the body's own: from the middle of the hips outwards every joint is put at
//! a' = b' + ℓ (a − b)/|a − b|, with b its neighbour nearer to the trunk and ℓ this body's distance of both. The pose is the one that
//! [`reach`]es these places from the pose before.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec3};

use super::reach;
use crate::body::{Kinematics, Model, Pose, joint_names};
use crate::residual::point::PointTarget;

/// Rounds of [`reach`], each from the last one's pose.
const ROUNDS: usize = 4;
/// A joint and its neighbour nearer to the trunk.
const CHAINS: [(&str, &str); 4] =
    [("elbow", "shoulder"), ("wrist", "elbow"), ("knee", "hip"), ("ankle", "knee")];

/// A body that follows.
#[derive(Debug)]
pub struct Follower<'a> {
    model: &'a Model,
    /// The body's own joints at rest, by anatomical name, and the limbs that end there.
    rest: BTreeMap<String, (usize, DVec3)>,
    rest_axes: DMat3,
    last: Option<Pose>,
}

impl<'a> Follower<'a> {
    /// A body at rest; `None` without two hips and two shoulders.
    #[must_use]
    pub fn new(model: &'a Model) -> Option<Self> {
        let kinematics = Kinematics::new(model, &Pose::rest(model));
        let names = joint_names(model).into_iter().enumerate();
        let rest: BTreeMap<String, (usize, DVec3)> =
            names.map(|(limb, name)| (name, (limb, kinematics.ends()[limb]))).collect();
        let rest_axes = trunk(&|joint| rest.get(joint).map(|(_, place)| *place))?;
        Some(Self { model, rest, rest_axes, last: None })
    }

    /// How much larger this body is than one whose joints `at` tells: of the trunk and the legs. `None` where they are not seen.
    pub fn scale(&self, at: impl Fn(&str) -> Option<DVec3>) -> Option<f64> {
        let own = |joint: &str| self.rest.get(joint).map(|(_, place)| *place);
        let length = |at: &dyn Fn(&str) -> Option<DVec3>| {
            let both =
                |joint: &str| Some((at(&format!("left {joint}"))? + at(&format!("right {joint}"))?) / 2.0);
            let limb = |a: &str, b: &str| Some(at(a)?.distance(at(b)?));
            let legs = limb("left hip", "left knee")? + limb("left knee", "left ankle")?;
            Some(both("shoulder")?.distance(both("hip")?) + legs)
        };
        let [own, theirs] = [length(&own)?, length(&at)?];
        (theirs > 0.0).then_some(own / theirs)
    }

    /// The pose for joints whose places in this body's world, metres, `at` tells by their anatomical names. Where a chain's joint is
    /// not seen, the chain stays as it was. `None` without hips and shoulders.
    pub fn pose(&mut self, at: impl Fn(&str) -> Option<DVec3>) -> Option<Pose> {
        let axes = trunk(&at)?;
        let middle = |of: &dyn Fn(&str) -> Option<DVec3>, joint: &str| {
            Some((of(&format!("left {joint}"))? + of(&format!("right {joint}"))?) / 2.0)
        };
        let own = |joint: &str| self.rest.get(joint).map(|(_, place)| *place);
        let hips = middle(&at, "hip")?;
        let mut places: BTreeMap<String, DVec3> = BTreeMap::new();
        let trunk_length = middle(&own, "shoulder")?.distance(middle(&own, "hip")?);
        for (joint, from) in [("hip", hips), ("shoulder", hips + trunk_length * axes.z_axis)] {
            let [left, right] = [at(&format!("left {joint}"))?, at(&format!("right {joint}"))?];
            let across = (right - left).try_normalize()?;
            let half = own(&format!("right {joint}"))?.distance(own(&format!("left {joint}"))?) / 2.0;
            places.insert(format!("left {joint}"), from - half * across);
            places.insert(format!("right {joint}"), from + half * across);
        }
        for side in ["left", "right"] {
            for (joint, before) in
                CHAINS.map(|pair| (format!("{side} {}", pair.0), format!("{side} {}", pair.1)))
            {
                let along =
                    at(&joint).zip(at(&before)).and_then(|(joint, before)| (joint - before).try_normalize());
                let length = own(&joint).zip(own(&before)).map(|(joint, before)| joint.distance(before));
                let from = places.get(&before).copied();
                if let (Some(along), Some(length), Some(from)) = (along, length, from) {
                    places.insert(joint, from + length * along);
                }
            }
        }
        let target = |(joint, place): (&String, &DVec3)| {
            Some(PointTarget { limb: Some(self.rest.get(joint)?.0), target: *place, weight: 1.0 })
        };
        let targets: Vec<PointTarget> = places.iter().filter_map(target).collect();
        let start = self.last.clone().unwrap_or_else(|| self.standing(hips, axes));
        let pose = (0..ROUNDS).fold(start, |pose, _| reach(self.model, &pose, &targets));
        self.last = Some(pose.clone());
        Some(pose)
    }

    /// The rest pose, turned and moved to hips and axes of a trunk.
    fn standing(&self, hips: DVec3, axes: DMat3) -> Pose {
        let turn = DQuat::from_mat3(&(axes * self.rest_axes.transpose())).normalize();
        let mut pose = Pose::rest(self.model);
        for (rotation, parent) in pose.rotations.iter_mut().zip(self.model.rotation_parents()) {
            if parent.is_none() {
                *rotation = turn * *rotation;
            }
        }
        let own = |joint: &str| self.rest.get(joint).map_or(DVec3::ZERO, |(_, place)| *place);
        let middle = (own("left hip") + own("right hip")) / 2.0;
        pose.root = hips - turn * (middle - pose.root);
        pose
    }
}

/// The axes of a trunk in the world: to the right, forwards, up.
fn trunk(at: &dyn Fn(&str) -> Option<DVec3>) -> Option<DMat3> {
    let both = |joint: &str| Some([at(&format!("left {joint}"))?, at(&format!("right {joint}"))?]);
    let ([left, right], shoulders) = (both("hip")?, both("shoulder")?);
    let up = ((shoulders[0] + shoulders[1] - left - right) / 2.0).try_normalize()?;
    let right = (right - left).reject_from_normalized(up).try_normalize()?;
    Some(DMat3::from_cols(right, up.cross(right), up))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Parameters, builtin};

    /// Another person, a fifth larger, in any place and looking anywhere: every limb points where theirs does.
    #[test]
    fn limbs_point_where_the_others_do() {
        let model = builtin::full_body();
        let names = joint_names(&model);
        let mut follower = Follower::new(&model).unwrap();
        let turn = DQuat::from_rotation_z(2.1);
        for frame in 0..12 {
            let step = |column: usize| 0.15 * (0.3 * frame as f64 + 0.9 * column as f64).sin();
            let pose = crate::fixtures::stepped(&model, Parameters::Tangent, step);
            let ends = Kinematics::new(&model, &pose).ends().to_vec();
            let theirs = |joint: &str| {
                let limb = names.iter().position(|name| name == joint)?;
                Some(turn * ends[limb] * 1.2 + DVec3::new(3.0, -1.0, 0.5))
            };
            assert!((follower.scale(theirs).unwrap() - 1.0 / 1.2).abs() < 0.02);
            let followed = follower.pose(theirs).unwrap();
            let own = Kinematics::new(&model, &followed).ends().to_vec();
            let along = |of: &dyn Fn(&str) -> Option<DVec3>, a: &str, b: &str| {
                (of(b).unwrap() - of(a).unwrap()).normalize()
            };
            let ours = |joint: &str| names.iter().position(|name| name == joint).map(|limb| own[limb]);
            for side in ["left", "right"] {
                for (joint, before) in CHAINS {
                    let [a, b] = [format!("{side} {before}"), format!("{side} {joint}")];
                    let angle = along(&ours, &a, &b).angle_between(along(&theirs, &a, &b));
                    assert!(angle < 0.12, "{frame}: {b} {angle}");
                }
            }
        }
        assert_eq!(follower.pose(|_| None), None);
    }
}
