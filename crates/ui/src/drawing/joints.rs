//! The joints that can be dragged, where a camera sees them, and what a drag does.

use std::collections::BTreeSet;

use backlit_tracking::body::{Kinematics, Model};
use backlit_tracking::camera::Camera;
use backlit_words::joint::{JointId, joint_name};
use glam::{DVec2, DVec3};

/// A joint as one camera sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMark {
    /// Which joint.
    pub id: JointId,
    /// What people call it: "right wrist".
    pub name: String,
    /// Where it is in the picture.
    pub px: DVec2,
    /// Its depth along the optical axis, metres.
    pub depth_m: f64,
    /// It does not follow drags of other joints.
    pub is_pinned: bool,
}

/// The joints worth a handle: the root, every joint at which a limb with a rotation of its own grows, and the
/// end of every limb with a rotation of its own that carries no other.
pub fn draggable_joints(model: &Model) -> Vec<JointId> {
    let limbs = model.limbs();
    let mut joints = BTreeSet::from([JointId::Root]);
    let carried = |rotation: usize| {
        limbs.iter().any(|limb| {
            limb.has_own_rotation && limb.parent.is_some_and(|parent| limbs[parent].rotation == rotation)
        })
    };
    for (index, limb) in limbs.iter().enumerate() {
        if limb.has_own_rotation {
            joints.extend(limb.parent.map(JointId::End));
            if !carried(limb.rotation) {
                joints.insert(JointId::End(index));
            }
        }
    }
    joints.into_iter().collect()
}

/// The draggable joints in front of a camera. `root` is the root's position in the world.
pub fn project_joints(
    model: &Model,
    kinematics: &Kinematics,
    root: DVec3,
    camera: &Camera,
    is_pinned: impl Fn(JointId) -> bool,
) -> Vec<JointMark> {
    let mark = |id: JointId| {
        let point = joint_position(id, root, kinematics)?;
        let px = camera.project(point).filter(|px| px.is_finite())?;
        let depth_m = camera.depth(point);
        Some(JointMark { id, name: joint_name(model, id), px, depth_m, is_pinned: is_pinned(id) })
    };
    draggable_joints(model).into_iter().filter_map(mark).collect()
}

/// Where a joint is in the world; `None` for one that the body does not have. `root` is the root's position.
pub fn joint_position(joint: JointId, root: DVec3, kinematics: &Kinematics) -> Option<DVec3> {
    match joint {
        JointId::Root => Some(root),
        JointId::End(limb) => kinematics.ends().get(limb).copied(),
    }
}

/// What the pointer does with a drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DragEvent {
    /// It begins. Pressing a modifier on the way begins again, from the pose that is reached.
    Begin(Drag),
    /// It goes on. Everything counts from the pose at the start.
    Move(Drag),
    /// The button is up.
    End,
    /// Esc: all is as it was when the button went down.
    Cancel,
}

/// How a drag moves the body, counted from the pose at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drag {
    /// A joint follows the pointer parallel to the image; the chain follows it.
    Joint {
        /// The joint.
        joint: JointId,
        /// Where the picture is to show it.
        target_px: DVec2,
    },
    /// A joint moves along its sight ray. The root takes the whole body with it.
    Depth {
        /// The joint.
        joint: JointId,
        /// Its depth is the one at the start times this.
        ratio: f64,
    },
    /// A limb turns about itself.
    Twist {
        /// The limb that owns the rotation.
        limb: usize,
        /// Radians, right-handed about the limb from its first joint to its second.
        angle_rad: f64,
    },
    /// A limb turns about its first joint, in the plane of the image.
    Turn {
        /// The limb that owns the rotation.
        limb: usize,
        /// Its first joint in the picture: the axis is that pixel's ray.
        pivot_px: DVec2,
        /// Radians, right-handed about that ray away from the camera: clockwise as seen.
        angle_rad: f64,
    },
    /// A limb becomes longer or shorter by its end.
    Length {
        /// The limb.
        limb: usize,
        /// Where it was taken hold of.
        from_px: DVec2,
        /// Where the pointer is.
        to_px: DVec2,
    },
    /// A limb becomes thicker or thinner by its outline.
    Radius {
        /// The limb.
        limb: usize,
        /// Where it was taken hold of.
        from_px: DVec2,
        /// Where the pointer is.
        to_px: DVec2,
    },
    /// The whole body moves parallel to the image.
    Body {
        /// Where it was taken hold of.
        from_px: DVec2,
        /// Where that point is to be.
        to_px: DVec2,
        /// The depth of that point, metres.
        depth_m: f64,
    },
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin::{full_body, single_limb, upper_body};

    use super::*;

    #[test]
    fn the_full_body_has_a_handle_at_each_joint_and_no_more() {
        let model = full_body();
        let names: Vec<String> =
            draggable_joints(&model).into_iter().map(|joint| joint_name(&model, joint)).collect();
        let both = ["shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toes"];
        let mut expected = vec!["root".to_owned(), "waist".into(), "neck".into(), "head".into()];
        expected.extend(both.iter().flat_map(|name| [format!("right {name}"), format!("left {name}")]));
        let (mut found, mut expected) = (names.clone(), expected);
        found.sort();
        expected.sort();
        assert_eq!(found, expected);
        assert_eq!(names[0], "root");
    }

    #[test]
    fn every_model_can_be_held() {
        assert_eq!(draggable_joints(&single_limb()), [JointId::Root, JointId::End(0)]);
        let model = upper_body();
        let names: Vec<String> = draggable_joints(&model).iter().map(|j| joint_name(&model, *j)).collect();
        assert!(names.contains(&"right wrist".to_owned()) && names.contains(&"head".to_owned()), "{names:?}");
    }
}
