//! The joints of a person among those of a skeleton, by name.

use std::path::Path;

use backlit_tracking::prior::{BodyPoints, Clip};
use glam::DVec3;

use super::BvhMotion;
use crate::{FileError, FileProblem, Result};

/// Names of joints without their side, the first that a file has: those of the CMU database's conversions, of Mixamo, and of
/// the two that Backlit writes.
const WAIST: [&str; 4] = ["spine", "chest", "torso", "abdomen"];
const NECK: [&str; 3] = ["neck", "lowerneck", "head"];
const HIP: [&str; 4] = ["upleg", "hip", "thigh", "femur"];
const KNEE: [&str; 5] = ["leg", "knee", "calf", "lowleg", "tibia"];
const ANKLE: [&str; 3] = ["foot", "ankle", "calcn"];
const TOE: [&str; 5] = ["toebase", "toe", "toeend", "footend", "ankleend"];
const SHOULDER: [&str; 4] = ["arm", "shoulder", "upperarm", "humerus"];
const ELBOW: [&str; 4] = ["forearm", "elbow", "lowerarm", "ulna"];
const WRIST: [&str; 4] = ["hand", "wrist", "forearmend", "elbowend"];

/// Where a person's joints stand in a skeleton's list.
struct JointIndices {
    waist: usize,
    neck: usize,
    hips: [usize; 2],
    knees: [usize; 2],
    ankles: [usize; 2],
    toes: [usize; 2],
    shoulders: [usize; 2],
    elbows: [usize; 2],
    wrists: [usize; 2],
}

impl BvhMotion {
    /// The motion of a person's joints. `path` is for the error's message.
    pub fn body_points(&self, path: &Path) -> Result<Clip> {
        let places = JointIndices::of(self).map_err(|problem| FileError::new(path, problem))?;
        let at = |frame: usize| {
            let joints = self.joints_at(frame);
            let one = |index: usize| joints[index].0;
            let pair = |[right, left]: [usize; 2]| -> [DVec3; 2] { [one(right), one(left)] };
            BodyPoints {
                hips: pair(places.hips),
                waist: one(places.waist),
                neck: one(places.neck),
                shoulders: pair(places.shoulders),
                elbows: pair(places.elbows),
                wrists: pair(places.wrists),
                knees: pair(places.knees),
                ankles: pair(places.ankles),
                toes: pair(places.toes),
            }
        };
        let frames = (0..self.frame_count()).map(at).collect();
        Ok(Clip { frame_seconds: self.frame_seconds, frames })
    }
}

impl JointIndices {
    fn of(motion: &BvhMotion) -> Result<Self, FileProblem> {
        let names: Vec<String> = motion.joints().iter().map(|joint| plain(&joint.name)).collect();
        let find = |what: &str, words: &[&str], side: &str| {
            // A root is the middle of the hips, whatever it is called.
            let is_root = |index: usize| motion.joints()[index].parent.is_none();
            let sided = |word: &&str| {
                names.iter().enumerate().position(|(index, name)| match side {
                    "" => name == word && !is_root(index),
                    _ => is_sided(name, word, side),
                })
            };
            let space = if side.is_empty() { "" } else { " " };
            words.iter().find_map(sided).ok_or_else(|| {
                let expected = format!("a joint for the {side}{space}{what}: {}", words.join(", "));
                FileProblem::field("HIERARCHY", "without it", expected)
            })
        };
        let pair = |what: &str, words: &[&str]| Ok([find(what, words, "right")?, find(what, words, "left")?]);
        Ok(Self {
            waist: find("waist", &WAIST, "")?,
            neck: find("neck", &NECK, "")?,
            hips: pair("hip", &HIP)?,
            knees: pair("knee", &KNEE)?,
            ankles: pair("ankle", &ANKLE)?,
            toes: pair("toes", &TOE)?,
            shoulders: pair("shoulder", &SHOULDER)?,
            elbows: pair("elbow", &ELBOW)?,
            wrists: pair("wrist", &WRIST)?,
        })
    }
}

/// Small letters and nothing else, without what stands before a colon.
fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    name.chars().filter(char::is_ascii_alphanumeric).map(|letter| letter.to_ascii_lowercase()).collect()
}

/// Whether a name is a word with a side before it or behind it: `rightarm`, `humerusr`.
fn is_sided(name: &str, word: &str, side: &str) -> bool {
    let letter = &side[..1];
    name.strip_prefix(side).is_some_and(|rest| rest == word)
        || name.strip_suffix(word).is_some_and(|rest| rest == letter)
        || name.strip_prefix(word).is_some_and(|rest| rest == letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_told_before_and_behind() {
        assert!(is_sided(&plain("mixamorig:RightUpLeg"), "upleg", "right"));
        assert!(is_sided(&plain("humerus_r"), "humerus", "right"));
        assert!(is_sided(&plain("left forearm"), "forearm", "left"));
        assert!(!is_sided(&plain("LeftForeArm"), "arm", "left"));
        assert!(!is_sided(&plain("LHipJoint"), "hip", "left"));
        assert!(!is_sided(&plain("RightUpLeg"), "leg", "right"));
    }
}
