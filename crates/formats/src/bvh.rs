//! Biovision hierarchy (BVH): motion of a skeleton, as archives of motion capture give it.
//!
//! A joint's place is its parent's, plus its offset (or, where it has position channels, these) turned as the parent is; its turn is its parent's
//! times its rotation channels' in their order, degrees. Ends of limbs (`End Site`) are joints without channels. Unit and up axis
//! are the file's own.

mod points;

use std::path::Path;

use glam::{DQuat, DVec3};

use crate::text::{self, Words};
use crate::{DiskFiles, FileError, FileProblem, MAX_TEXT_BYTES, Result, TakeFiles};

/// Most joints of a skeleton.
const MAX_JOINTS: usize = 4096;
/// Numbers beyond this are no places and no angles.
const LARGEST: f64 = 1e9;
/// Frames longer or shorter than this, seconds, are no motion.
const FRAME_SECONDS: std::ops::RangeInclusive<f64> = 1e-5..=1e3;

/// One number of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Channel {
    /// Along x, y or z: 0, 1, 2.
    Position(usize),
    /// About x, y or z.
    Rotation(usize),
}

impl Channel {
    fn parse(word: &str) -> Option<Self> {
        let word = word.to_ascii_lowercase();
        let axis = |rest: &str| ["x", "y", "z"].iter().position(|axis| *axis == rest);
        match (word.strip_suffix("position"), word.strip_suffix("rotation")) {
            (Some(rest), _) => axis(rest).map(Self::Position),
            (_, Some(rest)) => axis(rest).map(Self::Rotation),
            _ => None,
        }
    }
}

/// One joint.
#[derive(Debug, Clone, PartialEq)]
pub struct BvhJoint {
    /// Its name in the file; of an end of a limb the last joint's, with " end".
    pub name: String,
    /// Index of the joint it hangs on; `None` for a root.
    pub parent: Option<usize>,
    /// From there, at rest.
    pub offset: DVec3,
    channels: Vec<Channel>,
}

/// A motion of a skeleton.
#[derive(Debug, Clone, PartialEq)]
pub struct BvhMotion {
    /// Parents before children.
    joints: Vec<BvhJoint>,
    /// Seconds from frame to frame.
    pub frame_seconds: f64,
    channels: usize,
    /// Frame after frame, `channels` each.
    values: Vec<f64>,
}

impl BvhMotion {
    /// The joints, parents before children.
    #[must_use]
    pub fn joints(&self) -> &[BvhJoint] {
        &self.joints
    }

    /// How many frames there are.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.values.len().checked_div(self.channels).unwrap_or(0)
    }

    /// Places and turns of all joints in a frame, in the file's unit and axes; at rest where there is no such frame.
    #[must_use]
    pub fn joints_at(&self, frame: usize) -> Vec<(DVec3, DQuat)> {
        let first = frame.saturating_mul(self.channels);
        let mut values = self.values.get(first..first + self.channels).unwrap_or_default().iter();
        let mut placed: Vec<(DVec3, DQuat)> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let has_position = joint.channels.iter().any(|channel| matches!(channel, Channel::Position(_)));
            let mut offset = if has_position { DVec3::ZERO } else { joint.offset };
            let mut turn = DQuat::IDENTITY;
            for channel in &joint.channels {
                let value = values.next().copied().unwrap_or(0.0);
                match *channel {
                    Channel::Position(axis) => offset[axis] = value,
                    Channel::Rotation(axis) => {
                        turn *= DQuat::from_axis_angle(DVec3::AXES[axis], value.to_radians());
                    }
                }
            }
            let (from, by) = joint.parent.map_or((DVec3::ZERO, DQuat::IDENTITY), |parent| placed[parent]);
            placed.push((from + by * offset, (by * turn).normalize()));
        }
        placed
    }
}

/// Reads a motion from the disk.
pub fn read(path: &Path) -> Result<BvhMotion> {
    parse(path, &DiskFiles.read(path, MAX_TEXT_BYTES)?)
}

/// Parses the content of a BVH file; `path` is for the error's message.
///
/// # Errors
/// Not such a file, more than 4096 joints, a word that is not a number up to 10⁹, or frames that do not have as many numbers as
/// there are channels. The error names the line.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<BvhMotion> {
    let mut words = BvhWords { path, words: Words::new(text::decode(path, bytes)?, char::is_whitespace) };
    words.expect("HIERARCHY")?;
    let (joints, after) = hierarchy(&mut words)?;
    if after != "MOTION" {
        return Err(words.wrong("HIERARCHY", after, "ROOT or MOTION"));
    }
    words.expect("Frames:")?;
    let text = words.next("Frames:")?;
    let frames: usize = text.parse().map_err(|_error| words.wrong("Frames:", text, "a number of frames"))?;
    words.expect("Frame")?;
    words.expect("Time:")?;
    let frame_seconds = words.number("Frame Time:")?;
    if !FRAME_SECONDS.contains(&frame_seconds) {
        return Err(words.wrong("Frame Time:", &frame_seconds.to_string(), "seconds from 0.00001 to 1000"));
    }
    let channels: usize = joints.iter().map(|joint| joint.channels.len()).sum();
    if channels == 0 && frames > 0 {
        return Err(words.wrong("CHANNELS", "missing", "at least one channel"));
    }
    // No more is kept than the file has, whatever it claims.
    let mut values = Vec::new();
    for _ in 0..frames.saturating_mul(channels) {
        values.push(words.number("MOTION")?);
    }
    match words.words.after() {
        Some(word) => {
            Err(words.wrong("MOTION", word, &format!("no more than {frames} frames of {channels} numbers")))
        }
        None => Ok(BvhMotion { joints, frame_seconds, channels, values }),
    }
}

/// The joints of all roots, and the word after them.
fn hierarchy<'a>(words: &mut BvhWords<'a>) -> Result<(Vec<BvhJoint>, &'a str)> {
    let mut joints: Vec<BvhJoint> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    loop {
        let word = words.next("HIERARCHY")?;
        let name = match (word, open.last()) {
            ("ROOT", None) | ("JOINT", Some(_)) => words.rest_of_line("a joint's name")?,
            ("End", Some(&parent)) => {
                words.expect("Site")?;
                format!("{} end", joints[parent].name)
            }
            ("OFFSET", Some(&joint)) => {
                for axis in 0..3 {
                    joints[joint].offset[axis] = words.number("OFFSET")?;
                }
                continue;
            }
            ("CHANNELS", Some(&joint)) => {
                joints[joint].channels = channels(words)?;
                continue;
            }
            ("}", Some(_)) => {
                open.pop();
                continue;
            }
            (_, Some(_)) => {
                return Err(words.wrong("HIERARCHY", word, "JOINT, End Site, OFFSET, CHANNELS or }"));
            }
            (_, None) if joints.is_empty() => return Err(words.wrong("HIERARCHY", word, "ROOT")),
            (_, None) => return Ok((joints, word)),
        };
        if joints.len() == MAX_JOINTS {
            return Err(words.wrong("HIERARCHY", "more", &format!("at most {MAX_JOINTS} joints")));
        }
        words.expect("{")?;
        let parent = open.last().copied();
        open.push(joints.len());
        joints.push(BvhJoint { name, parent, offset: DVec3::ZERO, channels: Vec::new() });
    }
}

fn channels(words: &mut BvhWords<'_>) -> Result<Vec<Channel>> {
    const EXPECTED: &str = "0 to 6";
    let text = words.next("CHANNELS")?;
    let count = text.parse().ok().filter(|count| *count <= 6_usize);
    let count = count.ok_or_else(|| words.wrong("CHANNELS", text, EXPECTED))?;
    let mut channels = Vec::with_capacity(count);
    for _ in 0..count {
        let word = words.next("CHANNELS")?;
        let channel = Channel::parse(word);
        channels.push(channel.ok_or_else(|| words.wrong("CHANNELS", word, "Xposition to Zrotation"))?);
    }
    Ok(channels)
}

/// The words of a file and its path.
struct BvhWords<'a> {
    path: &'a Path,
    words: Words<'a>,
}

impl<'a> BvhWords<'a> {
    fn next(&mut self, field: &str) -> Result<&'a str> {
        self.words.after().ok_or_else(|| self.wrong(field, "missing", "more: the text ends too early"))
    }

    fn expect(&mut self, wanted: &str) -> Result<()> {
        let word = self.next(wanted)?;
        if word == wanted { Ok(()) } else { Err(self.wrong(wanted, word, &format!("\"{wanted}\""))) }
    }

    fn number(&mut self, field: &str) -> Result<f64> {
        let word = self.next(field)?;
        let number = word.parse::<f64>().ok().filter(|number| number.abs() <= LARGEST);
        number.ok_or_else(|| self.wrong(field, word, "a number, none beyond 1e9"))
    }

    fn rest_of_line(&mut self, what: &str) -> Result<String> {
        let rest = self.words.left.trim();
        // Some writers put the bracket behind the name.
        let (name, left) = match rest.strip_suffix('{') {
            Some(name) => (name.trim_end(), "{"),
            None => (rest, ""),
        };
        self.words.left = left;
        if name.is_empty() { Err(self.wrong("JOINT", "missing", what)) } else { Ok(name.to_owned()) }
    }

    fn wrong(&self, field: &str, found: &str, expected: &str) -> FileError {
        FileProblem::field(field, found, expected).at(self.path, self.words.line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    const SMALL: &str = "HIERARCHY\nROOT Hips\n{\n OFFSET 0 1 0\n CHANNELS 6 Xposition Yposition Zposition \
        Zrotation Xrotation Yrotation\n JOINT Left Leg {\n OFFSET 2 0 0\n CHANNELS 1 Yrotation\n End Site\n {\n OFFSET 0 0 3\n }\n }\n}\n\
        MOTION\nFrames: 2\nFrame Time: 0.04\n0 0 0 0 0 0 0\n1 2 3 90 0 0 90\n";

    #[test]
    fn joints_stand_where_their_channels_put_them() {
        let motion = parse(Path::new("a.bvh"), SMALL.as_bytes()).unwrap();
        assert_eq!((motion.frame_count(), motion.frame_seconds, motion.joints().len()), (2, 0.04, 3));
        assert_eq!(
            (motion.joints()[1].name.as_str(), motion.joints()[2].name.as_str()),
            ("Left Leg", "Left Leg end")
        );
        let places = |frame| -> Vec<DVec3> { motion.joints_at(frame).iter().map(|one| one.0).collect() };
        assert_eq!(places(0), [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 3.0)]);
        // 90° about z, then the leg's own 90° about y: its z is the root's x, which points along y.
        let expected = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 4.0, 3.0), DVec3::new(1.0, 7.0, 3.0)];
        for (found, expected) in places(1).iter().zip(expected) {
            assert!(found.distance(expected) < 1e-12, "{found} for {expected}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        let read = |text: &str| parse(Path::new("a.bvh"), text.as_bytes());
        assert_refused(
            SMALL,
            read,
            r#"
            HIERARCHY ⇒ HIERARCHIE ⇒ line 1: `HIERARCHY` is HIERARCHIE
            0 1 0 ⇒ 0 one 0 ⇒ line 4: `OFFSET` is one; expected a number
            0 1 0 ⇒ 0 NaN 0 ⇒ line 4: `OFFSET` is NaN
            6 Xposition ⇒ 7 Xposition ⇒ line 5: `CHANNELS` is 7
            Yrotation\n JOINT ⇒ Wrotation\n JOINT ⇒ line 5: `CHANNELS` is Wrotation
            JOINT Left Leg ⇒ JOINT ⇒ line 6: `JOINT` is missing
            }\n}\nMOTION ⇒ }\nMOTION ⇒ `HIERARCHY` is MOTION; expected JOINT
            Frames: 2 ⇒ Frames: -2 ⇒ line 16: `Frames:` is -2
            Frames: 2 ⇒ Frames: 99999999999 ⇒ line 19: `MOTION` is missing
            Frames: 2 ⇒ Frames: 1 ⇒ line 19: `MOTION` is 1; expected no more than 1 frames of 7
            0.04 ⇒ 0 ⇒ line 17: `Frame Time:` is 0
            0.04 ⇒ 1e10 ⇒ line 17: `Frame Time:` is 1e10
            "#,
        );
        for end in 0..SMALL.len() - 2 {
            assert!(read(&SMALL[..end]).is_err(), "{end}");
        }
    }
}
