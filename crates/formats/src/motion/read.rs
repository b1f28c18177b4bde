//! A written `backlit-track 1` again, as a motion.

use std::path::Path;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use glam::{DQuat, DVec3};
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::Motion;
use crate::export::track_json::FORMAT;
use crate::json_text::{self, Entries};
use crate::{DiskFiles, FileError, FileProblem, TakeFiles, text};

/// Largest track that is read, bytes: an hour of a full body.
const MAX_BYTES: u64 = 1 << 30;
/// A joint farther than this, metres, from where the body has it tells of another body.
const SAME_BODY_M: f64 = 1e-3;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TrackSpec {
    #[serde(rename = "format")]
    _format: String,
    name: String,
    frame_rate: f64,
    model: String,
    #[serde(rename = "cameras")]
    _cameras: IgnoredAny,
    frames: Vec<FrameSpec>,
}

/// What is known of a frame beside its pose is not read.
#[derive(Deserialize)]
struct FrameSpec {
    frame: usize,
    root: [f64; 3],
    rotations: Entries<[f64; 4]>,
    joints: Entries<[f64; 3]>,
}

/// Reads the `track.json` that `backlit track` wrote. Such a file names its body: without a `model`, that is the
/// built-in one of that name.
///
/// # Errors
/// No such file, not a track, a frame given twice, numbers that are no pose, or a body that is not the track's: its name
/// is unknown, limbs differ, or joints lie elsewhere. The error names the file, the field, and the line where there is one.
pub fn read_track(path: &Path, model: Option<&Model>) -> Result<Motion, FileError> {
    parse_track(path, &DiskFiles.read(path, MAX_BYTES)?, model)
}

/// The same from bytes; `path` is for the error's message.
///
/// # Errors
/// As [`read_track`].
pub fn parse_track(path: &Path, bytes: &[u8], model: Option<&Model>) -> Result<Motion, FileError> {
    let text = text::decode(path, bytes)?;
    let spec: TrackSpec = json_text::parse_versioned(path, text, FORMAT)?;
    let line = |field| json_text::line_of(text, &[field]);
    if !(spec.frame_rate.is_finite() && spec.frame_rate > 0.0) {
        let problem = field("frame_rate", &spec.frame_rate, "frames per second, more than none");
        return Err(FileError::new(path, problem).at_line(line("frame_rate")));
    }
    let model = match model {
        Some(model) => model.clone(),
        None => of_name(&spec.model).ok_or_else(|| {
            let expected = "the name of a built-in body; a body of another name must be given as a file";
            FileError::new(path, field("model", &format!("{:?}", spec.model), expected))
                .at_line(line("model"))
        })?,
    };
    let mut motion =
        Motion { name: spec.name, model, frame_rate: spec.frame_rate, poses: Default::default() };
    for (index, frame) in spec.frames.into_iter().enumerate() {
        let number = frame.frame;
        let pose = pose(&motion.model, &format!("frames[{index}]"), frame)
            .map_err(|problem| FileError::new(path, problem))?;
        if motion.poses.insert(number, pose).is_some() {
            let field = format!("frame {number}");
            return Err(FileError::new(path, FileProblem::Duplicate { field }));
        }
    }
    Ok(motion)
}

fn field(field: &str, found: &dyn std::fmt::Display, expected: &str) -> FileProblem {
    FileProblem::Field { field: field.to_owned(), found: found.to_string(), expected: expected.to_owned() }
}

/// The built-in body that calls itself so.
fn of_name(name: &str) -> Option<Model> {
    [builtin::single_limb(), builtin::upper_body(), builtin::full_body()]
        .into_iter()
        .find(|model| model.name() == name)
}

/// The pose of a frame, and that the body has its joints where the track says.
fn pose(model: &Model, at: &str, frame: FrameSpec) -> Result<Pose, FileProblem> {
    let mut pose = Pose::rest(model);
    pose.root = DVec3::from_array(frame.root);
    let mut left_out = vec![true; model.rotation_count()];
    let in_rotations = format!("{at}.rotations");
    for (limb, [w, x, y, z]) in frame.rotations.0 {
        let Some(index) = model.limb_index(&limb) else {
            return Err(FileProblem::UnknownLimb { field: in_rotations, limb });
        };
        let found = &model.limbs()[index];
        if !found.has_own_rotation {
            return Err(FileProblem::RigidLimb { field: in_rotations, limb });
        }
        pose.rotations[found.rotation] = DQuat::from_xyzw(x, y, z, w);
        left_out[found.rotation] = false;
    }
    if let Some(rotation) = left_out.iter().position(|left_out| *left_out) {
        let limb = &model.limbs()[model.rotation_owners()[rotation]].name;
        return Err(field(&format!("{in_rotations}.{limb}"), &"missing", "four numbers, w x y z"));
    }
    pose.check(model)
        .map_err(|error| FileProblem::Option { field: at.to_owned(), message: error.to_string() })?;
    let pose = pose.normalized();
    let kinematics = Kinematics::new(model, &pose);
    for (joint, place) in frame.joints.0 {
        let expected = if joint == crate::export::ROOT {
            pose.root
        } else {
            match model.limb_index(&joint) {
                Some(limb) => kinematics.ends()[limb],
                None => return Err(FileProblem::UnknownLimb { field: format!("{at}.joints"), limb: joint }),
            }
        };
        let place = DVec3::from_array(place);
        // Also where it is no number.
        let is_near = place.distance(expected) <= SAME_BODY_M;
        if !is_near {
            let wanted =
                format!("{expected}, where the body {:?} has it; the track is of another body", model.name());
            return Err(field(&format!("{at}.joints.{joint}"), &place, &wanted));
        }
    }
    Ok(pose)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::tests::sample;
    use crate::export::{TrackExport, track_json};

    #[test]
    fn a_written_track_reads_back_and_a_broken_one_says_where() {
        let (model, track) = (builtin::single_limb(), sample());
        let export =
            TrackExport { name: "a", frame_rate: 8.0, model: &model, cameras: &["left"], track: &track };
        let text = track_json::to_text(&export);
        let read = |text: &str, model| parse_track(Path::new("track.json"), text.as_bytes(), model);
        let motion = read(&text, None).unwrap();
        assert_eq!((motion.frame_rate, motion.poses.len()), (8.0, 2));
        let expected = Motion::of_track(&export);
        for (frame, pose) in &motion.poses {
            assert_eq!(pose.root, expected.poses[frame].root);
            assert!(pose.local(&expected.poses[frame]).iter().all(|x| x.abs() < 1e-12));
        }
        for cut in (0..text.len() - 2).step_by(7) {
            let message = read(&text[..cut], None).unwrap_err().to_string();
            assert!(message.starts_with("track.json"), "{message}");
        }
        let longer = model.with_sizes(|_| [2.0, 0.1]).unwrap();
        let message = read(&text, Some(&longer)).unwrap_err().to_string();
        assert!(message.contains("another body"), "{message}");
        for (from, to, expected) in [
            ("8.0", "0", "line 4: `frame_rate` is 0"),
            ("\"model\": \"", "\"model\": \"x", "line 5: `model` is \"x"),
            ("\"root\":[0.1", "\"root\":[null", "frames[0]."),
            ("\"root\":[0.1", "\"root\":[9e9", "frames[0]"),
            ("\"frame\":6", "\"frame\":4", "`frame 4` is given twice"),
            ("backlit-track 1", "backlit-track 2", "line 2: `format`"),
        ] {
            let changed = text.replace(from, to);
            assert_ne!(changed, text, "{from}");
            let message = read(&changed, None).unwrap_err().to_string();
            assert!(message.contains(expected), "{from}: {message}");
        }
    }
}
