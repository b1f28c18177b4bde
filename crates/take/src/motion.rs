//! Motions of files on a body of ours: any recording is scaled to the body, stood up on the floor and followed limb by limb.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use backlit_formats::motion::{MAX_FRAMES, Motion};
use backlit_formats::recording::{self, RecordingOptions};
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::metrics::Trajectories;
use backlit_tracking::posing::Follower;
use backlit_tracking::statistics::median;
use glam::{DQuat, DVec3};

mod feet;
mod unfilmed;

use feet::Feet;
pub use unfilmed::open;

/// The endings of files that hold where joints are.
pub const ENDINGS: [&str; 6] = ["bvh", "trc", "c3d", "csv", "npz", "npy"];
/// The share of the frames whose lowest foot is below the floor: a foot that is mistaken once lifts nobody.
const BELOW_FLOOR: f64 = 0.02;
/// How far an ankle's joint is above the sole, metres: that of the built-in body.
const ANKLE_M: f64 = 0.08;

/// Whether a file holds a motion, by its ending. A folder may be called anything and is none.
#[must_use]
pub fn is_motion(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) && !path.is_dir()
}

/// How a recording is put on a body.
#[derive(Debug, Clone, Copy, Default)]
pub struct FollowOptions {
    /// Which way is up in the recording; without it the axis along which people in it are tallest.
    pub up: Option<DVec3>,
    /// Frames a second of the poses; without it the recording's.
    pub frame_rate: Option<f64>,
}

/// Reads a recording as poses of a body, z up, feet on the floor z = 0 and not in it, the first frame over the origin. `tell` hears how many frames
/// are done, and of how many.
///
/// # Errors
/// As [`recording::read`], and where hips, shoulders, knees and ankles are not all there.
pub fn follow_recording(
    path: &Path,
    reading: &RecordingOptions,
    model: &Model,
    options: FollowOptions,
    tell: &mut dyn FnMut(usize, usize),
) -> anyhow::Result<Motion> {
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let recorded = recording::read(path, reading)?.trajectories(path, reading)?;
    let missing =
        || format!("{}: hips, shoulders, knees and ankles of both sides are needed", path.display());
    let turn = DQuat::from_rotation_arc(upright(&recorded, options.up).with_context(missing)?, DVec3::Z);
    let mut follower = Follower::new(model).context("the body has no hips and shoulders")?;
    let at = |points: &[Option<DVec3>], joint: &str| points[recorded.column(joint)?];
    let mut scales: Vec<f64> =
        recorded.points.iter().filter_map(|points| follower.scale(|joint| at(points, joint))).collect();
    let scale = median(&mut scales).with_context(missing)?;
    let period = recorded.period();
    let rate = options.frame_rate.unwrap_or(1.0 / period);
    let [first, last] =
        [recorded.times.first(), recorded.times.last()].map(|time| time.copied().unwrap_or(0.0));
    let count = ((last - first) * rate).round() as usize + 1;
    anyhow::ensure!(
        count <= MAX_FRAMES,
        "{}: from its first time to its last are {count} frames; expected at most {MAX_FRAMES}",
        path.display()
    );
    let moments = recorded.moments();
    let mut poses = BTreeMap::new();
    for frame in 0..count {
        tell(frame, count);
        let points = moments.points_at(first + frame as f64 / rate);
        let placed = |joint: &str| Some(scale * (turn * at(&points, joint)?));
        if let Some(pose) = follower.pose(placed) {
            poses.insert(frame, pose);
        }
    }
    anyhow::ensure!(!poses.is_empty(), missing());
    let mut motion = standing(Motion::of_poses(name, model.clone(), rate, poses), DVec3::Z);
    let feet = Feet::of(model);
    motion.poses.values_mut().for_each(|pose| feet.lift(pose));
    Ok(motion)
}

/// Which way is up: the axis, as near as it is known, or the coordinate axis nearest to the mean way from ankles to shoulders.
fn upright(recorded: &Trajectories, up: Option<DVec3>) -> Option<DVec3> {
    if let Some(up) = up.and_then(DVec3::try_normalize) {
        return Some(up);
    }
    let of = |points: &Vec<Option<DVec3>>| {
        let both = |joint: &str| -> Option<DVec3> {
            let [left, right] =
                ["left", "right"].map(|side| points[recorded.column(&format!("{side} {joint}"))?]);
            Some((left? + right?) / 2.0)
        };
        Some(both("shoulder")? - both("ankle")?)
    };
    let sum: DVec3 = recorded.points.iter().filter_map(of).sum();
    let axis = sum.abs().max_position();
    (sum != DVec3::ZERO).then(|| DVec3::AXES[axis] * sum[axis].signum())
}

/// The same motion with z up, its feet on the floor, and the first frame over the origin.
#[must_use]
pub fn standing(mut motion: Motion, up: DVec3) -> Motion {
    let turn = DQuat::from_rotation_arc(up.normalize_or(DVec3::Z), DVec3::Z);
    let parents = motion.model.rotation_parents().to_vec();
    for pose in motion.poses.values_mut() {
        pose.root = turn * pose.root;
        for (rotation, _) in pose.rotations.iter_mut().zip(&parents).filter(|(_, parent)| parent.is_none()) {
            *rotation = turn * *rotation;
        }
    }
    let mut lowest: Vec<f64> = motion.poses.values().map(|pose| lowest_joint(&motion.model, pose)).collect();
    lowest.sort_by(f64::total_cmp);
    let floor = lowest[(BELOW_FLOOR * lowest.len() as f64) as usize];
    let Some(first) = motion.poses.values().next().map(|pose| pose.root) else { return motion };
    let shift = DVec3::new(first.x, first.y, floor - ANKLE_M);
    motion.poses.values_mut().for_each(|pose| pose.root -= shift);
    motion
}

/// The height of the lowest ankle, or of whatever is lowest in a body without.
fn lowest_joint(model: &Model, pose: &Pose) -> f64 {
    let kinematics = Kinematics::new(model, pose);
    let ankles =
        model.limbs().iter().zip(kinematics.ends()).filter(|(limb, _)| limb.name.ends_with("lower calf"));
    let lowest = ankles.map(|(_, end)| end.z).fold(f64::INFINITY, f64::min);
    if lowest.is_finite() {
        lowest
    } else {
        kinematics.ends().iter().map(|end| end.z).fold(f64::INFINITY, f64::min)
    }
}
