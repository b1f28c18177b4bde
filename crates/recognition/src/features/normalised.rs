//! Joints apart from place, heading and size.
//!
//! With hips l, r and shoulders: the axis to the left is a = (l − r) + (shoulders' difference)/2, laid flat, smoothed and made a unit; forward is
//! f = a × up. A joint p becomes ((p − h)·a, `p_y` − floor, (p − h)·f)/size, with h the middle of the hips. The size is that of thigh, calf and trunk
//! together (medians over the motion) over [`BODY`], so that lengths are about metres of an adult. The floor lies [`TOE_HEIGHT`] below
//! where the lower toe is a tenth of the time.

use glam::DVec3;

use super::{RATE, smoothing};
use crate::joints::{JOINT_COUNT, Joint, JointMotion, Joints, MotionError};

/// Thigh, calf and trunk of a body of size one.
const BODY: f64 = 1.35;
/// Toe above floor, of a body of size one.
const TOE_HEIGHT: f64 = 0.03;
/// Deviation of the smoothing of positions, seconds: white noise of a tracker goes, steps and punches stay.
const SMOOTHING_S: f64 = 2.0 / 30.0;

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

/// A motion in the body's own frame: x to the left, y up from the floor, z forward, at [`RATE`] frames a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Normalised {
    /// Joints; the middle of the hips has x = z = 0.
    pub joints: Vec<Joints>,
    /// Velocity of the middle of the hips, sizes a second.
    pub velocity: Vec<DVec3>,
    /// Rate of turning about the vertical, radians a second.
    pub yaw_rate: Vec<f64>,
    /// Length of a leg.
    pub leg: f64,
}

/// The middle one of some numbers; the mean of the middle two where there are two.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    percentile_of_sorted(&values, 0.5)
}

/// The number below which such a part of sorted numbers lies, straight between neighbours; 0 of none.
pub(super) fn percentile_of_sorted(sorted: &[f64], part: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let at = part * last as f64;
    let below = at as usize;
    let above = (below + 1).min(last);
    sorted[below] + (at - below as f64) * (sorted[above] - sorted[below])
}

impl Normalised {
    /// Smooths, resamples and normalises a motion.
    ///
    /// # Errors
    /// The joints do not lie as a person's.
    pub fn new(motion: &JointMotion) -> Result<Self, MotionError> {
        let deviation = SMOOTHING_S * motion.frame_rate;
        let mut smooth = motion.clone();
        if deviation > 0.3 {
            let of = |joint: usize| motion.frames.iter().map(move |frame| frame[joint]);
            let columns: Vec<Vec<DVec3>> = (0..JOINT_COUNT)
                .map(|joint| smoothing::gaussian(&of(joint).collect::<Vec<_>>(), deviation))
                .collect();
            let mut index = 0;
            smooth = motion.map(|_| {
                index += 1;
                std::array::from_fn(|joint| columns[joint][index - 1])
            });
        }
        Self::of_smooth(&smooth.resampled(RATE).frames)
    }

    fn of_smooth(frames: &[Joints]) -> Result<Self, MotionError> {
        let (leg, trunk) = leg_and_trunk(frames);
        let size = (leg + trunk) / BODY;
        for (what, found) in [("the leg", leg), ("the trunk", trunk)] {
            if !(found.is_finite() && found > 1e-9 && found > 0.05 * size) {
                return Err(MotionError::NoBody { what, found });
            }
        }
        let hips: Vec<DVec3> = frames.iter().map(|p| middle_of_hips(p) / size).collect();
        let left = left_axes(frames);
        let toe = |p: &Joints| p[Joint::LeftToe as usize].y.min(p[Joint::RightToe as usize].y) / size;
        let mut toes: Vec<f64> = frames.iter().map(toe).collect();
        toes.sort_by(f64::total_cmp);
        let floor = percentile_of_sorted(&toes, 0.1) - TOE_HEIGHT;
        let turned = |left: DVec3, v: DVec3| DVec3::new(left.dot(v), v.y, left.cross(DVec3::Y).dot(v));
        let joints = frames.iter().zip(&hips).zip(&left).map(|((p, &hip), &left)| {
            p.map(|place| turned(left, place / size - DVec3::new(hip.x, floor, hip.z)))
        });
        let velocity = smoothing::derivative(&hips, RATE);
        let velocity = velocity.iter().zip(&left).map(|(&v, &left)| turned(left, v));
        Ok(Self {
            joints: joints.collect(),
            velocity: velocity.collect(),
            yaw_rate: yaw_rates(&left),
            leg: leg / size,
        })
    }

    /// The middle of the hips of a frame.
    #[must_use]
    pub fn hip(&self, frame: usize) -> DVec3 {
        middle_of_hips(&self.joints[frame])
    }

    /// Every frame as [`FRAME_FEATURES`] numbers, for principal components: joints relative to the hips, velocities of the ends of
    /// limbs, the root's own height, velocity and turning. Units are sizes of the body (about metres) and seconds, brought to
    /// like weight by fixed factors and not by their spread, so that what hardly moves stays small.
    #[must_use]
    pub fn frame_features(&self) -> Vec<Vec<f64>> {
        let count = self.joints.len();
        let relative = |joint: Joint| -> Vec<DVec3> {
            (0..count).map(|frame| self.joints[frame][joint as usize] - self.hip(frame)).collect()
        };
        let velocities = MOVING.map(|joint| smoothing::derivative(&relative(joint), RATE));
        let features = |frame: usize| {
            let hip = self.hip(frame);
            let places = self.joints[frame].iter().map(|&place| place - hip);
            let moving = velocities.iter().map(|velocity| VELOCITY_S * velocity[frame]);
            let root = ROOT_VELOCITY_S * self.velocity[frame];
            let mut all: Vec<f64> = places.chain(moving).chain([root]).flat_map(|v| v.to_array()).collect();
            all.extend([YAW_S * self.yaw_rate[frame], hip.y / self.leg]);
            all
        };
        (0..count).map(features).collect()
    }
}

/// Lengths of leg and trunk, medians over all frames.
fn leg_and_trunk(frames: &[Joints]) -> (f64, f64) {
    let all = |of: &dyn Fn(&Joints) -> f64| median(frames.iter().map(of).collect());
    let distance = |a: Joint, b: Joint| all(&|p| p[a as usize].distance(p[b as usize]));
    let leg = 0.5
        * (distance(Joint::LeftHip, Joint::LeftKnee)
            + distance(Joint::LeftKnee, Joint::LeftAnkle)
            + distance(Joint::RightHip, Joint::RightKnee)
            + distance(Joint::RightKnee, Joint::RightAnkle));
    (leg, all(&|p| p[Joint::Neck as usize].distance(middle_of_hips(p))))
}

/// The size of a body, in the motion's unit: about a metre of an adult.
#[must_use]
pub fn body_size(motion: &JointMotion) -> f64 {
    let (leg, trunk) = leg_and_trunk(&motion.frames);
    (leg + trunk) / BODY
}

fn middle_of_hips(p: &Joints) -> DVec3 {
    p[Joint::LeftHip as usize].midpoint(p[Joint::RightHip as usize])
}

/// Unit vectors to the body's left, level.
fn left_axes(frames: &[Joints]) -> Vec<DVec3> {
    let across = |p: &Joints| {
        let hips = p[Joint::LeftHip as usize] - p[Joint::RightHip as usize];
        let shoulders = p[Joint::LeftShoulder as usize] - p[Joint::RightShoulder as usize];
        (hips + 0.5 * shoulders) * DVec3::new(1.0, 0.0, 1.0)
    };
    let across: Vec<DVec3> = frames.iter().map(across).collect();
    let mut before = DVec3::X;
    smoothing::gaussian(&across, 2.0)
        .into_iter()
        .map(|axis| {
            before = axis.try_normalize().unwrap_or(before);
            before
        })
        .collect()
}

/// Rates of turning of level unit vectors.
fn yaw_rates(left: &[DVec3]) -> Vec<f64> {
    let mut yaw = Vec::with_capacity(left.len());
    let mut before = 0.0;
    for axis in left {
        let angle = (-axis.z).atan2(axis.x);
        let turns = (angle - before) / std::f64::consts::TAU;
        before = angle - turns.round() * std::f64::consts::TAU;
        yaw.push(before);
    }
    smoothing::derivative(&yaw, RATE)
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::tests::walker;

    #[test]
    fn place_heading_and_size_change_nothing() {
        let motion = walker(2.0, 1.2);
        let plain = Normalised::new(&motion).unwrap();
        let turn = DQuat::from_rotation_y(2.3);
        let moved = motion.map(|p| p.map(|p| 17.0 * (turn * p) + DVec3::new(5.0, -3.0, 2.0)));
        let other = Normalised::new(&moved).unwrap();
        for frame in 0..plain.joints.len() {
            for joint in 0..16 {
                let far = plain.joints[frame][joint].distance(other.joints[frame][joint]);
                assert!(far < 1e-9, "frame {frame} joint {joint}: {far}");
            }
            assert!(plain.velocity[frame].distance(other.velocity[frame]) < 1e-9);
            assert!((plain.yaw_rate[frame] - other.yaw_rate[frame]).abs() < 1e-9);
        }
        let forward = plain.velocity[30].z * 0.9 / plain.leg;
        assert!((forward - 1.2).abs() < 0.3, "walks forward at {forward}");
        let flat = motion.map(|_| [DVec3::ONE; 16]);
        assert!(matches!(Normalised::new(&flat), Err(MotionError::NoBody { .. })));
    }

    #[test]
    fn a_turn_has_its_rate_and_sign() {
        let still = walker(2.0, 0.0);
        let mut angle = 0.0;
        let turning = still.map(|p| {
            angle += 0.1;
            p.map(|p| DQuat::from_rotation_y(angle) * p)
        });
        let found = Normalised::new(&turning).unwrap();
        assert!((found.yaw_rate[30] - 0.1 * RATE).abs() < 0.05, "{}", found.yaw_rate[30]);
    }
}
