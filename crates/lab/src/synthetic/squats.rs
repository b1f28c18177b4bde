//! Squats with the arms raised to the front, before two telephones: what people film at home.
//!
//! The hips go back and down and up again, the trunk leans forward, the arms rise to the front as the knees bend: there the
//! cameras look along them and see them before the trunk, where a silhouette does not show them.

use std::f64::consts::TAU;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::{Camera, CameraError};
use glam::{DQuat, DVec3};

use super::motion::{ANKLE_HEIGHT, place_leg, set, set_angles};
use super::studio::pinhole;

/// Frames a second of the recording.
pub const FRAME_RATE: f64 = 30.0;
/// Seconds of one squat.
pub const PERIOD: f64 = 3.0;
/// Where the two cameras stand: degrees to the subject's left of straight ahead, 37° between them.
const PLACES: [f64; 2] = [24.0, -13.0];
/// Metres from the person, over the floor; height above it.
const DISTANCE: f64 = 2.9;
const HEIGHT: f64 = 1.2;
/// Focal length, in picture heights.
const FOCAL: f64 = 1.25;
/// What the cameras look at.
const TARGET: DVec3 = DVec3::new(0.0, 0.0, 0.85);

/// The true pose at a time in seconds: standing at 0, down half a [`PERIOD`] later. No squat is as deep as the one before.
///
/// `model` is to be the built-in full body or one of other sizes with the same limb names.
#[must_use]
pub fn pose(model: &Model, seconds: f64) -> Pose {
    let depth = 0.5 - 0.5 * (TAU * seconds / PERIOD).cos();
    let depth = depth * (0.92 + 0.08 * (1.7 * seconds).cos());
    let sway = (0.9 * seconds).sin();
    let mut pose = Pose::rest(model);
    pose.root = DVec3::new(0.012 * sway, -0.16 * depth, 0.915 - 0.36 * depth);
    let lean = (3.0 + 32.0 * depth).to_radians();
    let turn = (2.0 * sway).to_radians();
    set(model, &mut pose, "spine", DQuat::from_rotation_z(turn) * DQuat::from_rotation_x(-lean));
    set_angles(model, &mut pose, "chest", [3.0 + 8.0 * depth, 1.5 * sway, 0.0]);
    set_angles(model, &mut pose, "neck", [-4.0 - 18.0 * depth, 0.0, 0.0]);
    for (side, sign, ahead) in [("right", 1.0, 0.0), ("left", -1.0, 0.12)] {
        // One arm is a little ahead of the other.
        let raised = 0.5 - 0.5 * (TAU * seconds / PERIOD + ahead).cos();
        let mut joint = |limb: &str, angles| set_angles(model, &mut pose, &format!("{side} {limb}"), angles);
        joint("clavicle", [6.0 * raised, -sign * 8.0 * raised, 0.0]);
        joint("upper arm", [6.0 + 108.0 * raised, sign * (9.0 - 3.0 * raised), 0.0]);
        joint("forearm", [12.0 - 4.0 * raised, 0.0, 0.0]);
    }
    for (side, sign) in [("right", 1.0), ("left", -1.0)] {
        let ankle = DVec3::new(sign * 0.17, -0.02, ANKLE_HEIGHT);
        place_leg(model, &mut pose, side, ankle, DQuat::from_rotation_z(-sign * 14f64.to_radians()));
    }
    pose
}

/// The two telephones, upright, with pictures of this many pixels across and down.
///
/// # Errors
/// A size that no camera can have.
pub fn cameras(size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, CameraError> {
    cameras_at(&PLACES, size_px)
}

/// The same, or more of them, in other places, degrees to the subject's left of straight ahead.
///
/// # Errors
/// A size that no camera can have.
pub fn cameras_at(places: &[f64], size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, CameraError> {
    let focal = FOCAL * size_px[1] as f64;
    let place = |(index, degrees): (usize, &f64)| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let centre = DVec3::new(-sine * DISTANCE, cosine * DISTANCE, HEIGHT);
        pinhole(&format!("phone{}", index + 1), size_px, focal, [centre, TARGET], DVec3::Z)
    };
    places.iter().enumerate().map(place).collect()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Kinematics, builtin};

    use super::*;
    use crate::synthetic::motion::tests::check_movement;

    #[test]
    fn feet_stay_arms_rise_and_nobody_leaves_the_picture() {
        let model = builtin::full_body();
        let cameras = cameras([180, 320]).unwrap();
        let joint =
            |pose: &Pose, name: &str| Kinematics::new(&model, pose).ends()[model.limb_index(name).unwrap()];
        let standing = pose(&model, 0.0);
        for frame in 0..120 {
            let pose = pose(&model, f64::from(frame) / FRAME_RATE);
            pose.check(&model).unwrap();
            for side in ["right", "left"] {
                let ankle = format!("{side} lower calf");
                let slid = joint(&pose, &ankle).distance(joint(&standing, &ankle));
                assert!(slid < 5e-3, "{ankle} slid {slid:.4} m by frame {frame}");
            }
        }
        let at_frame = |model: &Model, frame| pose(model, frame / FRAME_RATE);
        check_movement(at_frame, [120.0, FRAME_RATE], f64::INFINITY, &cameras, 5.0, f64::INFINITY);
        let down = pose(&model, 0.5 * PERIOD);
        assert!(joint(&down, "right hand").y > joint(&down, "chest").y + 0.45);
        assert!(down.root.z < standing.root.z - 0.25);
    }
}
