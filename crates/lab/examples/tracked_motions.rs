//! Names of motions that this program tracked: recorded people are put on the average body, which wears clothes and is seen by cameras all round;
//! its silhouettes are tracked without a start, and the track is named.
//!
//! `cargo run --release -p backlit-lab --example tracked_motions -- motions=DIR [per=2] [seconds=3] [rate=20] [cameras=4]
//! [size=108,144]`: DIR has BVH files and a labels.csv. Of each class so many clips, of different people where there are; each is named by what
//! was learnt from all other people.

mod labelled;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::bvh;
use backlit_formats::motion::{self, JointTrack, Motion};
use backlit_lab::synthetic::{Build, Figure, retarget, silhouette};
use backlit_recognition::learn::{Prepared, prepare};
use backlit_recognition::observed::Observed;
use backlit_recognition::{JointMotion, LearnOptions, Method, NamedMotion, Recognizer};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitOptions, FitView};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::prior::BodyPoints;
use backlit_tracking::search::{WithoutStart, without_start};
use backlit_tracking::track::{self, Tracker, WhenToSearch};
use glam::{DQuat, DVec3};
use labelled::{Error, motion_of, motions};

/// A leg of the average body, metres, is told by its limbs; ankles are so high above the floor.
const ANKLE_M: f64 = 0.098;
/// Cameras stand so far beyond the motion's own extent, metres, and look at this height.
const DISTANCE_M: f64 = 3.2;
const LOOK_AT_M: f64 = 0.9;
/// Focal length, in picture heights.
const FOCAL: f64 = 1.2;

struct Settings {
    folder: PathBuf,
    per: usize,
    seconds: f64,
    rate: f64,
    cameras: usize,
    size_px: [u64; 2],
}

fn settings() -> Result<Settings, Error> {
    let mut all = Settings {
        folder: PathBuf::new(),
        per: 2,
        seconds: 3.0,
        rate: 20.0,
        cameras: 4,
        size_px: [108, 144],
    };
    for argument in std::env::args().skip(1) {
        let (name, value) = argument.split_once('=').ok_or("expected NAME=VALUE")?;
        match name {
            "motions" => all.folder = value.into(),
            "per" => all.per = value.parse()?,
            "seconds" => all.seconds = value.parse()?,
            "rate" => all.rate = value.parse()?,
            "cameras" => all.cameras = value.parse()?,
            "size" => {
                let (across, down) = value.split_once(',').ok_or("expected size=ACROSS,DOWN")?;
                all.size_px = [across.parse()?, down.parse()?];
            }
            _ => return Err(format!("{name} is no option").into()),
        }
    }
    Ok(all)
}

/// So many clips of each class, of people who do not come twice where there are enough.
fn chosen(motions: &[NamedMotion], per: usize) -> Vec<usize> {
    let mut classes: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, motion) in motions.iter().enumerate() {
        classes.entry(&motion.class).or_default().push(index);
    }
    let mut all = Vec::new();
    for rows in classes.into_values() {
        let mut people: Vec<&str> = Vec::new();
        let (mut first, mut again) = (Vec::new(), Vec::new());
        for row in rows {
            let is_new = !people.contains(&&*motions[row].subject);
            people.push(&motions[row].subject);
            let rows = if is_new { &mut first } else { &mut again };
            rows.push(row);
        }
        all.extend(first.into_iter().chain(again).take(per));
    }
    all
}

/// The body's poses: upright as recorded, on the floor, about the origin.
fn truth(model: &Model, frames: &[BodyPoints], every: usize) -> Option<Vec<Pose>> {
    // Motion files have y up.
    let upright = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let middle = |points: &BodyPoints| (points.hips[0] + points.hips[1]) / 2.0;
    let first = frames.first()?;
    let recorded = first.hips[0].distance(first.knees[0]) + first.knees[0].distance(first.ankles[0]);
    let legs = ["right thigh", "right lower thigh", "right calf", "right lower calf"];
    let legs = legs.iter().filter_map(|limb| Some(model.limbs()[model.limb_index(limb)?].length));
    let scale = legs.sum::<f64>() / recorded;
    let mut poses = Vec::new();
    for points in frames.iter().step_by(every) {
        let mut pose = retarget::pose(model, points)?;
        pose.rotations[0] = (upright * pose.rotations[0]).normalize();
        pose.root = upright * middle(points) * scale;
        poses.push(pose);
    }
    let ankle = |pose: &Pose| {
        let joints = Kinematics::new(model, pose);
        let of = |side: &str| {
            model.limb_index(&format!("{side} lower calf")).map_or(0.0, |limb| joints.ends()[limb].z)
        };
        of("right").min(of("left"))
    };
    let floor = poses.iter().map(ankle).fold(f64::INFINITY, f64::min) - ANKLE_M;
    let (low, high) = extent(&poses);
    let about = (low + high) / 2.0;
    poses.iter_mut().for_each(|pose| pose.root -= DVec3::new(about.x, about.y, floor));
    Some(poses)
}

fn extent(poses: &[Pose]) -> (DVec3, DVec3) {
    poses.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), pose| {
        (low.min(pose.root), high.max(pose.root))
    })
}

/// Cameras all round, as far away as the motion needs.
fn cameras(poses: &[Pose], settings: &Settings) -> Result<Vec<Arc<Camera>>, Error> {
    let (low, high) = extent(poses);
    let distance = DISTANCE_M + 1.3 * (high - low).with_z(0.0).length();
    let focal = FOCAL * settings.size_px[1] as f64;
    let [cx, cy] = settings.size_px.map(|side| 0.5 * (side as f64 - 1.0));
    let camera = |index: usize| -> Result<Arc<Camera>, Error> {
        let turn = 0.4 + std::f64::consts::TAU * index as f64 / settings.cameras as f64;
        let height = 1.3 + 0.3 * (index % 3) as f64;
        let centre = DVec3::new(turn.sin() * distance, turn.cos() * distance, height);
        let place = CameraFromWorld::looking_at(centre, DVec3::Z * LOOK_AT_M, DVec3::Z);
        let intrinsics = Intrinsics { fx: focal, fy: focal, cx, cy };
        Ok(Arc::new(Camera::new(
            &format!("cam{}", index + 1),
            settings.size_px,
            intrinsics,
            Distortion::None,
            place,
        )?))
    };
    (0..settings.cameras).map(camera).collect()
}

fn of_poses(model: &Model, poses: &[Pose], rate: f64) -> Result<JointMotion, Error> {
    let poses = poses.iter().cloned().enumerate().collect();
    motion_of(&JointTrack::of_motion(&Motion {
        name: String::new(),
        model: model.clone(),
        frame_rate: rate,
        poses,
    }))
}

/// The likeliest class of a whole clip, and whether it is like nothing known.
fn name(recognizer: &Recognizer, motion: &JointMotion) -> Result<(String, bool), Error> {
    let seen = Observed::new(motion)?;
    let shares = recognizer.clip_shares(&seen, Method::Combined);
    let best = (0..shares.len()).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap_or(0);
    Ok((recognizer.classes[best].clone(), recognizer.is_unknown(&seen)))
}

/// The track of a clip, from a pose that the search found, and its mean joint error by frame.
fn follow(
    model: &Arc<Model>,
    truth: &[Pose],
    settings: &Settings,
    rate: f64,
) -> Result<(Vec<Pose>, Vec<f64>), Error> {
    let (cameras, never) = (cameras(truth, settings)?, CancelToken::default());
    let views = |pose: &Pose| -> Result<Vec<FitView>, Error> {
        let figure = Figure::new(model, pose, Build::default()).ok_or("the body has other limbs")?;
        let view = |camera: &Arc<Camera>| -> Result<FitView, Error> {
            let mask = Arc::new(silhouette(&figure, camera)?);
            Ok(FitView { camera: Arc::clone(camera), evidence: Evidence::Mask(mask), weight: 1.0 })
        };
        cameras.iter().map(view).collect()
    };
    let found = without_start(model, &views(&truth[0])?, &WithoutStart::default(), &never)?;
    let mut tracker = Tracker::new(Arc::clone(model), FitOptions::default(), found.pose().clone())?
        .with_motion(track::Motion::Velocity, rate)?
        .with_search(WhenToSearch::WhenPoor);
    let (mut poses, mut errors) = (Vec::new(), Vec::new());
    for (frame, pose) in truth.iter().enumerate() {
        let estimate = tracker.track_frame(frame, views(pose)?, &never)?;
        errors.push(mean_joint_error_mm(model, &estimate.pose, pose));
        poses.push(estimate.pose);
    }
    Ok((poses, errors))
}

fn main() -> Result<(), Error> {
    let settings = settings()?;
    let motions = motions(&settings.folder)?;
    let options = LearnOptions::default();
    let prepared: Result<Vec<Prepared>, _> =
        motions.iter().zip(0..).map(|(named, number)| prepare(named, &options, number)).collect();
    let prepared = prepared?;
    let model = Arc::new(builtin::full_body());
    let shipped = Recognizer::built_in();
    println!("| clip | is | recorded | on the body | tracked | by the shipped model | joints, mm | 95 % |");
    println!("|---|---|---|---|---|---|---|---|");
    let (mut right, mut total, mut means) = ([0; 4], 0, Vec::new());
    for row in chosen(&motions, settings.per) {
        let label = &motions[row];
        let path = settings.folder.join(&label.name);
        let clip = bvh::read(&path)?.body_points(&path)?;
        let every = (1.0 / (settings.rate * clip.frame_seconds)).round().max(1.0) as usize;
        let most = (settings.seconds / clip.frame_seconds).round() as usize;
        let first = clip.frames.len().saturating_sub(most) / 2;
        let cut = &clip.frames[first..(first + most).min(clip.frames.len())];
        let rate = 1.0 / (clip.frame_seconds * every as f64);
        let poses = truth(&model, cut, every).ok_or("a clip without a person")?;
        let others: Vec<&Prepared> = prepared.iter().filter(|other| other.subject != label.subject).collect();
        let recognizer = Recognizer::learn_prepared(&others, &options)?;
        let recorded = recorded(&path, first, cut.len())?;
        let (tracked, mut errors) = follow(&model, &poses, &settings, rate)?;
        let tracked = of_poses(&model, &tracked, rate)?;
        let names = [
            name(&recognizer, &recorded)?,
            name(&recognizer, &of_poses(&model, &poses, rate)?)?,
            name(&recognizer, &tracked)?,
            name(&shipped, &tracked)?,
        ];
        for (right, (name, _)) in right.iter_mut().zip(&names) {
            *right += usize::from(*name == label.class);
        }
        total += 1;
        errors.sort_by(f64::total_cmp);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        means.push(mean);
        let said =
            names.map(|(name, is_unknown)| if is_unknown { format!("{name} (strange)") } else { name });
        let worst = errors[(errors.len() * 95 / 100).min(errors.len() - 1)];
        println!("| {} | {} | {} | {mean:.0} | {worst:.0} |", label.name, label.class, said.join(" | "));
    }
    println!(
        "right of {total}: {right:?}; joints {:.0} mm",
        means.iter().sum::<f64>() / means.len().max(1) as f64
    );
    Ok(())
}

/// The same frames as they were recorded.
fn recorded(path: &Path, first: usize, count: usize) -> Result<JointMotion, Error> {
    let mut track = motion::read_joints(path, None)?;
    track.frames = track.frames.split_off(first);
    track.frames.truncate(count);
    motion_of(&track)
}
