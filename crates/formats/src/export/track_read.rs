//! A written `backlit-track 1` again.

use std::path::Path;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::cues::{Cue, LimbHold};
use backlit_tracking::silhouette::Overlap;
use backlit_tracking::track::{FrameEstimate, Lost, Track};
use glam::DVec3;
use serde::Deserialize;

use super::track_json::FORMAT;
use super::trust_record::TrustRecord;
use super::{ROOT, ending_of_text};
use crate::json_text::{self, Entries};
use crate::pose_file::set_rotation;
use crate::{DiskFiles, FileError, FileProblem, Result, TakeFiles, text};

/// Largest track that is read, bytes: an hour of a full body.
const MAX_BYTES: u64 = 1 << 30;
/// A joint farther than this, metres, from where the body has it tells of another body.
const SAME_BODY_M: f64 = 1e-3;
/// More pixels than any picture has.
const MAX_PIXELS: usize = 1 << 32;
/// Rotations whose lengths squared differ from 1 by less are taken as they are.
const UNIT_WITHIN: f64 = 1e-12;

/// A track as it was written. Only what later frames of a filter or search need is not known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenTrack {
    /// What the recording is called.
    pub name: String,
    /// The body.
    pub model: Model,
    /// Frames per second.
    pub frame_rate: f64,
    /// The cameras' names, in the order of the estimates' overlaps.
    pub cameras: Vec<String>,
    /// The estimates.
    pub track: Track,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TrackSpec {
    #[serde(rename = "format")]
    _format: String,
    name: String,
    frame_rate: f64,
    model: String,
    cameras: Vec<String>,
    frames: Vec<FrameSpec>,
}

/// Of what is not known the file says null, or nothing.
#[derive(Deserialize)]
struct FrameSpec {
    frame: usize,
    root: [f64; 3],
    rotations: Entries<[f64; 4]>,
    joints: Entries<[f64; 3]>,
    #[serde(default)]
    cost: Option<f64>,
    #[serde(default)]
    rms: Option<f64>,
    #[serde(default)]
    /// Four counts; files of before have three.
    pixels: Option<Entries<Option<Vec<usize>>>>,
    #[serde(default)]
    left_out: Vec<String>,
    #[serde(default)]
    iterations: usize,
    #[serde(default)]
    lost: bool,
    /// Files of older versions do not say it.
    #[serde(default)]
    lost_because: Option<Lost>,
    #[serde(default)]
    termination: Option<String>,
    #[serde(default)]
    held_by_cues: Option<Entries<Vec<String>>>,
    #[serde(default)]
    unsure: Vec<String>,
    #[serde(default)]
    trust: TrustRecord,
}

/// Reads the `track.json` that `backlit track` wrote. Such a file names its body: without a `model`, that is the
/// built-in one of that name.
///
/// # Errors
/// No such file, not a track, a frame given twice, numbers that are no pose, or a body that is not the track's: its name
/// is unknown, limbs differ, or joints lie elsewhere. The error names the file, the field, and the line where there is one.
pub fn read(path: &Path, model: Option<&Model>) -> Result<WrittenTrack> {
    parse(path, &DiskFiles.read(path, MAX_BYTES)?, model)
}

/// The same from bytes; `path` is for the error's message.
pub fn parse(path: &Path, bytes: &[u8], model: Option<&Model>) -> Result<WrittenTrack> {
    let text = text::decode(path, bytes)?;
    let spec: TrackSpec = json_text::parse_versioned(path, text, FORMAT)?;
    let line = |field| json_text::line_of(text, &[field]);
    if !(spec.frame_rate.is_finite() && spec.frame_rate > 0.0) {
        let problem = field("frame_rate", &spec.frame_rate, "frames per second, above 0");
        return Err(FileError::new(path, problem).at_line(line("frame_rate")));
    }
    let model = match model {
        Some(model) => model.clone(),
        None => builtin::of_name(&spec.model).ok_or_else(|| {
            let expected = "the name of a built-in body; a body of another name must be given as a file";
            FileError::new(path, field("model", &format!("{:?}", spec.model), expected))
                .at_line(line("model"))
        })?,
    };
    for (index, camera) in spec.cameras.iter().enumerate() {
        if spec.cameras[..index].contains(camera) {
            let problem = FileProblem::Duplicate { field: format!("cameras[{index}]") };
            return Err(FileError::new(path, problem).at_line(line("cameras")));
        }
    }
    let mut track = Track::default();
    for (index, frame) in spec.frames.into_iter().enumerate() {
        let number = frame.frame;
        let estimate = estimate(&model, &spec.cameras, &format!("frames[{index}]"), frame)
            .map_err(|problem| FileError::new(path, problem))?;
        if track.frames.insert(number, estimate).is_some() {
            let field = format!("frame {number}");
            return Err(FileError::new(path, FileProblem::Duplicate { field }));
        }
    }
    Ok(WrittenTrack { name: spec.name, model, frame_rate: spec.frame_rate, cameras: spec.cameras, track })
}

fn field(field: &str, found: &dyn std::fmt::Display, expected: &str) -> FileProblem {
    FileProblem::field(field, found.to_string(), expected)
}

fn estimate(
    model: &Model,
    cameras: &[String],
    at: &str,
    frame: FrameSpec,
) -> Result<FrameEstimate, FileProblem> {
    let pose = pose(model, at, &frame)?;
    let mut overlap = vec![None; cameras.len()];
    for (camera, pixels) in frame.pixels.map(|pixels| pixels.0).unwrap_or_default() {
        let Some(index) = cameras.iter().position(|name| *name == camera) else {
            return Err(field(&format!("{at}.pixels"), &camera, "a camera of the track"));
        };
        overlap[index] = match pixels {
            None => None,
            Some(counts) => match counts[..] {
                [agreement, missing, spurious, ref unknown @ ..]
                    if unknown.len() < 2 && counts.iter().all(|&count| count <= MAX_PIXELS) =>
                {
                    let unknown = unknown.first().copied().unwrap_or(0);
                    Some(Overlap { agreement, missing, spurious, unknown })
                }
                _ => {
                    let found = format!("{counts:?}");
                    let expected = "four numbers of pixels of a picture";
                    return Err(field(&format!("{at}.pixels.{camera}"), &found, expected));
                }
            },
        };
    }
    let mut holds = Vec::new();
    if let Some(by_cues) = &frame.held_by_cues {
        let held = |limb| LimbHold { limb, cameras: 0, by_silhouettes: true, cues: Vec::new() };
        holds.extend(model.rotation_owners().iter().map(|&limb| held(limb)));
        let mut hold = |name: &str, cues: Vec<Cue>| {
            let rotation = model.limb_index(name).map(|limb| model.limbs()[limb].rotation);
            let unknown = || FileProblem::UnknownLimb { field: at.to_owned(), limb: name.to_owned() };
            let hold = rotation.and_then(|rotation| holds.get_mut(rotation)).ok_or_else(unknown)?;
            (hold.by_silhouettes, hold.cues) = (false, cues);
            Ok(())
        };
        for (limb, names) in &by_cues.0 {
            let cue = |name: &String| {
                let cue = Cue::ALL.into_iter().find(|cue| cue.name() == name);
                cue.ok_or_else(|| field(&format!("{at}.held_by_cues.{limb}"), name, "a cue"))
            };
            hold(limb, names.iter().map(cue).collect::<Result<_, _>>()?)?;
        }
        for limb in &frame.unsure {
            hold(limb, Vec::new())?;
        }
    }
    Ok(FrameEstimate {
        trust: frame.trust.read(model, &format!("{at}.trust"))?,
        cost: frame.cost,
        rms: frame.rms,
        overlap,
        empty_cameras: frame.left_out,
        iterations: frame.iterations,
        lost_because: frame.lost_because.or(frame.lost.then_some(Lost::Numbers)),
        termination: frame.termination.as_deref().and_then(ending_of_text),
        holds,
        ..FrameEstimate::of_pose(frame.frame, pose)
    })
}

/// The pose of a frame, and that the body has its joints where the track says.
fn pose(model: &Model, at: &str, frame: &FrameSpec) -> Result<Pose, FileProblem> {
    let mut pose = Pose::rest(model);
    pose.root = DVec3::from_array(frame.root);
    let mut left_out = vec![true; model.rotation_count()];
    let in_rotations = format!("{at}.rotations");
    for (limb, coefficients) in &frame.rotations.0 {
        left_out[set_rotation(model, &mut pose, &in_rotations, limb, *coefficients)?] = false;
    }
    if let Some(rotation) = left_out.iter().position(|left_out| *left_out) {
        let limb = &model.limbs()[model.rotation_owners()[rotation]].name;
        return Err(field(&format!("{in_rotations}.{limb}"), &"missing", "four numbers, w x y z"));
    }
    pose.check(model)
        .map_err(|error| FileProblem::Option { field: at.to_owned(), message: error.to_string() })?;
    // What Backlit wrote stays as it is, to the bit.
    if pose.rotations.iter().any(|q| (q.length_squared() - 1.0).abs() > UNIT_WITHIN) {
        pose = pose.normalized();
    }
    let kinematics = Kinematics::new(model, &pose);
    for (joint, place) in &frame.joints.0 {
        let expected = match model.limb_index(joint) {
            _ if joint == ROOT => pose.root,
            Some(limb) => kinematics.ends()[limb],
            None => {
                let field = format!("{at}.joints");
                return Err(FileProblem::UnknownLimb { field, limb: joint.clone() });
            }
        };
        let place = DVec3::from_array(*place);
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
    use super::super::tests::sample;
    use super::super::{TrackExport, track_json};
    use super::*;
    use crate::damaged::assert_refused;

    #[test]
    fn a_written_track_reads_back_and_a_broken_one_says_where() {
        let (model, track) = (builtin::single_limb(), sample());
        let cameras = ["left", "right"];
        let export =
            TrackExport { name: "a", frame_rate: 8.0, model: &model, cameras: &cameras, track: &track };
        let text = track_json::to_text(&export);
        let read = |text: &str, model| parse(Path::new("track.json"), text.as_bytes(), model);
        let written = read(&text, None).unwrap();
        assert_eq!((written.name.as_str(), written.frame_rate), ("a", 8.0));
        assert_eq!(written.cameras, cameras);
        assert_eq!(written.track, track);
        assert_eq!(read(&text.replace("[3,1,0,0]", "[3,1,0]"), None).unwrap().track, track);
        for cut in (0..text.len() - 2).step_by(7) {
            let message = read(&text[..cut], None).unwrap_err().to_string();
            assert!(message.starts_with("track.json"), "{message}");
        }
        let longer = model.with_sizes(|_| [2.0, 0.1]).unwrap();
        let message = read(&text, Some(&longer)).unwrap_err().to_string();
        assert!(message.contains("another body"), "{message}");
        assert_refused(
            &text,
            |text| read(text, None),
            r#"
            8.0 ⇒ 0 ⇒ line 4: `frame_rate` is 0
            "model": " ⇒ "model": "x ⇒ line 5: `model` is "x
            "root":[0.1 ⇒ "root":[null ⇒ frames[0].
            "root":[0.1 ⇒ "root":[9e9 ⇒ frames[0]
            "frame":6 ⇒ "frame":4 ⇒ `frame 4` is given twice
            "pixels":{"left" ⇒ "pixels":{"top" ⇒ `frames[0].pixels` is top; expected a camera of the track
            [3,1,0,0] ⇒ [3,1,4294967297] ⇒ `frames[0].pixels.left` is [3, 1, 4294967297]
            [3,1,0,0] ⇒ [3,1] ⇒ `frames[0].pixels.left` is [3, 1]
            ["left","right"] ⇒ ["left","left"] ⇒ `cameras[1]` is given twice
            backlit-track 1 ⇒ backlit-track 2 ⇒ line 2: `format`
            "#,
        );
    }
}
