//! Movements in which limbs lose their own boundary: what silhouettes do not hold.
//!
//! Arms are folded, hands put on hips, arms raised to the front in squats, legs crossed, all before two telephones 37°
//! apart; and a walk is seen by two from one side. Each takes a [`PERIOD`] and comes back to where it began.

use std::f64::consts::TAU;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::{Camera, CameraError};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::exercise::{Arm, standing};
use super::motion::{ANKLE_HEIGHT, place_leg, set};
use super::squats;

/// Seconds of one movement.
pub const PERIOD: f64 = 3.0;
/// Steps of each foot in that time.
const STEPS: f64 = 3.0;
/// Where the telephones stand that see a walk from the subject's right, degrees to the left of straight ahead.
const FROM_THE_RIGHT: [f64; 2] = [-71.5, -108.5];

/// What hides what.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Occlusion {
    /// The arms are folded before the chest.
    FoldedArms,
    /// The hands are put on the hips.
    HandsOnHips,
    /// Squats, the arms raised to the front.
    Squats,
    /// A walk on the spot, seen from the right.
    WalkFromTheSide,
    /// One leg is put across the other, and back.
    CrossedLegs,
}

impl Occlusion {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::FoldedArms, Self::HandsOnHips, Self::Squats, Self::WalkFromTheSide, Self::CrossedLegs];

    /// What it is called in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FoldedArms => "arms folded",
            Self::HandsOnHips => "hands on hips",
            Self::Squats => "squats, arms to the front",
            Self::WalkFromTheSide => "walk from the side",
            Self::CrossedLegs => "legs crossed",
        }
    }

    /// The cameras that see it.
    ///
    /// # Errors
    /// A size that no camera can have.
    pub fn cameras(self, size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, CameraError> {
        match self {
            Self::WalkFromTheSide => squats::cameras_at(&FROM_THE_RIGHT, size_px),
            _ => squats::cameras(size_px),
        }
    }

    /// The true pose at a time in seconds. `model` is to be the built-in full body or one of other sizes with its limb names.
    #[must_use]
    pub fn pose(self, model: &Model, seconds: f64) -> Pose {
        // 0 at the beginning and the end of a period, 1 for a while in between.
        let share = (0.75 * (1.0 - (TAU * seconds / PERIOD).cos())).min(1.0);
        let share = share * share * (3.0 - 2.0 * share);
        let arm = |raised, out, turned, elbow| HANGING.towards(Arm { raised, out, turned, elbow }, share);
        match self {
            Self::FoldedArms => {
                let (right, left) = (arm(38.0, 4.0, 62.0, 104.0), arm(26.0, 4.0, 66.0, 98.0));
                standing(model, seconds, right, left)
            }
            Self::HandsOnHips => {
                let arm = arm(-22.0, 40.0, 58.0, 92.0);
                standing(model, seconds, arm, arm)
            }
            Self::Squats => squats::pose(model, seconds),
            Self::WalkFromTheSide => walking(model, seconds),
            Self::CrossedLegs => {
                let mut pose = standing(model, seconds, HANGING, HANGING);
                let lift = 0.12 * (share * (1.0 - share) * 4.0);
                let right = DVec3::new(0.13 - 0.27 * share, 0.16 * share, ANKLE_HEIGHT + lift);
                place_leg(model, &mut pose, "right", right, DQuat::from_rotation_z(-0.1 + 0.3 * share));
                pose
            }
        }
    }
}

const HANGING: Arm = Arm { raised: 4.0, out: 20.0, turned: 0.0, elbow: 14.0 };

fn walking(model: &Model, seconds: f64) -> Pose {
    let phase = TAU * STEPS * seconds / PERIOD;
    let arm = |sign: f64| Arm {
        raised: 6.0 + sign * 26.0 * phase.sin(),
        out: 9.0,
        turned: 0.0,
        elbow: 24.0 + sign * 10.0 * phase.sin(),
    };
    let mut pose = standing(model, 0.0, arm(-1.0), arm(1.0));
    pose.root.z = 0.89 + 0.012 * (2.0 * phase).cos();
    let lean = DQuat::from_rotation_z(0.08 * phase.sin()) * DQuat::from_rotation_x(-0.08);
    set(model, &mut pose, "spine", lean);
    for (side, sign) in [("right", 1.0), ("left", -1.0)] {
        let swing = sign * phase.cos();
        // The foot is in the air while it goes ahead.
        let lift = 0.1 * swing.max(0.0).powi(2);
        let ankle = DVec3::new(sign * 0.1, sign * 0.27 * phase.sin(), ANKLE_HEIGHT + lift);
        place_leg(model, &mut pose, side, ankle, DQuat::from_rotation_x(-0.4 * swing.max(0.0)));
    }
    pose
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Kinematics, builtin};

    use super::*;
    use crate::synthetic::motion::tests::check_movement;

    #[test]
    fn joints_stay_within_their_limits_and_in_the_picture_and_do_not_leap() {
        for which in Occlusion::ALL {
            let cameras = which.cameras([180, 320]).unwrap();
            let pose = |model: &Model, frame: f64| which.pose(model, frame / 60.0);
            check_movement(pose, [180.0, 60.0], 0.02, &cameras, 5.0, 4.0);
        }
    }

    #[test]
    fn limbs_are_where_they_should_be_halfway() {
        let model = builtin::full_body();
        let end = |which: Occlusion, name: &str| {
            let joints = Kinematics::new(&model, &which.pose(&model, 0.5 * PERIOD));
            joints.ends()[model.limb_index(name).unwrap()]
        };
        // Each hand before the other side of the chest.
        let [right, left, chest] =
            ["right hand", "left hand", "chest"].map(|l| end(Occlusion::FoldedArms, l));
        assert!(right.x < -0.02 && left.x > 0.02, "{right} {left}");
        assert!(right.y > chest.y + 0.1 && right.z < chest.z && right.z > 0.95, "{right} {chest}");
        let [hand, elbow, hip] =
            ["right hand", "right upper arm", "right hip"].map(|l| end(Occlusion::HandsOnHips, l));
        assert!(hand.distance(hip) < 0.26 && elbow.x > hip.x + 0.15, "{hand} {elbow} {hip}");
        let [right, left] =
            ["right lower calf", "left lower calf"].map(|limb| end(Occlusion::CrossedLegs, limb));
        assert!(right.x < left.x + 0.02 && right.y > left.y + 0.1, "{right} {left}");
    }
}
