//! Recorded motion on a body: poses whose limbs point where a recorded person's do.
//!
//! Each limb swings to its direction the short way. An elbow or a knee bends about its own axis, so the limb before it is twisted until
//! the bend lies there; where it is nearly straight that says little, and the twist fades out.

use backlit_tracking::body::{Kinematics, Model, Pose, Sides};
use backlit_tracking::prior::{BodyDirection, BodyPoints, TrunkFrame};
use glam::{DMat3, DQuat, DVec3};

/// Sines of bends below this twist the limb before them less.
const STRAIGHT: f64 = 0.3;

/// A pose of the full body, or of one with the same limb names, with the directions of a person's limbs. The root is at the
/// origin; pelvis and chest are turned as `points` are. `None` where joints lie in one another, or the body lacks a limb.
#[must_use]
pub fn pose(model: &Model, points: &BodyPoints) -> Option<Pose> {
    let rest = Kinematics::new(model, &Pose::rest(model));
    let left = Sides::of(model, &rest)?.left;
    let mut pose = Pose::rest(model);
    let mut set = |limb: usize, rotation: DQuat| pose.rotations[model.limbs()[limb].rotation] = rotation;
    let turn = |limb: usize, frame: TrunkFrame| {
        let up = model.limbs()[limb].direction.reject_from_normalized(left).try_normalize()?;
        let at_rest = DMat3::from_cols(left, left.cross(up), up);
        Some(DQuat::from_mat3(&(points.frame(frame)? * at_rest.transpose())).normalize())
    };
    let (spine, chest) = (model.limb_index("spine")?, model.limb_index("chest")?);
    let pelvis = turn(spine, TrunkFrame::Pelvis)?;
    let thorax = turn(chest, TrunkFrame::Chest)?;
    set(spine, pelvis);
    set(chest, pelvis.inverse() * thorax);
    use BodyDirection as D;
    let chains = [
        (thorax, [D::RightUpperArm, D::RightForearm], None),
        (thorax, [D::LeftUpperArm, D::LeftForearm], None),
        (pelvis, [D::RightThigh, D::RightCalf], Some(D::RightFoot)),
        (pelvis, [D::LeftThigh, D::LeftCalf], Some(D::LeftFoot)),
    ];
    for (trunk, [upper, lower], end) in chains {
        let in_world = |direction: D| -> Option<DVec3> {
            Some(points.frame(direction.frame())? * points.direction(direction)?)
        };
        let [first, second] = [upper, lower].map(|direction| model.limb_index(&direction.limb()?));
        let (first, second) = (first?, second?);
        let (upper, lower) = (in_world(upper)?, in_world(lower)?);
        let swing = DQuat::from_rotation_arc(model.limbs()[first].direction, trunk.inverse() * upper);
        let limb = &model.limbs()[second];
        let (axis, _) = limb.swing_axes();
        let bent = (trunk * swing).inverse() * lower;
        let (aside, ahead) = (bent.dot(axis), bent.dot(axis.cross(limb.direction)));
        let known = (aside.hypot(ahead) / STRAIGHT).min(1.0);
        let twist = DQuat::from_axis_angle(limb.direction, known * aside.atan2(ahead));
        let above = swing * twist;
        let below = DQuat::from_rotation_arc(limb.direction, (trunk * above).inverse() * lower);
        set(first, above);
        set(second, below);
        if let Some(direction) = end {
            let foot = model.limb_index(&direction.limb()?)?;
            let ahead = (trunk * above * below).inverse() * in_world(direction)?;
            set(foot, DQuat::from_rotation_arc(model.limbs()[foot].direction, ahead));
        }
    }
    Some(pose)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;
    use crate::synthetic::occlusions::Occlusion;

    /// Of a pose's own joints, a pose with the same limbs; elbows and knees bend as they may.
    #[test]
    fn limbs_point_where_the_recorded_ones_do() {
        let model = builtin::full_body();
        for which in Occlusion::ALL {
            let mut truth = which.pose(&model, 1.3);
            for name in ["right clavicle", "left clavicle", "neck"] {
                let limb = model.limb_index(name).unwrap();
                truth.rotations[model.limbs()[limb].rotation] = DQuat::IDENTITY;
            }
            let joints = Kinematics::new(&model, &truth);
            let end = |name: &str| joints.ends()[model.limb_index(name).unwrap()];
            let pair = |name: &str| ["right", "left"].map(|side| end(&format!("{side} {name}")));
            let points = BodyPoints {
                hips: pair("hip"),
                waist: end("spine"),
                neck: end("chest"),
                shoulders: pair("clavicle"),
                elbows: pair("upper arm"),
                wrists: pair("forearm"),
                knees: pair("lower thigh"),
                ankles: pair("lower calf"),
                toes: pair("foot"),
            };
            let found = pose(&model, &points).unwrap();
            let again = Kinematics::new(&model, &found);
            for (limb, end) in model.limbs().iter().zip(again.ends().iter().zip(joints.ends())) {
                let off = (*end.0 + truth.root).distance(*end.1);
                assert!(off < 1e-9, "{which:?}, {}: {off}", limb.name);
            }
            let forearm = &model.limbs()[model.limb_index("right forearm").unwrap()];
            let bend = forearm.angles(found.rotations[forearm.rotation]);
            assert!(bend.sideways.abs() < 0.15 && bend.flexion > -0.01, "{which:?}: {bend:?}");
        }
    }
}
