//! Biovision hierarchy, read: a tree of joints with offsets and channels, then a line of numbers a frame.
//!
//! A joint's place is its parent's, plus its offset (or, where it has position channels, these) turned as the parent is; its rotation is the
//! parent's times those of its channels in their order. Angles are degrees.

use std::path::Path;

use glam::{DMat3, DVec3};

use super::MAX_FRAMES;
use super::joints::JointTrack;
use crate::text::decode;
use crate::{FileError, FileProblem};

/// Most joints of a file.
const MAX_JOINTS: usize = 2000;
/// Most positions that a file is read to: 400 MB.
const MAX_POSITIONS: usize = 1 << 24;
/// Longest offset or position.
const MAX_NUMBER: f64 = 1e9;

#[derive(Debug)]
struct Node {
    name: String,
    parent: Option<usize>,
    offset: DVec3,
    channels: Vec<Channel>,
}

#[derive(Debug, Clone, Copy)]
enum Channel {
    Position(usize),
    Rotation(usize),
}

/// The words of a text one after the other, and the line of each.
struct Words<'a> {
    path: &'a Path,
    words: Vec<(usize, &'a str)>,
    next: usize,
}

impl<'a> Words<'a> {
    fn fail(&self, at: usize, field: &str, found: &str, expected: &str) -> FileError {
        let line = self.words.get(at).or(self.words.last()).map_or(1, |(line, _)| *line);
        let problem = FileProblem::Field {
            field: field.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
        };
        FileError::new(self.path, problem).at_line(Some(line))
    }

    fn peek(&self) -> &'a str {
        self.words.get(self.next).map_or("missing", |(_, word)| word)
    }

    fn take(&mut self) -> &'a str {
        let word = self.peek();
        self.next += 1;
        word
    }

    fn expect(&mut self, field: &str, expected: &str) -> Result<(), FileError> {
        let found = self.take();
        if found.eq_ignore_ascii_case(expected) {
            Ok(())
        } else {
            Err(self.fail(self.next - 1, field, found, &format!("\"{expected}\"")))
        }
    }

    fn number(&mut self, field: &str) -> Result<f64, FileError> {
        let word = self.take();
        match word.parse::<f64>() {
            Ok(number) if number.abs() <= MAX_NUMBER => Ok(number),
            _ => Err(self.fail(self.next - 1, field, word, "a number that is not beyond 1e9")),
        }
    }

    fn count(&mut self, field: &str, most: usize) -> Result<usize, FileError> {
        let word = self.take();
        match word.parse::<usize>() {
            Ok(count) if count <= most => Ok(count),
            _ => Err(self.fail(self.next - 1, field, word, &format!("a whole number of at most {most}"))),
        }
    }
}

/// Reads the whole file.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<JointTrack, FileError> {
    let text = decode(path, bytes)?;
    let words = text
        .lines()
        .zip(1..)
        .flat_map(|(line, number)| line.split_whitespace().map(move |word| (number, word)));
    let mut words = Words { path, words: words.collect(), next: 0 };
    let nodes = hierarchy(&mut words)?;
    words.expect("after the hierarchy", "MOTION")?;
    words.expect("MOTION", "Frames:")?;
    let most = MAX_FRAMES.min(MAX_POSITIONS / nodes.len().max(1));
    let count = words.count("Frames", most)?;
    words.expect("MOTION", "Frame")?;
    words.expect("MOTION", "Time:")?;
    let at = words.next;
    let seconds = words.number("Frame Time")?;
    if !(1e-6..=1e3).contains(&seconds) {
        return Err(words.fail(at, "Frame Time", &seconds.to_string(), "seconds, more than none"));
    }
    let channels: usize = nodes.iter().map(|node| node.channels.len()).sum();
    let left = words.words.len() - words.next;
    if left != count * channels {
        let found = format!("{left} numbers");
        let expected = format!("{} numbers, {channels} in each of {count} frames", count * channels);
        let end = words.words.len();
        return Err(words.fail(end, "MOTION", &found, &expected));
    }
    let mut frames = Vec::with_capacity(count);
    for frame in 0..count {
        frames.push((frame, positions(&nodes, &mut words, frame)?));
    }
    Ok(JointTrack {
        joints: nodes.into_iter().map(|node| node.name).collect(),
        frame_rate: 1.0 / seconds,
        frames,
        up: Some(DVec3::Y),
    })
}

fn hierarchy(words: &mut Words<'_>) -> Result<Vec<Node>, FileError> {
    words.expect("the file's first word", "HIERARCHY")?;
    let mut nodes: Vec<Node> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    loop {
        let at = words.next;
        match words.take() {
            "ROOT" if nodes.is_empty() => open.push(node(words, &mut nodes, None)?),
            "JOINT" if !open.is_empty() => {
                let parent = open.last().copied();
                open.push(node(words, &mut nodes, parent)?);
            }
            "End" if !open.is_empty() => {
                words.expect("End", "Site")?;
                words.expect("End Site", "{")?;
                offset(words)?;
                words.expect("End Site", "}")?;
            }
            "}" if !open.is_empty() => {
                open.pop();
                if open.is_empty() {
                    return Ok(nodes);
                }
            }
            found => {
                let expected = if nodes.is_empty() { "\"ROOT\"" } else { "\"JOINT\", \"End\" or \"}\"" };
                return Err(words.fail(at, "HIERARCHY", found, expected));
            }
        }
    }
}

/// A joint's name, offset and channels.
fn node(words: &mut Words<'_>, nodes: &mut Vec<Node>, parent: Option<usize>) -> Result<usize, FileError> {
    let at = words.next;
    if nodes.len() == MAX_JOINTS {
        return Err(words.fail(at, "JOINT", "one more", &format!("at most {MAX_JOINTS} joints")));
    }
    let mut name = words.take().to_owned();
    while words.peek() != "{" && words.next < words.words.len() && words.next < at + 8 {
        name = format!("{name} {}", words.take());
    }
    if nodes.iter().any(|node| node.name == name) {
        let problem = FileProblem::Duplicate { field: name };
        return Err(FileError::new(words.path, problem).at_line(words.words.get(at).map(|word| word.0)));
    }
    words.expect(&name, "{")?;
    let offset = offset(words)?;
    words.expect(&name, "CHANNELS")?;
    let count = words.count("CHANNELS", 6)?;
    let mut channels = Vec::with_capacity(count);
    for _ in 0..count {
        let word = words.take();
        let channel = match word.split_at_checked(1) {
            Some((axis, "position")) => axis_of(axis).map(Channel::Position),
            Some((axis, "rotation")) => axis_of(axis).map(Channel::Rotation),
            _ => None,
        };
        let expected = "Xposition, Yposition, Zposition, Xrotation, Yrotation or Zrotation";
        channels.push(channel.ok_or_else(|| words.fail(words.next - 1, "CHANNELS", word, expected))?);
    }
    nodes.push(Node { name, parent, offset, channels });
    Ok(nodes.len() - 1)
}

/// X, Y or Z as 0, 1 or 2.
fn axis_of(letter: &str) -> Option<usize> {
    ["X", "Y", "Z"].iter().position(|axis| *axis == letter)
}

fn offset(words: &mut Words<'_>) -> Result<DVec3, FileError> {
    words.expect("OFFSET", "OFFSET")?;
    Ok(DVec3::new(words.number("OFFSET")?, words.number("OFFSET")?, words.number("OFFSET")?))
}

/// Places of all joints in the next frame.
fn positions(nodes: &[Node], words: &mut Words<'_>, frame: usize) -> Result<Vec<DVec3>, FileError> {
    let mut places: Vec<DVec3> = Vec::with_capacity(nodes.len());
    let mut turns: Vec<DMat3> = Vec::with_capacity(nodes.len());
    for node in nodes {
        let (mut offset, mut has_position) = (node.offset, false);
        let mut turn = DMat3::IDENTITY;
        for channel in &node.channels {
            let number = words.number(&format!("frame {frame}, {}", node.name))?;
            match *channel {
                Channel::Position(axis) => {
                    if !has_position {
                        offset = DVec3::ZERO;
                        has_position = true;
                    }
                    offset[axis] = number;
                }
                Channel::Rotation(axis) => {
                    let about =
                        [DMat3::from_rotation_x, DMat3::from_rotation_y, DMat3::from_rotation_z][axis];
                    turn *= about(number.to_radians());
                }
            }
        }
        let (place, before) = match node.parent {
            Some(parent) => (places[parent] + turns[parent] * offset, turns[parent]),
            None => (offset, DMat3::IDENTITY),
        };
        places.push(place);
        turns.push(before * turn);
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "HIERARCHY\nROOT Hips\n{\n OFFSET 9 9 9\n CHANNELS 6 Xposition Yposition Zposition Zrotation \
        Yrotation Xrotation\n JOINT Upper leg\n {\n  OFFSET 0 -2 0\n  CHANNELS 3 Zrotation Yrotation Xrotation\n  End Site\n  {\n   \
        OFFSET 0 -1 0\n  }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.04\n1 2 3 0 0 0 0 0 0\n1 2 3 90 0 0 0 0 0\n";

    #[test]
    fn a_small_file_has_its_places() {
        let track = parse(Path::new("a.bvh"), SMALL.as_bytes()).unwrap();
        assert_eq!(track.joints, ["Hips", "Upper leg"]);
        assert!((track.frame_rate - 25.0).abs() < 1e-9);
        assert_eq!(track.frames[0].1, [DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 0.0, 3.0)]);
        assert!(track.frames[1].1[1].distance(DVec3::new(3.0, 2.0, 3.0)) < 1e-12);
    }

    #[test]
    fn broken_files_say_where() {
        for cut in (0..SMALL.len() - 2).step_by(3) {
            let message = parse(Path::new("a.bvh"), &SMALL.as_bytes()[..cut]).unwrap_err().to_string();
            assert!(message.starts_with("a.bvh, line "), "{cut}: {message}");
        }
        for (from, to, expected) in [
            ("OFFSET 0 -2 0", "OFFSET 0 x 0", "line 8: `OFFSET` is x"),
            ("Frames: 2", "Frames: 99999999999", "line 17: `Frames` is 99999999999"),
            ("Frames: 2", "Frames: 3", "27 numbers, 9 in each of 3 frames"),
            ("0.04", "-1", "`Frame Time` is -1"),
            ("Xposition", "Wposition", "`CHANNELS` is Wposition"),
            ("Upper leg", "Hips", "`Hips` is given twice"),
            ("90 0 0 0 0 0", "90 0 NaN 0 0 0", "frame 1, Hips` is NaN"),
        ] {
            let changed = SMALL.replace(from, to);
            assert_ne!(changed, SMALL, "{from}");
            let message = parse(Path::new("a.bvh"), changed.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(expected), "{from}: {message}");
        }
    }
}
