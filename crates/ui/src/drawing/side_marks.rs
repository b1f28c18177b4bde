//! Left, right and face of a body as one camera sees them: without them a body that is turned round looks right.

use backlit_tracking::body::{Kinematics, Model, Sides};
use backlit_tracking::camera::Camera;
use glam::{DVec2, DVec3};

use backlit_words::joint::JointId;

use super::joints::draggable_joints;

/// The middle of the head on the topmost limb, from its first joint to its second.
const HEAD_SHARE: f64 = 0.65;
/// The nose is this far from the middle of the head, in the head's radii.
const NOSE_RADII: f64 = 1.9;

/// A side of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodySide {
    /// The body's own left.
    Left,
    /// The body's own right.
    Right,
}

impl BodySide {
    /// What stands beside a hand or a foot.
    pub fn letter(self) -> &'static str {
        match self {
            Self::Left => "L",
            Self::Right => "R",
        }
    }
}

/// A hand or a foot, and on which side it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideLetter {
    /// The side.
    pub side: BodySide,
    /// The end of the limb, pixels.
    pub at: DVec2,
    /// Onwards from there along the limb, a unit vector.
    pub away: DVec2,
}

/// Which way the body faces: a nose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// The middle of the head, pixels.
    pub from: DVec2,
    /// The tip of the nose, pixels.
    pub tip: DVec2,
    /// Whether the nose is nearer to the camera than the head.
    pub is_towards: bool,
}

/// The marks of one camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideMarks {
    /// Beside hands and feet.
    pub letters: Vec<SideLetter>,
    /// `None` for a body without sides, or a head behind the camera.
    pub face: Option<Face>,
}

impl SideMarks {
    /// Of a posed body.
    pub fn new(model: &Model, kinematics: &Kinematics, camera: &Camera) -> Self {
        let project = |point: DVec3| camera.project(point).filter(|px| px.is_finite());
        let (starts, ends) = (kinematics.starts(), kinematics.ends());
        let carries_others = |limb: usize| {
            let rotation = model.limbs()[limb].rotation;
            model.rotation_parents().contains(&Some(rotation))
        };
        let letter = |joint: JointId| {
            let JointId::End(limb) = joint else { return None };
            if model.mirrored_limb(limb) == limb || carries_others(limb) {
                return None;
            }
            let is_left = model.limbs()[limb].name.starts_with("left ");
            let side = if is_left { BodySide::Left } else { BodySide::Right };
            let (start, at) = (project(starts[limb])?, project(ends[limb])?);
            Some(SideLetter { side, at, away: (at - start).try_normalize().unwrap_or(DVec2::Y) })
        };
        let face = Sides::of(model, kinematics).and_then(|sides| {
            let middle = (0..model.limbs().len()).filter(|&limb| model.mirrored_limb(limb) == limb);
            let head = middle.max_by(|&a, &b| ends[a].dot(sides.up).total_cmp(&ends[b].dot(sides.up)))?;
            let centre = starts[head].lerp(ends[head], HEAD_SHARE);
            let tip = centre + sides.ahead * (NOSE_RADII * model.limbs()[head].radius);
            let is_towards = camera.depth(tip) < camera.depth(centre);
            Some(Face { from: project(centre)?, tip: project(tip)?, is_towards })
        });
        Self { letters: draggable_joints(model).into_iter().filter_map(letter).collect(), face }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Pose, builtin};
    use backlit_tracking::posing::turn_round;

    use super::*;
    use crate::drawing::input::tests;

    fn camera(from: DVec3) -> Camera {
        tests::camera([201, 301], [200.0, 100.0, 150.0], from, DVec3::ZERO, DVec3::Y)
    }

    #[test]
    fn hands_and_feet_have_letters_and_the_nose_says_where_it_faces() {
        let model = builtin::full_body();
        let rest = Pose::rest(&model);
        let kinematics = Kinematics::new(&model, &rest);
        let sides = Sides::of(&model, &kinematics).unwrap();
        let front = SideMarks::new(&model, &kinematics, &camera(sides.ahead * 4.0));
        assert_eq!(front.letters.len(), 4);
        for letter in &front.letters {
            // Seen from the front, a body's left is at the picture's right.
            assert_eq!(letter.side == BodySide::Left, letter.at.x > 100.0, "{letter:?}");
        }
        assert!(front.face.unwrap().is_towards);
        let back = SideMarks::new(&model, &kinematics, &camera(sides.ahead * -4.0));
        assert!(!back.face.unwrap().is_towards);
        let turned = Kinematics::new(&model, &turn_round(&model, &rest));
        assert!(!SideMarks::new(&model, &turned, &camera(sides.ahead * 4.0)).face.unwrap().is_towards);
    }

    #[test]
    fn one_limb_has_neither() {
        let model = builtin::single_limb();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        assert_eq!(SideMarks::new(&model, &kinematics, &camera(DVec3::Z * 4.0)), SideMarks::default());
    }
}
