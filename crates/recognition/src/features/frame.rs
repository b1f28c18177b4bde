//! A frame as numbers, for principal components: joints relative to the hips, velocities of the ends of limbs, the root's own height, velocity
//! and turning. Units are sizes of the body (about metres) and seconds, brought to like weight by fixed factors and not by their spread,
//! so that what hardly moves stays small.

use glam::DVec3;

use super::{Normalised, RATE, smoothing};
use crate::joints::{JOINT_COUNT, Joint};

/// Joints whose velocities count.
const MOVING: [Joint; 9] = [
    Joint::Head,
    Joint::LeftWrist,
    Joint::RightWrist,
    Joint::LeftElbow,
    Joint::RightElbow,
    Joint::LeftKnee,
    Joint::RightKnee,
    Joint::LeftAnkle,
    Joint::RightAnkle,
];
/// Numbers of a frame.
pub const FRAME_FEATURES: usize = 3 * JOINT_COUNT + 3 * MOVING.len() + 5;
/// Weight of a velocity of a joint against a position, seconds.
const VELOCITY_S: f64 = 0.25;
/// Weight of the root's velocity, seconds.
const ROOT_VELOCITY_S: f64 = 0.5;
/// Weight of turning, seconds a radian.
const YAW_S: f64 = 0.2;

/// The numbers of every frame, [`FRAME_FEATURES`] each.
#[must_use]
pub fn frame_features(motion: &Normalised) -> Vec<Vec<f64>> {
    let relative = |joint: usize| -> Vec<DVec3> {
        (0..motion.len()).map(|frame| motion.joints[frame][joint] - motion.hip(frame)).collect()
    };
    let velocities = MOVING.map(|joint| smoothing::derivative(&relative(joint as usize), RATE));
    (0..motion.len())
        .map(|frame| {
            let hip = motion.hip(frame);
            let places = motion.joints[frame].iter().map(|&place| place - hip);
            let moving = velocities.iter().map(|velocity| VELOCITY_S * velocity[frame]);
            let root = ROOT_VELOCITY_S * motion.velocity[frame];
            let mut all: Vec<f64> = places.chain(moving).chain([root]).flat_map(|v| v.to_array()).collect();
            all.extend([YAW_S * motion.yaw_rate[frame], hip.y / motion.leg]);
            all
        })
        .collect()
}
