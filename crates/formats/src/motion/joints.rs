//! Positions of joints, frame by frame: of a BVH file of any program, or of our own track.

use std::path::Path;

use backlit_tracking::body::{Kinematics, builtin};
use glam::DVec3;

use super::Motion;
use crate::bvh;
use crate::export::track_read;
use crate::{DiskFiles, FileProblem, Result, TakeFiles};

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

/// Nodes of our own skeleton as a BVH has them, and the limb that ends there: a node lies where its limb begins.
const OWN_NODES: [(&str, &str); 16] = [
    ("neck", "chest"),
    ("neck end", "skull"),
    ("left_upper_arm", "left clavicle"),
    ("left_forearm", "left upper arm"),
    ("left_forearm end", "left hand"),
    ("left_thigh", "left hip"),
    ("left_calf", "left lower thigh"),
    ("left_foot", "left lower calf"),
    ("left_foot end", "left foot"),
    ("right_upper_arm", "right clavicle"),
    ("right_forearm", "right upper arm"),
    ("right_forearm end", "right hand"),
    ("right_thigh", "right hip"),
    ("right_calf", "right lower thigh"),
    ("right_foot", "right lower calf"),
    ("right_foot end", "right foot"),
];

/// Gives joints of a BVH that this program wrote the names that tracks have. Wrists have no node there, since hands
/// are rigid with forearms: they lie on the way to the hand's end as in the built-in full body.
fn with_own_names(mut track: JointTrack) -> JointTrack {
    if !OWN_NODES.iter().all(|(node, _)| track.joints.iter().any(|name| name == node)) {
        return track;
    }
    for name in &mut track.joints {
        let limb = OWN_NODES.iter().find(|(node, _)| name == node).map_or("", |(_, limb)| limb);
        // Other nodes would be taken for the ends of the limbs whose names they have.
        *name = if limb.is_empty() { format!("{name} begins") } else { limb.to_owned() };
    }
    let body = builtin::full_body();
    let length = |limb: &str| body.limb_index(limb).map_or(0.0, |index| body.limbs()[index].length);
    for side in ["left", "right"] {
        let share = length(&format!("{side} forearm"));
        let share = share / (share + length(&format!("{side} hand")));
        let [elbow, tip] = ["upper arm", "hand"]
            .map(|limb| track.joints.iter().position(|name| *name == format!("{side} {limb}")).unwrap_or(0));
        track.joints.push(format!("{side} forearm"));
        track.frames.iter_mut().for_each(|(_, at)| at.push(at[elbow].lerp(at[tip], share)));
    }
    track
}

/// Reads a BVH file, or a `track.json` of a built-in body or of `model`: which of both, the name's end says.
pub fn read_joints(path: &Path, model: Option<&backlit_tracking::body::Model>) -> Result<JointTrack> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("bvh")) {
        return parse_bvh(path, &DiskFiles.read(path, MAX_BYTES)?);
    }
    Ok(JointTrack::of_motion(&Motion::of_written(track_read::read(path, model)?)))
}

/// Parses a BVH file; `path` is for the error's message. Frames count from 0. Joints of a BVH that this program wrote have the names
/// that tracks have.
pub fn parse_bvh(path: &Path, bytes: &[u8]) -> Result<JointTrack> {
    let motion = bvh::parse(path, bytes)?;
    let (joints, frames) = (motion.joints(), motion.frame_count());
    if joints.len().saturating_mul(frames) > MAX_PLACES {
        let found = format!("{frames} with {} joints", joints.len());
        return Err(
            FileProblem::field("Frames:", found, format!("at most {MAX_PLACES} places")).at(path, None)
        );
    }
    let places = |frame| motion.joints_at(frame).into_iter().map(|(place, _)| place).collect();
    Ok(with_own_names(JointTrack {
        joints: joints.iter().map(|joint| joint.name.clone()).collect(),
        frame_rate: 1.0 / motion.frame_seconds,
        frames: (0..frames).map(|frame| (frame, places(frame))).collect(),
        up: Some(DVec3::Y),
    }))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use backlit_tracking::body::Pose;
    use glam::DQuat;

    use super::*;
    use crate::motion::{MotionFormat, MotionOptions, to_bytes};

    /// A BVH of ours has the joints of the track that it was made of, in its own unit and axes.
    #[test]
    fn joints_of_a_bvh_of_ours_are_those_of_its_track() {
        let model = builtin::full_body();
        let mut poses = BTreeMap::new();
        for frame in 0..4 {
            let mut pose = Pose::rest(&model);
            for (index, rotation) in pose.rotations.iter_mut().enumerate() {
                let angle = 0.3 * (frame as f64 + 1.7 * index as f64).sin();
                *rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), angle) * *rotation;
            }
            pose.root = DVec3::new(0.1 * frame as f64, 0.2, 0.9);
            poses.insert(frame, pose);
        }
        let motion = Motion::of_poses("a", model, 20.0, poses);
        let track = JointTrack::of_motion(&motion);
        let bytes = to_bytes(MotionFormat::Bvh, &motion, &MotionOptions::default()).unwrap();
        let read = parse_bvh(Path::new("a.bvh"), &bytes).unwrap();
        let column =
            |track: &JointTrack, name: &str| track.joints.iter().position(|other| other == name).unwrap();
        let names: Vec<&str> =
            OWN_NODES.iter().map(|(_, limb)| *limb).chain(["left forearm", "right forearm"]).collect();
        let distance = |track: &JointTrack, frame: usize, a: &str, b: &str| {
            let at = &track.frames[frame].1;
            at[column(track, a)].distance(at[column(track, b)])
        };
        let scale = distance(&read, 0, "chest", "left foot") / distance(&track, 0, "chest", "left foot");
        for frame in 0..4 {
            for name in &names {
                let [of_bvh, of_track] = [&read, &track].map(|track| distance(track, frame, "chest", name));
                assert!((of_bvh - scale * of_track).abs() < 1e-4 * scale, "{name}, frame {frame}");
            }
        }
        // Nothing of a file of another program is renamed.
        let other = JointTrack { joints: vec!["neck".to_owned()], ..read };
        assert_eq!(with_own_names(other.clone()), other);
    }
}
