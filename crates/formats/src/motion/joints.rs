//! Where joints are, frame by frame, whoever wrote them down: a BVH file of any program, or our own track.

use std::path::Path;

use backlit_tracking::body::Kinematics;
use glam::DVec3;

use super::Motion;
use crate::bvh;
use crate::export::track_read;
use crate::{DiskFiles, FileError, FileProblem, TakeFiles};

/// Most places that a file is read to: 400 MB.
const MAX_PLACES: usize = 1 << 24;
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

/// Parses a BVH file; `path` is for the error's message. Frames count from 0.
///
/// # Errors
/// As [`bvh::parse`], or more than 16 million places. The error names the line.
pub fn parse_bvh(path: &Path, bytes: &[u8]) -> Result<JointTrack, FileError> {
    let motion = bvh::parse(path, bytes)?;
    let (joints, frames) = (motion.joints(), motion.frame_count());
    if joints.len().saturating_mul(frames) > MAX_PLACES {
        let problem = FileProblem::Field {
            field: "Frames:".to_owned(),
            found: format!("{frames} with {} joints", joints.len()),
            expected: format!("at most {MAX_PLACES} places"),
        };
        return Err(FileError::new(path, problem));
    }
    let places = |frame| motion.joints_at(frame).into_iter().map(|(place, _)| place).collect();
    Ok(JointTrack {
        joints: joints.iter().map(|joint| joint.name.clone()).collect(),
        frame_rate: 1.0 / motion.frame_seconds(),
        frames: (0..frames).map(|frame| (frame, places(frame))).collect(),
        up: Some(DVec3::Y),
    })
}
