//! Cues beside silhouettes: an arm before the trunk, which silhouettes lose, is held by keypoints, and what nothing held is
//! said; without any cue nothing changes, to the bit.

use std::sync::Arc;

use backlit_lab::synthetic::{capsules, squats};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{
    CameraCues, Cue, CueError, CueOptions, CuePull, CueSet, CueTarget, CueWatch, FrameCues, GreyPicture,
    JointKeypoint, KeypointOffsets, WatchedCamera,
};
use backlit_tracking::fit::{Evidence, Fit, FitError, FitOptions, FitView};
use backlit_tracking::render::RendererKind;
use backlit_tracking::residual::Loss;
use backlit_tracking::silhouette::{Label, Mask, SignedDistance};
use backlit_tracking::track::{FrameEstimate, KalmanOptions, Motion, Tracker};
use glam::{DVec2, DVec3};

const RATE: f64 = 15.0;
const SIZE: [u64; 2] = [90, 160];
const JOINTS: [&str; 6] =
    ["left clavicle", "right clavicle", "left upper arm", "right upper arm", "left forearm", "right forearm"];

/// The silhouettes of a pose, a pixel too wide all round.
fn views(model: &Model, pose: &Pose, cameras: &[Arc<Camera>]) -> Vec<FitView> {
    let view = |camera: &Arc<Camera>| {
        let mask = capsules::hard_mask(model, pose, camera).unwrap();
        let distances = SignedDistance::from_mask(&mask);
        let (width, height) = (mask.width(), mask.height());
        let label = |&distance: &f32| if distance < 1.3 { Label::Subject } else { Label::Background };
        let labels = distances.values()[..width * height].iter().map(label).collect();
        let mask = Arc::new(Mask::new(width, height, labels).unwrap());
        FitView { camera: Arc::clone(camera), evidence: Evidence::Mask(mask), weight: 1.0 }
    };
    cameras.iter().map(view).collect()
}

/// Where the arms' joints are, each so far off in the world.
fn keypoints(model: &Model, pose: &Pose, cameras: &[Arc<Camera>], off: DVec3) -> FrameCues {
    let joints = Kinematics::new(model, pose);
    let of_camera = |camera: &Arc<Camera>| {
        let keypoint = |name: &&str| {
            let limb = model.limb_index(name).unwrap();
            let turn = joints.world_rotations()[model.limbs()[limb].rotation];
            let pixel = camera.project(joints.ends()[limb] + turn * off).unwrap();
            JointKeypoint { limb, pixel, score: 0.9 }
        };
        CameraCues { keypoints: JOINTS.iter().map(keypoint).collect(), picture: None }
    };
    FrameCues { cameras: cameras.iter().map(of_camera).collect() }
}

fn squatting(frames: usize, options: Option<CueOptions>, cues: bool) -> (Arc<Model>, Vec<FrameEstimate>) {
    let model = Arc::new(builtin::full_body());
    let cameras = squats::cameras(SIZE).unwrap();
    let truth = |frame: usize| squats::pose(&model, frame as f64 / RATE);
    let mut tracker = Tracker::new(Arc::clone(&model), FitOptions::default(), truth(0)).unwrap();
    if let Some(options) = options {
        tracker = tracker.with_cues(options).unwrap();
    }
    let frames = (0..frames).map(|frame| {
        let pose = truth(frame);
        let seen = if cues { keypoints(&model, &pose, &cameras, DVec3::ZERO) } else { FrameCues::default() };
        let views = views(&model, &pose, &cameras);
        tracker.track_frame_with_cues(frame, views, seen, &CancelToken::new()).unwrap()
    });
    let frames = frames.collect();
    (model, frames)
}

/// Mean error of the wrists, metres.
fn wrists(model: &Model, frames: &[FrameEstimate]) -> f64 {
    let error = |estimate: &FrameEstimate| {
        let truth = squats::pose(model, estimate.frame as f64 / RATE);
        let [found, truth] = [&estimate.pose, &truth].map(|pose| Kinematics::new(model, pose));
        let of = |name| {
            let limb: usize = model.limb_index(name).unwrap();
            found.ends()[limb].distance(truth.ends()[limb])
        };
        0.5 * (of("right forearm") + of("left forearm"))
    };
    frames.iter().map(error).sum::<f64>() / frames.len() as f64
}

#[test]
fn keypoints_hold_arms_that_silhouettes_lose() {
    let (model, alone) = squatting(24, None, false);
    let (_, cued) = squatting(24, Some(CueOptions::default().only(&[Cue::Keypoints])), true);
    let [alone, held] = [&alone, &cued].map(|frames| wrists(&model, frames));
    assert!(alone > 0.08 && held < 0.03, "wrists {alone:.3} m off alone, {held:.3} m with keypoints");
    let forearm = model.limb_index("right forearm").unwrap();
    let of_forearm =
        |estimate: &FrameEstimate| estimate.holds.iter().find(|hold| hold.limb == forearm).unwrap().clone();
    let covered = cued.iter().map(of_forearm).filter(|hold| !hold.by_silhouettes).count();
    let held = cued.iter().map(of_forearm).filter(|hold| hold.cues == [Cue::Keypoints]).count();
    assert!(covered >= 5 && held + 2 >= covered, "{covered} covered, {held} held");
}

/// A tracker that watches and sees no cue says what is unsure, and its poses are those of one that does not, to the bit.
#[test]
fn without_cues_nothing_changes_and_covered_limbs_are_unsure() {
    let (_, plain) = squatting(16, None, false);
    let (model, watched) = squatting(16, Some(CueOptions::default()), false);
    for (plain, watched) in plain.iter().zip(&watched) {
        let [plain_fit, watched_fit] = [plain, watched].map(|one| (&one.pose, one.cost, one.iterations));
        assert_eq!(plain_fit, watched_fit);
        assert!(plain.holds.is_empty() && plain.unsure_limbs().next().is_none());
        assert_eq!(watched.holds.len(), model.rotation_count());
        assert!(watched.holds.iter().all(|hold| hold.cues.is_empty()));
    }
    let forearm = model.limb_index("right forearm").unwrap();
    assert!(watched[14..].iter().all(|estimate| estimate.unsure_limbs().any(|limb| limb == forearm)));
    assert!(watched[0].unsure_limbs().all(|limb| limb != forearm), "{:?}", watched[0].holds);
}

/// An offset that keypoints keep is learnt where silhouettes hold the limb, and only there.
#[test]
fn offsets_of_keypoints_are_learnt() {
    let model = Arc::new(builtin::full_body());
    let cameras = squats::cameras(SIZE).unwrap();
    let off = DVec3::new(0.02, 0.0, -0.03);
    let options = CueOptions::default();
    let learnt = |seconds: f64| {
        let mut watch = CueWatch::new(Arc::clone(&model), options, RendererKind::Capsule).unwrap();
        let pose = squats::pose(&model, seconds);
        let mask = |view: FitView| match view.evidence {
            Evidence::Mask(mask) => WatchedCamera { camera: view.camera, mask: Some(mask) },
            Evidence::Measurement(_) => panic!("a mask"),
        };
        let watched: Vec<WatchedCamera> = views(&model, &pose, &cameras).into_iter().map(mask).collect();
        let cues = keypoints(&model, &pose, &cameras, off);
        for _ in 0..20 {
            watch.update(watched.clone(), cues.clone(), &pose);
            watch.learn(&pose, true);
        }
        let mut offsets = KeypointOffsets::new(model.limbs().len(), options.offset_m);
        offsets.remember(&watch.memory().offsets);
        offsets.offset(model.limb_index("right forearm").unwrap())
    };
    let found = learnt(0.0);
    assert!(found.distance(off) < 0.012, "{found}");
    assert_eq!(learnt(0.5 * squats::PERIOD), DVec3::ZERO, "before the trunk it would confirm itself");
}

/// A ground that wanders, so that flow has something to follow.
fn pictures(frame: usize, cameras: &[Arc<Camera>]) -> FrameCues {
    let grey = |x: u32, y: u32| {
        let [x, y] = [f64::from(x) + 0.4 * frame as f64, f64::from(y)];
        image::Luma([(128.0 + 60.0 * (0.7 * x + 0.1 * y).sin() + 60.0 * (0.5 * y - 0.2 * x).cos()) as u8])
    };
    let picture = |camera: &Arc<Camera>| {
        let image = image::GrayImage::from_fn(camera.width() as u32, camera.height() as u32, grey);
        CameraCues { keypoints: Vec::new(), picture: Some(Arc::new(GreyPicture::of_image(&image).unwrap())) }
    };
    FrameCues { cameras: cameras.iter().map(picture).collect() }
}

/// With a memory, and shown its last frame's pictures again, a tracker goes on as if nothing had stopped it: keypoints' offsets
/// and flow too.
#[test]
fn what_cues_have_learnt_is_remembered() {
    const DONE: usize = 12;
    let model = Arc::new(builtin::full_body());
    let cameras = squats::cameras(SIZE).unwrap();
    let truth = |frame: usize| squats::pose(&model, frame as f64 / RATE);
    let cues = |frame: usize| {
        let mut cues = pictures(frame, &cameras);
        let points = keypoints(&model, &truth(frame), &cameras, DVec3::new(0.02, 0.0, -0.03));
        for (cues, points) in cues.cameras.iter_mut().zip(points.cameras) {
            cues.keypoints = points.keypoints;
        }
        cues
    };
    let begin = || {
        let tracker = Tracker::new(Arc::clone(&model), FitOptions::default(), truth(0)).unwrap();
        let options = CueOptions::default().only(&[Cue::Keypoints, Cue::Flow]);
        tracker
            .with_motion(Motion::Kalman(KalmanOptions::default()), RATE)
            .unwrap()
            .with_cues(options)
            .unwrap()
    };
    let views = |frame: usize| views(&model, &truth(frame), &cameras);
    let track = |tracker: &mut Tracker, frame| {
        tracker.track_frame_with_cues(frame, views(frame), cues(frame), &CancelToken::new()).unwrap()
    };
    let mut whole = begin();
    (0..DONE).for_each(|frame| drop(track(&mut whole, frame)));
    let memory = whole.memory().unwrap();
    let remembered = memory.cues.as_ref().unwrap();
    assert!(remembered.before.is_some() && remembered.offsets.iter().flatten().any(|number| *number != 0.0));
    let again = || begin().with_memory(memory.clone()).unwrap();
    let mut shown = again().with_pictures_before(&views(DONE - 1), cues(DONE - 1));
    let mut forgetful = memory.clone();
    forgetful.cues.as_mut().unwrap().offsets.fill([0.0; 12]);
    let mut others = [again(), begin().with_memory(forgetful).unwrap()];
    let mut poses = [Vec::new(), Vec::new(), Vec::new()];
    for frame in DONE..DONE + 4 {
        let expected = track(&mut whole, frame);
        assert_eq!(track(&mut shown, frame), expected, "frame {frame}");
        poses[0].push(expected.pose);
        poses[1].push(track(&mut others[0], frame).pose);
        poses[2].push(track(&mut others[1], frame).pose);
    }
    assert!(poses[0] != poses[1], "the pictures of the frame before decide something");
    assert!(poses[0] != poses[2], "the offsets decide something");
}

#[test]
fn pulls_that_cannot_be_are_errors_and_options_are_named() {
    let model = Arc::new(builtin::full_body());
    let cameras = squats::cameras(SIZE).unwrap();
    let pose = squats::pose(&model, 0.0);
    let pull = |limb, camera, x: f64| CuePull {
        cue: Cue::Keypoints,
        limb,
        target: CueTarget::Pixel { camera, arm: DVec3::ZERO, pixel: DVec2::new(x, 3.0) },
        metres_per_px: 0.01,
        weight: 1.0,
        loss: Loss::Squares,
    };
    let fit = |pull| {
        let views = views(&model, &pose, &cameras);
        let fit = Fit::new(Arc::clone(&model), views, pose.clone(), FitOptions::default()).unwrap();
        let set = CueSet { cameras: cameras.clone(), pulls: vec![pull] };
        fit.with_cues(Arc::new(set)).map(|_| ())
    };
    assert_eq!(fit(pull(0, 1, 2.0)), Ok(()));
    let error = |error| Err(FitError::Cue(error));
    let cue = "keypoints";
    assert_eq!(fit(pull(30, 0, 2.0)), error(CueError::Limb { index: 0, cue, limb: 30, limbs: 30 }));
    assert_eq!(fit(pull(0, 2, 2.0)), error(CueError::Camera { index: 0, cue, camera: 2, cameras: 2 }));
    assert_eq!(fit(pull(0, 0, f64::NAN)), error(CueError::Number { index: 0, cue: "keypoints" }));
    let mut options = CueOptions::default();
    options.coverage.seen_share = 1.5;
    let tracker = Tracker::new(Arc::clone(&model), FitOptions::default(), pose.clone()).unwrap();
    let error = tracker.with_cues(options).unwrap_err();
    assert!(error.to_string().contains("coverage.seen_share"), "{error}");
}

/// Keypoints of limbs and cameras that are not there, scores that are no numbers: left out, without a panic.
#[test]
fn keypoints_that_make_no_sense_do_not_pull() {
    let model = Arc::new(builtin::full_body());
    let cameras = squats::cameras(SIZE).unwrap();
    let pose = squats::pose(&model, 1.0);
    let bad = |limb, x, score| JointKeypoint { limb, pixel: DVec2::new(x, 20.0), score };
    let keypoints =
        vec![bad(99, 20.0, 0.9), bad(3, f64::NAN, 0.9), bad(3, 20.0, f64::NAN), bad(3, 20.0, 0.1)];
    let cues = CameraCues { keypoints, picture: None };
    let cues = FrameCues { cameras: vec![cues; 5] };
    let mut watch = CueWatch::new(Arc::clone(&model), CueOptions::default(), RendererKind::Capsule).unwrap();
    let watched =
        cameras.iter().map(|camera| WatchedCamera { camera: Arc::clone(camera), mask: None }).collect();
    assert_eq!(watch.update(watched, cues, &pose).pulls, []);
}
