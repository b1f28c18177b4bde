//! Recorded people followed by their silhouettes, with and without a prior learnt from others.
//!
//! Motion files are put on the average body ([`retarget`]), which moves on the spot before some cameras. Its masks are
//! those of its own capsules, widened all round, so that nothing but the silhouettes' ambiguity and their breadth is wrong. People whose
//! motion is followed must not be among those that the prior was learnt from: the caller sees to that.

use std::sync::Arc;
use std::time::Instant;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::prior::{BodyPoints, Clip};
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::statistics::Statistics;
use backlit_tracking::track::{Motion, Tracker, WhenToSearch};
use glam::DVec3;
use serde::Serialize;

use super::cues::Way;
use super::track::widened;
use super::{ExperimentError, Progress};
use crate::synthetic::{retarget, squats};

/// A joint that is farther off is lost, millimetres.
const LOST_MM: f64 = 150.0;
/// Words in the names of limbs that count.
const LIMBS: [&str; 5] = ["upper arm", "forearm", "hand", "thigh", "calf"];
/// The root's height when the body stands, metres.
const ROOT_HEIGHT: f64 = 0.92;
/// Grey level below which a pixel is the subject's.
const SUBJECT: f32 = 127.5;

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Where cameras stand, degrees to the left of straight ahead of where the person faces first.
    pub cameras_degrees: Vec<f64>,
    /// Seconds from frame to frame.
    pub every_seconds: f64,
    /// At most so many seconds of each motion.
    pub seconds: f64,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// How much too wide masks are all round, pixels.
    pub too_wide_px: f64,
    /// Seed of starts.
    pub seed: u64,
    /// The ways that are compared.
    pub ways: Vec<Way>,
}

/// One motion in one way. Errors are millimetres.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Case {
    /// The motion.
    pub motion: String,
    /// The way's name.
    pub way: String,
    /// Mean error of the ends of arms and legs.
    pub mean_mm: f64,
    /// 95 % of them lie below.
    pub p95_mm: f64,
    /// Share of them that is lost.
    pub lost: f64,
    /// Median time of a frame, milliseconds.
    pub frame_ms: f64,
    /// Frames.
    pub frames: usize,
}

/// Follows every motion in every way. Motions have a name each.
///
/// # Errors
/// Options that make no sense, motions without a person, or `cancel`.
pub fn run(
    motions: &[(String, Clip)],
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Vec<Case>, ExperimentError> {
    if !(options.every_seconds.is_finite() && options.every_seconds > 0.0) {
        let expected = "seconds above 0";
        return Err(ExperimentError::Option {
            option: "every_seconds",
            value: options.every_seconds,
            expected,
        });
    }
    let model = Arc::new(builtin::full_body());
    let cameras = squats::cameras_at(&options.cameras_degrees, options.size_px)?;
    let (mut cases, total) = (Vec::new(), motions.len() * options.ways.len());
    for (name, clip) in motions {
        let every = (options.every_seconds / clip.frame_seconds).round().max(1.0) as usize;
        let most = (options.seconds / clip.frame_seconds).round() as usize;
        let truth: Vec<Pose> = truth(&model, &clip.frames[..clip.frames.len().min(most)], every)
            .ok_or_else(|| ExperimentError::Footage(format!("{name} has no person")))?;
        let rate = 1.0 / (clip.frame_seconds * every as f64);
        for way in &options.ways {
            on_progress(Progress { done: cases.len(), total });
            cases.push(follow(name, &model, &cameras, &truth, rate, way, options, cancel)?);
        }
    }
    on_progress(Progress { done: total, total });
    Ok(cases)
}

/// The body's poses, on the spot and upright as recorded, facing along y in the first one.
fn truth(model: &Model, frames: &[BodyPoints], every: usize) -> Option<Vec<Pose>> {
    let first = retarget::pose(model, frames.first()?)?;
    // Motion files have y up.
    let upright = glam::DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let ahead = upright * (first.rotations[0] * DVec3::Y);
    let heading = glam::DQuat::from_rotation_z(ahead.x.atan2(ahead.y));
    let middle = |points: &BodyPoints| (points.hips[0] + points.hips[1]) / 2.0;
    let scale = ROOT_HEIGHT / middle(&frames[0]).y.abs().max(1e-6);
    let pose = |points: &BodyPoints| {
        let mut pose = retarget::pose(model, points)?;
        pose.rotations[0] = (heading * upright * pose.rotations[0]).normalize();
        pose.root = DVec3::Z * (middle(points).y * scale);
        Some(pose)
    };
    frames.iter().step_by(every).map(pose).collect()
}

#[expect(clippy::too_many_arguments, reason = "a motion, who sees it, and how it is followed")]
fn follow(
    name: &str,
    model: &Arc<Model>,
    cameras: &[Arc<Camera>],
    truth: &[Pose],
    rate: f64,
    way: &Way,
    options: &Options,
    cancel: &CancelToken,
) -> Result<Case, ExperimentError> {
    let start = perturb(model, &truth[0], 5f64.to_radians(), 0.03, options.seed);
    let mut tracker = Tracker::new(Arc::clone(model), way.fit.clone(), start)?
        .with_motion(Motion::Velocity, rate)?
        .with_search(WhenToSearch::WhenPoor);
    let (mut errors, mut ms) = (Vec::new(), Vec::new());
    for (number, pose) in truth.iter().enumerate() {
        let joints = Kinematics::new(model, pose);
        let views: Result<Vec<FitView>, ExperimentError> =
            cameras.iter().map(|camera| view(model, &joints, camera, options.too_wide_px)).collect();
        let views = views?;
        let began = Instant::now();
        let estimate = tracker.track_frame(number, views, cancel)?;
        ms.push(1e3 * began.elapsed().as_secs_f64());
        if cancel.is_cancelled() {
            return Err(ExperimentError::Cancelled);
        }
        let found = Kinematics::new(model, &estimate.pose);
        for (index, limb) in model.limbs().iter().enumerate() {
            if LIMBS.iter().any(|word| limb.name.contains(word)) {
                errors.push(1000.0 * found.ends()[index].distance(joints.ends()[index]));
            }
        }
    }
    let all = Statistics::of(&errors).ok_or_else(|| ExperimentError::Footage(format!("{name} is empty")))?;
    let lost = errors.iter().filter(|error| **error > LOST_MM).count();
    Ok(Case {
        motion: name.to_owned(),
        way: way.name.clone(),
        mean_mm: all.mean,
        p95_mm: all.p95,
        lost: lost as f64 / errors.len() as f64,
        frame_ms: Statistics::of(&ms).map_or(0.0, |all| all.median),
        frames: truth.len(),
    })
}

fn view(
    model: &Model,
    joints: &Kinematics,
    camera: &Arc<Camera>,
    too_wide_px: f64,
) -> Result<FitView, ExperimentError> {
    let view = View::new(model, joints, camera, RendererKind::Capsule, Ramp::Half);
    let label = |level: &f32| if *level < SUBJECT { Label::Subject } else { Label::Background };
    let labels = prediction::lambda(&view).iter().map(label).collect();
    let mask = widened(Mask::new(camera.width(), camera.height(), labels)?, too_wide_px)?;
    Ok(FitView { camera: Arc::clone(camera), evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 })
}

#[cfg(test)]
mod tests {
    use backlit_tracking::fit::FitOptions;

    use super::*;
    use crate::synthetic::occlusions::Occlusion;

    /// A recorded person, y up, who looks along z: the walk of [`Occlusion`], from the joints of its body.
    fn walk(frames: usize) -> Clip {
        let model = builtin::full_body();
        let at = |frame: usize| {
            let pose = Occlusion::WalkFromTheSide.pose(&model, frame as f64 / 30.0);
            let joints = Kinematics::new(&model, &pose);
            let end = |name: &str| {
                let p = joints.ends()[model.limb_index(name).unwrap()];
                DVec3::new(-p.x, p.z, p.y)
            };
            let pair = |name: &str| ["right", "left"].map(|side| end(&format!("{side} {name}")));
            BodyPoints {
                hips: pair("hip"),
                waist: end("spine"),
                neck: end("chest"),
                shoulders: pair("clavicle"),
                elbows: pair("upper arm"),
                wrists: pair("forearm"),
                knees: pair("lower thigh"),
                ankles: pair("lower calf"),
                toes: pair("foot"),
            }
        };
        Clip { frame_seconds: 1.0 / 30.0, frames: (0..frames).map(at).collect() }
    }

    #[test]
    fn a_walk_is_followed_by_four_cameras() {
        let way = Way { name: "plain".to_owned(), cues: None, fit: FitOptions::default() };
        let options = Options {
            cameras_degrees: vec![0.0, 90.0, 180.0, -90.0],
            every_seconds: 1.0 / 30.0,
            seconds: 0.2,
            size_px: [108, 192],
            too_wide_px: 0.0,
            seed: 1,
            ways: vec![way],
        };
        let motions = [("walk".to_owned(), walk(20))];
        let cases = run(&motions, &options, &CancelToken::new(), |_| {}).unwrap();
        assert_eq!((cases.len(), cases[0].frames), (1, 6));
        assert!(cases[0].mean_mm < 25.0 && cases[0].lost == 0.0, "{cases:?}");
    }
}
