//! Joints over time, whoever has found them.

use glam::DVec3;
use thiserror::Error;

/// A joint that features are made of: all sources of motion have these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say what each is")]
pub enum Joint {
    Neck,
    Head,
    LeftShoulder,
    LeftElbow,
    LeftWrist,
    RightShoulder,
    RightElbow,
    RightWrist,
    LeftHip,
    LeftKnee,
    LeftAnkle,
    LeftToe,
    RightHip,
    RightKnee,
    RightAnkle,
    RightToe,
}

/// How many joints there are.
pub const JOINT_COUNT: usize = 16;

/// One joint's names: in BVH files with the names of the CMU recordings, where a node lies where its bone begins; and in Backlit's own tracks,
/// where a joint has the name of the limb that ends there.
type Names = (Joint, [&'static str; 2]);

const NAMES: [Names; JOINT_COUNT] = [
    (Joint::Neck, ["Neck", "chest"]),
    (Joint::Head, ["Head", "skull"]),
    (Joint::LeftShoulder, ["LeftArm", "left clavicle"]),
    (Joint::LeftElbow, ["LeftForeArm", "left upper arm"]),
    (Joint::LeftWrist, ["LeftHand", "left forearm"]),
    (Joint::RightShoulder, ["RightArm", "right clavicle"]),
    (Joint::RightElbow, ["RightForeArm", "right upper arm"]),
    (Joint::RightWrist, ["RightHand", "right forearm"]),
    (Joint::LeftHip, ["LeftUpLeg", "left hip"]),
    (Joint::LeftKnee, ["LeftLeg", "left lower thigh"]),
    (Joint::LeftAnkle, ["LeftFoot", "left lower calf"]),
    (Joint::LeftToe, ["LeftToeBase", "left foot"]),
    (Joint::RightHip, ["RightUpLeg", "right hip"]),
    (Joint::RightKnee, ["RightLeg", "right lower thigh"]),
    (Joint::RightAnkle, ["RightFoot", "right lower calf"]),
    (Joint::RightToe, ["RightToeBase", "right foot"]),
];

impl Joint {
    /// All of them, in the order of a frame's positions.
    pub const ALL: [Self; JOINT_COUNT] = {
        let mut all = [Self::Neck; JOINT_COUNT];
        let mut index = 0;
        while index < JOINT_COUNT {
            all[index] = NAMES[index].0;
            index += 1;
        }
        all
    };

    /// The same joint on the other side of the body.
    #[must_use]
    pub fn mirrored(self) -> Self {
        match self as usize {
            index @ 2..5 => Self::ALL[index + 3],
            index @ 5..8 => Self::ALL[index - 3],
            index @ 8..12 => Self::ALL[index + 4],
            index @ 12.. => Self::ALL[index - 4],
            _ => self,
        }
    }
}

/// Positions of all joints at one moment, in the order of [`Joint::ALL`].
pub type Joints = [DVec3; JOINT_COUNT];

/// Why joints are no motion that can be recognised.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum MotionError {
    #[error("there is no joint for {joint:?}; expected \"{}\" or \"{}\" among the joints", .names[0], .names[1])]
    MissingJoint { joint: Joint, names: [&'static str; 2] },
    #[error("{found} frames a second; expected between {least} and {most}")]
    FrameRate { found: f64, least: f64, most: f64 },
    #[error("{seconds:.2} s of motion; expected at least {least} s")]
    TooShort { seconds: f64, least: f64 },
    #[error("frames {first} to {last} are too many; expected at most {most}")]
    TooLong { first: usize, last: usize, most: usize },
    #[error("frame {frame}: {found} positions; expected {expected}, one a joint")]
    Positions { frame: usize, found: usize, expected: usize },
    #[error("frame {frame} is not after the one before it")]
    Order { frame: usize },
    #[error("frame {frame}: a position is not finite or beyond {most}")]
    NotFinite { frame: usize, most: f64 },
    #[error("up is {found}; expected three finite numbers, not all zero")]
    Up { found: DVec3 },
    #[error("the joints do not lie as those of a person: {what} is {found}; expected more than 0")]
    NoBody { what: &'static str, found: f64 },
}

/// Frames a second that make sense.
const RATES: [f64; 2] = [5.0, 1000.0];
/// Shortest motion, seconds.
pub const SHORTEST_S: f64 = 0.4;
/// Most frames of a motion.
pub const MAX_FRAMES: usize = 1_000_000;
/// Farthest coordinate, in any unit.
const MAX_COORDINATE: f64 = 1e9;

/// Joints over time: evenly spaced frames, y up, in any unit. Made by [`JointMotion::from_named`]; whatever one holds can be recognised.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMotion {
    /// Frames a second.
    pub(crate) frame_rate: f64,
    /// Number of the first frame.
    pub(crate) first_frame: usize,
    /// The frames, y up, in the unit that they came in.
    pub(crate) frames: Vec<Joints>,
}

impl JointMotion {
    /// Takes the joints that are needed from all that there are. `frames` are numbers and positions, a position a name; frames may be missing
    /// and are bridged straight. `up` points up in the positions' axes; their unit does not matter.
    ///
    /// # Errors
    /// A joint is missing, or numbers are no motion; see [`MotionError`].
    pub fn from_named<'a>(
        names: &[impl AsRef<str>],
        frame_rate: f64,
        up: DVec3,
        frames: impl IntoIterator<Item = (usize, &'a [DVec3])>,
    ) -> Result<Self, MotionError> {
        let [least, most] = RATES;
        if !(least..=most).contains(&frame_rate) {
            return Err(MotionError::FrameRate { found: frame_rate, least, most });
        }
        let turn = up.try_normalize().filter(|up| up.is_finite()).ok_or(MotionError::Up { found: up })?;
        let turn = glam::DQuat::from_rotation_arc(turn, DVec3::Y);
        let mut columns = [0; JOINT_COUNT];
        for (column, (joint, known)) in columns.iter_mut().zip(NAMES) {
            *column = names
                .iter()
                .position(|name| known.contains(&name.as_ref()))
                .ok_or(MotionError::MissingJoint { joint, names: known })?;
        }
        let mut bridged: Vec<Joints> = Vec::new();
        let mut ends: Option<(usize, usize)> = None;
        for (frame, positions) in frames {
            if positions.len() != names.len() {
                return Err(MotionError::Positions { frame, found: positions.len(), expected: names.len() });
            }
            let joints = columns.map(|column| turn * positions[column]);
            if joints.iter().any(|p| !p.is_finite() || p.abs().max_element() > MAX_COORDINATE) {
                return Err(MotionError::NotFinite { frame, most: MAX_COORDINATE });
            }
            let (first, last) = ends.unwrap_or((frame, frame));
            if frame < last || (frame == last && ends.is_some()) {
                return Err(MotionError::Order { frame });
            }
            if frame - first >= MAX_FRAMES {
                return Err(MotionError::TooLong { first, last: frame, most: MAX_FRAMES });
            }
            if let Some(before) = bridged.last().copied() {
                let gap = frame - last;
                for step in 1..gap {
                    bridged.push(between(&before, &joints, step as f64 / gap as f64));
                }
            }
            bridged.push(joints);
            ends = Some((first, frame));
        }
        Self::new(frame_rate, ends.map_or(0, |(first, _)| first), bridged)
    }

    /// Frames that lie evenly and are finite, y up.
    pub(crate) fn new(frame_rate: f64, first_frame: usize, frames: Vec<Joints>) -> Result<Self, MotionError> {
        let seconds = frames.len() as f64 / frame_rate;
        if seconds < SHORTEST_S {
            return Err(MotionError::TooShort { seconds, least: SHORTEST_S });
        }
        Ok(Self { frame_rate, first_frame, frames })
    }

    /// How long it is.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.frames.len() as f64 / self.frame_rate
    }

    /// The motion with every frame changed.
    pub(crate) fn map(&self, change: impl FnMut(&Joints) -> Joints) -> Self {
        Self { frames: self.frames.iter().map(change).collect(), ..*self }
    }

    /// The motion at another frame rate, positions going straight between frames.
    #[must_use]
    pub fn resampled(&self, frame_rate: f64) -> Self {
        if (self.frame_rate / frame_rate - 1.0).abs() < 1e-4 {
            return self.clone();
        }
        let last = self.frames.len() - 1;
        let count = ((last as f64 / self.frame_rate * frame_rate).floor() as usize) + 1;
        let frames = (0..count).map(|index| {
            let at = (index as f64 * self.frame_rate / frame_rate).min(last as f64);
            let from = (at as usize).min(last.saturating_sub(1));
            between(&self.frames[from], &self.frames[(from + 1).min(last)], at - from as f64)
        });
        Self { frame_rate, first_frame: self.first_frame, frames: frames.collect() }
    }
}

/// Positions on the way from one frame to another.
pub(crate) fn between(from: &Joints, to: &Joints, part: f64) -> Joints {
    std::array::from_fn(|joint| from[joint].lerp(to[joint], part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_in_the_order_of_their_numbers_and_mirror_twice_to_themselves() {
        for (index, joint) in Joint::ALL.into_iter().enumerate() {
            assert_eq!(joint as usize, index);
            assert_eq!(joint.mirrored().mirrored(), joint);
            let (a, b) = (format!("{joint:?}"), format!("{:?}", joint.mirrored()));
            assert_eq!(a.replace("Left", "Right"), b.replace("Left", "Right"));
            assert_eq!(a.contains("Left") || a.contains("Right"), a != b);
        }
    }

    fn named(frames: &[(usize, Vec<DVec3>)], rate: f64, up: DVec3) -> Result<JointMotion, MotionError> {
        let names: Vec<&str> = NAMES.iter().map(|(_, names)| names[1]).chain(["other"]).collect();
        JointMotion::from_named(&names, rate, up, frames.iter().map(|(number, all)| (*number, &all[..])))
    }

    #[test]
    fn gaps_are_bridged_and_up_becomes_y() {
        let frame = |number: usize| (number, vec![DVec3::new(1.0, 2.0, number as f64); 17]);
        let motion = named(&[frame(3), frame(4), frame(13)], 10.0, DVec3::Z).unwrap();
        assert_eq!((motion.frames.len(), motion.first_frame), (11, 3));
        assert!((motion.frames[6][0].y - 9.0).abs() < 1e-12, "{:?}", motion.frames[6][0]);
        assert!((motion.frames[6][0].x - 1.0).abs() < 1e-12);
        let faster = motion.resampled(30.0);
        assert_eq!(faster.frames.len(), 31);
        assert!((faster.frames[1][0].y - 3.0 - 1.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_motion_says_why() {
        let frame = |number: usize| (number, vec![DVec3::ONE; 17]);
        let message = |result: Result<JointMotion, MotionError>| result.unwrap_err().to_string();
        assert!(message(named(&[frame(1), frame(1)], 30.0, DVec3::Y)).contains("frame 1 is not after"));
        assert!(message(named(&[frame(0), frame(usize::MAX)], 30.0, DVec3::Y)).contains("at most 1000000"));
        assert!(message(named(&[frame(0)], 30.0, DVec3::Y)).contains("0.03 s of motion"));
        assert!(message(named(&[], 30.0, DVec3::Y)).contains("0.00 s"));
        assert!(message(named(&[frame(0)], f64::NAN, DVec3::Y)).contains("frames a second"));
        assert!(message(named(&[frame(0)], 30.0, DVec3::ZERO)).contains("up is"));
        assert!(message(named(&[(0, vec![DVec3::NAN; 17])], 30.0, DVec3::Y)).contains("not finite"));
        assert!(message(named(&[(0, vec![DVec3::ONE; 3])], 30.0, DVec3::Y)).contains("expected 17"));
        let some = JointMotion::from_named(&["Neck"], 30.0, DVec3::Y, []);
        assert!(some.unwrap_err().to_string().contains("Head; expected \"Head\" or \"skull\""));
    }
}
