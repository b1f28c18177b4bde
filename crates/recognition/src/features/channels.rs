//! Angles, distances and speeds over time: what the body does, in words of the body. Every channel is a row of numbers, a number a frame; what
//! both sides have is a pair, left first. Lengths are sizes of the body (about metres), angles radians, rates a second.

use glam::DVec3;

use super::{Normalised, RATE, smoothing};
use crate::joints::Joint;

/// A number a frame.
pub(super) type Row = Vec<f64>;

/// What the body does, frame by frame.
#[derive(Debug, Clone, Default)]
pub struct Channels {
    /// Height of the hips in lengths of a leg.
    pub(super) hip_height: Row,
    /// Velocity of the hips: to the left, up, forward.
    pub(super) velocity: [Row; 3],
    /// Speed over the ground.
    pub(super) speed: Row,
    /// Turning about the vertical.
    pub(super) yaw_rate: Row,
    /// Lean of the trunk: forward, sideways.
    pub(super) lean: [Row; 2],
    /// Lean of the head against the neck, forward.
    pub(super) head_lean: Row,
    pub(super) sides: [Side; 2],
    /// Distance of the hands, and of the feet.
    pub(super) between_hands: Row,
    pub(super) between_feet: Row,
}

/// What one side of the body does.
#[derive(Debug, Clone, Default)]
pub(super) struct Side {
    /// Angles: knee and elbow bent, thigh forward, thigh outward.
    pub(super) knee: Row,
    pub(super) elbow: Row,
    pub(super) thigh_forward: Row,
    pub(super) thigh_outward: Row,
    /// Hand against its shoulder: up, forward, outward; elbow against it: up.
    pub(super) hand: [Row; 3],
    pub(super) elbow_up: Row,
    /// Ankle: height above floor, before the hips, outward; and the toe's height.
    pub(super) ankle: [Row; 3],
    pub(super) toe_up: Row,
    /// Speed of the hand against the hips; its velocity against the neck; speed of the foot over ground; rate of the knee.
    pub(super) hand_speed: Row,
    pub(super) hand_velocity: [Row; 3],
    pub(super) foot_speed: Row,
    pub(super) knee_rate: Row,
}

/// The joints of the left side.
const LEFT: [Joint; 7] = [
    Joint::LeftShoulder,
    Joint::LeftElbow,
    Joint::LeftWrist,
    Joint::LeftHip,
    Joint::LeftKnee,
    Joint::LeftAnkle,
    Joint::LeftToe,
];

impl Channels {
    /// The channels of a motion.
    #[must_use]
    pub fn new(motion: &Normalised) -> Self {
        let hip: Vec<DVec3> = (0..motion.joints.len()).map(|frame| motion.hip(frame)).collect();
        let joint = |joint: Joint| places(motion, joint);
        let (neck, head) = (joint(Joint::Neck), joint(Joint::Head));
        let trunk = difference(&neck, &hip);
        let skull = difference(&head, &neck);
        let velocity = [0, 1, 2].map(|axis| motion.velocity.iter().map(|v| v[axis]).collect::<Row>());
        Self {
            hip_height: hip.iter().map(|hip| hip.y / motion.leg).collect(),
            speed: motion.velocity.iter().map(|v| v.x.hypot(v.z)).collect(),
            velocity,
            yaw_rate: motion.yaw_rate.clone(),
            lean: [
                trunk.iter().map(|v| v.z.atan2(v.y)).collect(),
                trunk.iter().map(|v| v.x.atan2(v.y)).collect(),
            ],
            head_lean: skull.iter().map(|v| v.z.atan2(v.y)).collect(),
            between_hands: lengths(&difference(&joint(Joint::LeftWrist), &joint(Joint::RightWrist))),
            between_feet: lengths(&difference(&joint(Joint::LeftAnkle), &joint(Joint::RightAnkle))),
            sides: [
                side(motion, &hip, &neck, LEFT, 1.0),
                side(motion, &hip, &neck, LEFT.map(Joint::mirrored), -1.0),
            ],
        }
    }
}

/// What one side does; `outward` is the sign of its x.
fn side(motion: &Normalised, hips: &[DVec3], neck: &[DVec3], joints: [Joint; 7], outward: f64) -> Side {
    let [shoulder, elbow, wrist, hip, knee, ankle, toe] = joints.map(|joint| places(motion, joint));
    let knee_angle = bends(&hip, &knee, &ankle);
    let thigh = difference(&knee, &hip);
    let hand = difference(&wrist, &shoulder);
    let level = DVec3::new(1.0, 0.0, 1.0);
    let foot = difference(&ankle, &hips.iter().map(|&hip| hip * level).collect::<Vec<_>>());
    let foot_velocity = smoothing::derivative(&foot, RATE);
    let foot_velocity = foot_velocity.iter().zip(&motion.velocity).map(|(&foot, &root)| foot + root * level);
    let hand_velocity = smoothing::derivative(&difference(&wrist, neck), RATE);
    Side {
        knee_rate: smoothing::derivative(&knee_angle, RATE),
        knee: knee_angle,
        elbow: bends(&shoulder, &elbow, &wrist),
        thigh_forward: thigh.iter().map(|v| v.z.atan2(-v.y)).collect(),
        thigh_outward: thigh.iter().map(|v| v.x.abs().atan2(v.y.abs() + 1e-3)).collect(),
        hand: [
            hand.iter().map(|v| v.y).collect(),
            hand.iter().map(|v| v.z).collect(),
            hand.iter().map(|v| outward * v.x).collect(),
        ],
        elbow_up: difference(&elbow, &shoulder).iter().map(|v| v.y).collect(),
        ankle: [
            ankle.iter().map(|v| v.y).collect(),
            difference(&ankle, hips).iter().map(|v| v.z).collect(),
            difference(&ankle, hips).iter().map(|v| outward * v.x).collect(),
        ],
        toe_up: toe.iter().map(|v| v.y).collect(),
        hand_speed: lengths(&smoothing::derivative(&difference(&wrist, hips), RATE)),
        hand_velocity: [0, 1, 2].map(|axis| hand_velocity.iter().map(|v| v[axis]).collect()),
        foot_speed: foot_velocity.map(DVec3::length).collect(),
    }
}

fn places(motion: &Normalised, joint: Joint) -> Vec<DVec3> {
    motion.joints.iter().map(|joints| joints[joint as usize]).collect()
}

fn difference(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

fn lengths(vectors: &[DVec3]) -> Row {
    vectors.iter().map(|v| v.length()).collect()
}

/// The angles between two limbs that follow each other: 0 where they are straight.
fn bends(from: &[DVec3], joint: &[DVec3], to: &[DVec3]) -> Row {
    let angle = |a: DVec3, b: DVec3| {
        let lengths = a.length() * b.length();
        if lengths > 0.0 { (a.dot(b) / lengths).clamp(-1.0, 1.0).acos() } else { 0.0 }
    };
    (0..joint.len()).map(|i| angle(joint[i] - from[i], to[i] - joint[i])).collect()
}
