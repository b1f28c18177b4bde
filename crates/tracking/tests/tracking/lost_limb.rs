//! One limb that leaves its place between two frames: hardly any overlap is lost, yet the tracker notices by the cost,
//! and finds the limb again in the same frame where it may search.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::CueOptions;
use backlit_tracking::fit::{FitOptions, FitView, Preset};
use backlit_tracking::geometry::rotation;
use backlit_tracking::track::{
    FrameEstimate, KalmanOptions, LOST_BELOW_IOU, Lost, Motion, Tracker, TrackerMemory, WhenToSearch,
};
use glam::DVec3;

use crate::fixtures;

/// The frame in which the arm is elsewhere.
const JUMP: usize = 8;

/// A body that sways a little; from [`JUMP`] on with one arm swung up, as after missing frames.
fn truth(model: &Model, frame: usize) -> Pose {
    let mut pose = Pose::rest(model);
    pose.root.x += 0.004 * frame as f64;
    if frame >= JUMP {
        let arm = model.limbs()[model.limb_index("right upper arm").unwrap()].rotation;
        pose.rotations[arm] = rotation::exp(DVec3::new(0.0, 0.0, -2.3)) * pose.rotations[arm];
    }
    pose
}

fn views(model: &Model, pose: &Pose) -> Vec<FitView> {
    let cameras = fixtures::camera_pair(fixtures::FRONT_AND_RIGHT, [192, 144], 260.0, DVec3::NEG_Y);
    cameras.map(|camera| fixtures::fit_view(model, pose, camera)).into()
}

fn tracker(model: &Arc<Model>, search: WhenToSearch) -> Tracker {
    let options = FitOptions::preset(Preset::Robust);
    Tracker::new(Arc::clone(model), options, truth(model, 0)).unwrap().with_search(search)
}

fn track(search: WhenToSearch) -> (Arc<Model>, Vec<FrameEstimate>) {
    let model = Arc::new(builtin::upper_body());
    let mut tracker = tracker(&model, search);
    let frames = (0..JUMP + 3).map(|frame| {
        tracker.track_frame(frame, views(&model, &truth(&model, frame)), &CancelToken::new()).unwrap()
    });
    let frames = frames.collect();
    (model, frames)
}

fn wrist_error_mm(model: &Model, frame: &FrameEstimate) -> f64 {
    let wrist = model.limb_index("right forearm").unwrap();
    let end = |pose: &Pose| Kinematics::new(model, pose).ends()[wrist];
    1000.0 * end(&frame.pose).distance(end(&truth(model, frame.frame)))
}

#[test]
fn a_lost_arm_is_noticed_by_the_cost_alone() {
    let (model, frames) = track(WhenToSearch::Never);
    let lost: Vec<bool> = frames[..JUMP].iter().map(|frame| frame.is_lost()).collect();
    assert!(!lost.contains(&true), "{lost:?}");
    let jump = &frames[JUMP];
    assert!(wrist_error_mm(&model, jump) > 150.0, "found without a search: the test says nothing");
    assert!(jump.iou().unwrap() > LOST_BELOW_IOU);
    assert!(matches!(jump.lost_because, Some(Lost::Cost { .. })), "{:?} {:?}", jump.lost_because, jump.rms);
    assert!(jump.is_lost());
}

#[test]
fn a_lost_arm_is_found_again_in_the_same_frame() {
    let (model, frames) = track(WhenToSearch::WhenPoor);
    for frame in &frames {
        let error = wrist_error_mm(&model, frame);
        let (at, because) = (frame.frame, &frame.lost_because);
        assert!(error < 30.0 && !frame.is_lost(), "frame {at}: {error:.0} mm, {because:?}");
    }
}

/// Up to the frame before the jump, whose cost is judged by all frames before it; and from a lost frame on. Whatever carries the
/// motion on.
#[test]
fn a_track_goes_on_from_a_memory_to_the_bit() {
    let model = Arc::new(builtin::upper_body());
    for motion in [Motion::Velocity, Motion::Kalman(KalmanOptions::default())] {
        let begin = || tracker(&model, WhenToSearch::Never).with_motion(motion, 30.0).unwrap();
        let mut whole = begin();
        assert_eq!(whole.memory(), None);
        let (mut frames, mut memories) = (Vec::new(), Vec::new());
        for frame in 0..JUMP + 3 {
            let views = views(&model, &truth(&model, frame));
            frames.push(whole.track_frame(frame, views, &CancelToken::new()).unwrap());
            memories.push(whole.memory().unwrap());
        }
        assert!(frames[JUMP].is_lost(), "else the test says less");
        for done in [JUMP, JUMP + 1] {
            let mut again = begin().with_memory(memories[done - 1].clone()).unwrap();
            for expected in &frames[done..] {
                let views = views(&model, &truth(&model, expected.frame));
                let found = again.track_frame(expected.frame, views, &CancelToken::new()).unwrap();
                assert_eq!(&found, expected, "frame {} after {done}, {motion:?}", expected.frame);
                assert_eq!(again.memory().as_ref(), Some(&memories[expected.frame]));
            }
        }
    }
}

#[test]
fn a_memory_that_does_not_fit_is_refused() {
    let model = Arc::new(builtin::upper_body());
    let begin = |motion| tracker(&model, WhenToSearch::Never).with_motion(motion, 30.0).unwrap();
    let kalman = Motion::Kalman(KalmanOptions::default());
    let mut filtered = begin(kalman);
    filtered.track_frame(0, views(&model, &truth(&model, 0)), &CancelToken::new()).unwrap();
    let memory = filtered.memory().unwrap();
    let refused = |change: fn(&mut TrackerMemory)| {
        let mut memory = memory.clone();
        change(&mut memory);
        begin(kalman).with_memory(memory).unwrap_err().to_string()
    };
    for (change, expected) in [
        ((|memory| memory.filter = None) as fn(&mut TrackerMemory), "tracked without a Kalman filter"),
        (|memory| memory.last.velocity = Some(vec![0.0]), "`velocity` has 1 numbers; expected 27"),
        (|memory| memory.last.pose.rotations.clear(), "`pose`: `rotations` has 0"),
        (|memory| memory.usual.last.extend([1.0; 11]), "`usual_rms` is"),
        (|memory| memory.usual.last.push_back(f64::NAN), "`usual_rms` is NaN"),
        (|memory| memory.usual.too_high = 10, "`usual_rms` is 10"),
        (|memory| memory.last_resort.wait = 1, "`last_resort` is 1"),
        (|memory| memory.last_resort.waited = 17, "`last_resort` is 17"),
        (|memory| memory.filter.as_mut().unwrap().noise.memory = 0.0, "`filter.noise`: `kalman.memory` is 0"),
        (
            |memory| memory.filter.as_mut().unwrap().belief.covariance[(3, 4)] = 1e13,
            "`filter.covariance` is 1",
        ),
        (|memory| memory.filter.as_mut().unwrap().belief.velocity[2] = f64::NAN, "`filter.velocity` is NaN"),
    ] {
        let message = refused(change);
        assert!(message.contains(expected), "{message}; expected {expected}");
    }
    let message = begin(Motion::Velocity).with_memory(memory.clone()).unwrap_err().to_string();
    assert!(message.contains("tracked with a Kalman filter"), "{message}");
    let cued = begin(kalman).with_cues(CueOptions::default()).unwrap();
    assert!(cued.with_memory(memory).unwrap_err().to_string().contains("without cues"));
}
