//! Where joints are, frame by frame, whoever wrote them down: a BVH file of any program, or our own track.

use std::path::Path;

use backlit_tracking::body::Kinematics;
use glam::DVec3;

use super::{Motion, bvh_read};
use crate::export::track_read;
use crate::{DiskFiles, FileError, TakeFiles};

/// Largest BVH that is read, bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Positions of named joints over time.
#[derive(Debug, Clone, PartialEq)]
pub struct JointTrack {
    /// The joints' names.
    pub joints: Vec<String>,
    /// Frames a second.
    pub frame_rate: f64,
    /// Numbers of the frames, ascending, and positions, one a joint, in the file's axes and unit.
    pub frames: Vec<(usize, Vec<DVec3>)>,
    /// Which way is up, where the file's kind says so: y in BVH. A track does not say it.
    pub up: Option<DVec3>,
}

impl JointTrack {
    /// The joints of a body's poses: the end of every limb by the limb's name, and `root`.
    #[must_use]
    pub fn of_motion(motion: &Motion) -> Self {
        let limbs = motion.model.limbs().iter().map(|limb| limb.name.clone());
        let frames = motion.poses.iter().map(|(&frame, pose)| {
            let kinematics = Kinematics::new(&motion.model, pose);
            let positions = kinematics.ends().iter().copied().chain([pose.root]).collect();
            (frame, positions)
        });
        Self {
            joints: limbs.chain([crate::export::ROOT.to_owned()]).collect(),
            frame_rate: motion.frame_rate,
            frames: frames.collect(),
            up: None,
        }
    }
}

/// Reads a BVH file, or a `track.json` of a built-in body or of `model`: which of both, the name's end says.
///
/// # Errors
/// No such file, or as [`parse_bvh`] or [`track_read::read`]. The error names the file, and the line or field.
pub fn read_joints(
    path: &Path,
    model: Option<&backlit_tracking::body::Model>,
) -> Result<JointTrack, FileError> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("bvh")) {
        return parse_bvh(path, &DiskFiles.read(path, MAX_BYTES)?);
    }
    Ok(JointTrack::of_motion(&Motion::of_written(track_read::read(path, model)?)))
}

/// Parses a BVH file; `path` is for the error's message. Joints are the file's nodes, ends of chains left out; frames count from 0.
///
/// # Errors
/// Not such a file, a number that is none or missing, or more than can be. The error names the line.
pub fn parse_bvh(path: &Path, bytes: &[u8]) -> Result<JointTrack, FileError> {
    bvh_read::parse(path, bytes)
}
