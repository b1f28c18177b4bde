//! Footage that says little or nonsense: a clear outcome, never a panic or a NaN, and nothing lost that was tracked.

use std::sync::Arc;

use backlit_tracking::body::{Model, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, Fit, FitError, FitOptions, FitView, Preset};
use backlit_tracking::metrics::{JointErrors, mean_joint_error_mm};
use backlit_tracking::optimize::Termination;
use backlit_tracking::silhouette::{Label, Mask, Measurement};
use backlit_tracking::track::{FrameEstimate, Lost, Track, Tracker};
use glam::DVec3;

use crate::fixtures::{LEFT_AND_RIGHT, camera_pair, mask, stepped};

const SIZE: [usize; 2] = [80, 60];

fn cameras() -> [Arc<Camera>; 2] {
    camera_pair(LEFT_AND_RIGHT, SIZE.map(|side| side as u64), 105.0, DVec3::Y)
}

/// Where the body is in a frame: it turns and moves a little.
fn truth(model: &Model, frame: usize) -> Pose {
    let time = frame as f64;
    stepped(model, Parameters::Tangent, |index| match index {
        0 => 0.01 * time,
        1 | 2 => 0.0,
        _ => 0.2 * (index as f64 * 1.7).sin() + 0.02 * time * (index as f64).cos(),
    })
}

fn filled(label: Label) -> Mask {
    Mask::filled(SIZE[0], SIZE[1], label).unwrap()
}

fn views(masks: [Mask; 2]) -> Vec<FitView> {
    cameras().into_iter().zip(masks).map(|(camera, mask)| FitView::of_mask(camera, mask)).collect()
}

fn seen(model: &Model, frame: usize) -> [Mask; 2] {
    cameras().map(|camera| mask(model, &truth(model, frame), &camera))
}

fn error_mm(model: &Model, frame: usize, pose: &Pose) -> f64 {
    mean_joint_error_mm(model, pose, &truth(model, frame))
}

/// The same but for the rounding of unit quaternions.
fn is_same(a: &Pose, b: &Pose) -> bool {
    a.local(b).iter().all(|x| x.abs() < 1e-12)
}

fn assert_finite(estimate: &FrameEstimate) {
    assert!([estimate.cost, estimate.rms].iter().flatten().all(|value| value.is_finite()), "{estimate:?}");
    assert!(estimate.pose.to_state().iter().all(|x| x.is_finite()), "{estimate:?}");
    assert!(estimate.iou().is_none_or(|iou| (0.0..=1.0).contains(&iou)), "{estimate:?}");
}

/// Tracks frames 0, 1, 2 …; `spoil` may change what the cameras saw.
fn track(preset: Preset, frames: usize, spoil: impl Fn(usize, &mut [Mask; 2])) -> (Arc<Model>, Track) {
    let model = Arc::new(builtin::upper_body());
    let start = truth(&model, 0);
    let mut tracker = Tracker::new(Arc::clone(&model), FitOptions::preset(preset), start).unwrap();
    let mut track = Track::default();
    for frame in 0..frames {
        let mut masks = seen(&model, frame);
        spoil(frame, &mut masks);
        let estimate = tracker.track_frame(frame, views(masks), &CancelToken::new()).unwrap();
        assert_finite(&estimate);
        track.frames.insert(frame, estimate);
    }
    (model, track)
}

#[test]
fn a_camera_that_sees_nobody_is_left_out_and_named() {
    for nobody in [Label::Background, Label::Unknown] {
        let (model, track) = track(Preset::Robust, 5, |frame, masks| {
            if (2..4).contains(&frame) {
                masks[1] = filled(nobody);
            }
        });
        for (frame, estimate) in &track.frames {
            let expected: &[&str] = if (2..4).contains(frame) { &["right"] } else { &[] };
            assert_eq!(estimate.empty_cameras, expected, "frame {frame}");
            assert!(!estimate.is_lost(), "frame {frame} is lost: {:?}", estimate.iou());
            assert_eq!(estimate.overlap[1].is_none(), (2..4).contains(frame), "frame {frame}");
            let error = error_mm(&model, *frame, &estimate.pose);
            assert!(error < 60.0, "frame {frame}: {error:.0} mm");
        }
    }
}

#[test]
fn frames_in_which_nobody_is_seen_are_lost_and_tracking_goes_on() {
    for preset in Preset::ALL {
        let (model, track) = track(preset, 8, |frame, masks| {
            if (3..5).contains(&frame) {
                *masks = [filled(Label::Background), filled(Label::Unknown)];
            }
        });
        let lost: Vec<usize> =
            track.frames.values().filter(|found| found.is_lost()).map(|found| found.frame).collect();
        assert_eq!(lost, [3, 4], "{preset}");
        for frame in [3, 4] {
            let found = &track.frames[&frame];
            assert_eq!(found.empty_cameras, ["left", "right"], "{preset}");
            assert_eq!((found.iterations, found.termination, found.iou()), (0, None, None), "{preset}");
            assert_eq!((found.cost, found.rms), (None, None), "{preset}: nobody is not a perfect fit");
            // What is predicted is not far off, and it does not run away.
            assert!(error_mm(&model, frame, &found.pose) < 120.0, "{preset}, frame {frame}");
        }
        assert_eq!(track.frames[&3].pose, track.frames[&4].pose, "{preset}: a lost body moves on");
        if preset == Preset::Robust {
            for frame in [2, 5, 6, 7] {
                let error = error_mm(&model, frame, &track.frames[&frame].pose);
                assert!(error < 30.0, "frame {frame}: {error:.0} mm");
            }
        }
    }
}

#[test]
fn masks_of_the_whole_picture_are_survived() {
    for preset in Preset::ALL {
        let (_, track) = track(preset, 4, |frame, masks| {
            if frame == 1 {
                *masks = [filled(Label::Subject), filled(Label::Subject)];
            }
        });
        assert!(track.frames[&1].is_lost(), "{preset}: {:?}", track.frames[&1].iou());
        assert!(track.frames[&1].termination.is_some(), "{preset}");
    }
}

#[test]
fn nobody_in_the_first_frame_or_in_any() {
    let (_, track) =
        track(Preset::Robust, 3, |_, masks| *masks = [filled(Label::Background), filled(Label::Background)]);
    let model = builtin::upper_body();
    for estimate in track.frames.values() {
        assert!(estimate.is_lost());
        assert_eq!(estimate.pose, truth(&model, 0).normalized());
    }
}

/// The body goes to where the silhouettes are, turned as it was, and the robust preset finds it from there.
#[test]
fn a_start_behind_every_camera_is_lost_and_says_why() {
    let model = Arc::new(builtin::upper_body());
    for preset in Preset::ALL {
        let mut start = truth(&model, 0);
        start.root = DVec3::new(0.0, 0.0, 50.0);
        let mut tracker =
            Tracker::new(Arc::clone(&model), FitOptions::preset(preset), start.clone()).unwrap();
        let estimate = tracker.track_frame(0, views(seen(&model, 0)), &CancelToken::new()).unwrap();
        assert_finite(&estimate);
        assert!(estimate.is_lost(), "{preset}");
        assert_eq!(estimate.lost_because, Some(Lost::OutOfScene), "{preset}");
        assert!(estimate.pose.root.distance(truth(&model, 0).root) < 3.0, "{preset}: {}", estimate.pose.root);
        let moved = Pose { root: estimate.pose.root, ..start.clone() };
        assert!(is_same(&estimate.pose, &moved), "{preset}: the body turned");
        let next = tracker.track_frame(1, views(seen(&model, 1)), &CancelToken::new()).unwrap();
        let off_m = next.pose.root.distance(truth(&model, 1).root);
        let is_there = !next.is_lost() && off_m < 0.1;
        // The report's narrow ramps do not reach as far.
        assert!(
            is_there || preset == Preset::Report && off_m < 3.0,
            "{off_m} m off, {:?}",
            next.lost_because
        );
    }
}

#[test]
fn data_of_another_size_change_nothing_that_was_tracked() {
    let model = Arc::new(builtin::upper_body());
    let options = FitOptions::preset(Preset::Robust);
    let mut tracker = Tracker::new(Arc::clone(&model), options, truth(&model, 0)).unwrap();
    tracker.track_frame(0, views(seen(&model, 0)), &CancelToken::new()).unwrap();
    let next = tracker.start_of(1);
    let small = || Mask::filled(3, 3, Label::Subject).unwrap();
    let found = tracker.track_frame(1, views([small(), small()]), &CancelToken::new());
    assert!(matches!(found, Err(FitError::Size { camera, .. }) if camera == "left"));
    assert_eq!(tracker.start_of(1), next);
    let estimate = tracker.track_frame(1, views(seen(&model, 1)), &CancelToken::new()).unwrap();
    assert!(!estimate.is_lost() && error_mm(&model, 1, &estimate.pose) < 30.0);
}

#[test]
fn no_camera_weights_of_nothing_and_stopped_work() {
    let model = Arc::new(builtin::upper_body());
    let start = truth(&model, 0);
    for preset in Preset::ALL {
        let options = FitOptions::preset(preset);
        let new = |views: Vec<FitView>| Fit::new(Arc::clone(&model), views, start.clone(), options.clone());
        assert!(matches!(new(Vec::new()), Err(FitError::NoData { .. })));
        let mut weightless = views(seen(&model, 0));
        weightless.iter_mut().for_each(|view| view.weight = 0.0);
        assert!(matches!(new(weightless.clone()), Err(FitError::NoData { .. })));
        weightless[0].weight = f64::NAN;
        assert!(matches!(new(weightless), Err(FitError::Weight { .. })));
        // Grey levels that weigh nothing, and such that no body can explain.
        let pixels = SIZE[0] * SIZE[1];
        for (level, weight, has_data) in [(0.0, 0.0, false), (0.0, 1.0, true), (-1e30, 1e30, true)] {
            let data = Measurement::new(SIZE[0], SIZE[1], vec![level; pixels], vec![weight; pixels]).unwrap();
            let mut views = views(seen(&model, 0));
            views.iter_mut().for_each(|view| view.evidence = Evidence::Measurement(Arc::new(data.clone())));
            match new(views) {
                Ok(mut fit) => {
                    let summary = fit.run(&CancelToken::new(), |_| {});
                    assert!(has_data, "{preset}: {level} × {weight}");
                    let state = summary.pose.to_state();
                    assert!(state.iter().all(|x| x.is_finite()), "{preset}: {level} × {weight}");
                }
                Err(error) => assert!(!has_data, "{preset}: {error}"),
            }
        }
        let stopped = CancelToken::new();
        stopped.cancel();
        let mut tracker = Tracker::new(Arc::clone(&model), options.clone(), start.clone()).unwrap();
        let estimate = tracker.track_frame(0, views(seen(&model, 0)), &stopped).unwrap();
        assert_eq!((estimate.termination, estimate.iterations), (Some(Termination::Cancelled), 0));
        assert!(is_same(&estimate.pose, &start), "{preset}");
    }
}

#[test]
fn no_frames_have_no_statistics() {
    assert_eq!(JointErrors::default().overall(), None);
    assert!(JointErrors::default().by_joint().is_empty());
    assert!(Track::default().frames.is_empty());
}
