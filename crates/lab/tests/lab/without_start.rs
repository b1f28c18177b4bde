//! A clothed figure is found where no start is known, and what stands in the way is said.

use std::sync::Arc;

use backlit_lab::experiment::starts::Draw;
use backlit_lab::synthetic::{Build, Figure, motion, silhouette, studio};
use backlit_tracking::body::{Kinematics, Model, Pose, Sides, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitError, FitOptions, FitView};
use backlit_tracking::metrics::leaf_error_mm;
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::search::start::Level;
use backlit_tracking::search::{
    Doubt, WithoutStartError, WithoutStartOptions, WithoutStartResult, without_start,
};
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::track::{Lost, Tracker};
use glam::DVec3;

/// Frames of the built-in movement, and which way about the vertical the figure is turned, radians.
const MOMENTS: [(f64, f64); 2] = [(8.0, 0.0), (32.0, 2.5)];

fn posed(model: &Model, (frame, turn): (f64, f64)) -> Pose {
    let mut pose = motion::pose(model, frame);
    let turn = glam::DQuat::from_rotation_z(turn);
    for (rotation, parent) in model.rotation_parents().iter().enumerate() {
        if parent.is_none() {
            pose.rotations[rotation] = (turn * pose.rotations[rotation]).normalize();
        }
    }
    pose
}

/// With half as many pixels across, for the sake of time.
fn cameras() -> Vec<Arc<Camera>> {
    studio::pinholes([studio::WIDTH / 2, studio::HEIGHT / 2]).unwrap()
}

fn views(model: &Model, pose: &Pose, cameras: &[usize]) -> Vec<FitView> {
    let figure = Figure::new(model, pose, Build::default()).unwrap();
    let all = self::cameras();
    let view =
        |&index: &usize| FitView::of_mask(all[index].clone(), silhouette(&figure, &all[index]).unwrap());
    cameras.iter().map(view).collect()
}

fn look(model: &Arc<Model>, views: &[FitView]) -> Result<WithoutStartResult, WithoutStartError> {
    without_start(model, views, &WithoutStartOptions::default(), &CancelToken::new())
}

#[test]
fn a_person_is_found_and_faces_the_right_way() {
    let model = Arc::new(builtin::full_body());
    for (moment, cameras) in MOMENTS.into_iter().zip([&[0, 1, 2, 3][..], &[0, 1]]) {
        let truth = posed(&model, moment);
        let found = look(&model, &views(&model, &truth, cameras)).unwrap();
        let error = mean_joint_error_mm(&model, found.pose(), &truth);
        assert!(error < 60.0, "{moment:?}, {} cameras: {error:.0} mm", cameras.len());
        assert_eq!((found.up, found.doubts.as_slice()), (DVec3::Z, &[] as &[Doubt]));
        let ahead = Sides::of(&model, &Kinematics::new(&model, &truth)).unwrap().ahead;
        let turned =
            |pose: &Pose| Sides::of(&model, &Kinematics::new(&model, pose)).unwrap().ahead.dot(ahead);
        assert!(turned(found.pose()) > 0.8);
        assert!(
            found.hypotheses[1..].iter().any(|other| turned(&other.pose) < -0.5),
            "the other way was tried"
        );
        // Of costs within 3 % the less wrung body comes first.
        assert!(found.hypotheses[1..].iter().all(|other| 1.03 * other.cost > found.hypotheses[0].cost));
        let heights = found.heights.unwrap();
        assert!((heights.ratio() - 1.0).abs() < 0.15, "{heights:?}");
    }
}

#[test]
fn a_small_person_is_found_by_the_body_scaled() {
    let model = Arc::new(builtin::full_body());
    let child = model.scaled(0.75).unwrap();
    let mut truth = posed(&model, MOMENTS[0]);
    truth.root.z *= 0.75;
    let views = views(&child, &truth, &[0, 1, 2, 3]);
    let choices = WithoutStartOptions { scale_body: true, ..WithoutStartOptions::default() };
    let found = without_start(&model, &views, &choices, &CancelToken::new()).unwrap();
    assert!((found.scale - 0.75).abs() < 0.09, "{} {:?}", found.scale, found.heights);
    let size = found.model.limbs()[0].length / model.limbs()[0].length;
    assert!((size - found.scale).abs() < 1e-9, "{size}");
    let error = |found: &WithoutStartResult| mean_joint_error_mm(&child, found.pose(), &truth);
    let average = look(&model, &views).unwrap();
    assert!(error(&found) < 0.8 * error(&average), "{:.0} mm, {:.0} mm", error(&found), error(&average));
}

/// The report's upper body has no limits and looks the same from the front and from the back.
#[test]
fn a_body_that_looks_the_same_from_behind_faces_the_cameras_and_that_is_said() {
    let levels = vec![Level { degrees: 20, metres: 0.1 }];
    let starts = Draw { starts: 4, levels, cameras: vec![4], ..Draw::default() }.draw().unwrap();
    for start in &starts {
        let found = look(&start.model, &start.views[&4]).unwrap();
        assert!(leaf_error_mm(&start.model, found.pose(), &start.truth) < 20.0);
        assert_eq!(found.doubts, [Doubt::FacingAssumed]);
        let facing = found.facings[0].unwrap();
        assert!(found.facings[1..].iter().any(|other| other.unwrap().dot(facing) < -0.5));
    }
}

#[test]
fn one_camera_does_what_it_can_and_says_so() {
    let model = Arc::new(builtin::full_body());
    let truth = posed(&model, MOMENTS[0]);
    let found = look(&model, &views(&model, &truth, &[0])).unwrap();
    assert!(found.doubts.contains(&Doubt::OneCamera) && found.heights.is_none());
    let camera = &cameras()[0];
    let [found, truth] = [found.pose(), &truth].map(|pose| camera.project(pose.root).unwrap());
    assert!(found.distance(truth) < 4.0, "{found} {truth}");
}

#[test]
fn what_cannot_be_is_said() {
    let model = Arc::new(builtin::full_body());
    let good = views(&model, &posed(&model, MOMENTS[0]), &[0, 1]);
    let with_mask = |mask: Mask| {
        let mut views = good.clone();
        views[1].evidence = Evidence::Mask(Arc::new(mask));
        views
    };
    let (width, height) = (good[1].camera.width(), good[1].camera.height());
    let nobody = Mask::filled(width, height, Label::Background).unwrap();
    let mut empty = with_mask(nobody.clone());
    empty[0].evidence = Evidence::Mask(Arc::new(nobody.clone()));
    let error = look(&model, &empty).unwrap_err();
    assert!(matches!(&error, WithoutStartError::Fit(FitError::NoData { .. })), "{error}");
    assert!(matches!(look(&model, &[]).unwrap_err(), WithoutStartError::Fit(FitError::NoData { .. })));
    assert_eq!(look(&model, &with_mask(nobody)).unwrap().doubts[0], Doubt::OneCamera);
    // Something in a corner that the other camera does not see.
    let corner = |index: usize| index % width < 6 && index / width < 6;
    let label = |index| if corner(index) { Label::Subject } else { Label::Background };
    let elsewhere = Mask::new(width, height, (0..width * height).map(label).collect()).unwrap();
    let error = look(&model, &with_mask(elsewhere)).unwrap_err();
    assert_eq!(error, WithoutStartError::Apart { cameras: vec!["cam1".to_owned(), "cam2".to_owned()] });
    assert!(error.to_string().contains("cam1, cam2"), "{error}");
    let look_with =
        |choices: WithoutStartOptions, cancel: &CancelToken| without_start(&model, &good, &choices, cancel);
    let cancel = CancelToken::new();
    for choices in [
        WithoutStartOptions { up: Some(DVec3::ZERO), ..WithoutStartOptions::default() },
        WithoutStartOptions { faces: Some(DVec3::NAN), ..WithoutStartOptions::default() },
        WithoutStartOptions { headings: 0, ..WithoutStartOptions::default() },
        WithoutStartOptions { trunks: 0, ..WithoutStartOptions::default() },
    ] {
        let error = look_with(choices, &cancel).unwrap_err();
        assert!(error.to_string().contains("expected"), "{error}");
    }
    cancel.cancel();
    assert_eq!(look_with(WithoutStartOptions::default(), &cancel).unwrap_err(), WithoutStartError::Cancelled);
}

#[test]
fn threads_change_nothing() {
    let levels = vec![Level { degrees: 20, metres: 0.1 }];
    let start = &Draw { starts: 1, levels, cameras: vec![2], ..Draw::default() }.draw().unwrap()[0];
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| look(&start.model, &start.views[&2])).unwrap()
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one, three);
    assert_eq!(one.hypotheses[0].cost.to_bits(), three.hypotheses[0].cost.to_bits());
}

#[test]
fn a_track_begins_where_somebody_appears() {
    let model = Arc::new(builtin::full_body());
    let truth = |frame: usize| posed(&model, (8.0 + frame as f64, 0.0));
    let mut tracker = Tracker::without_start(Arc::clone(&model), FitOptions::default()).unwrap();
    for frame in 0..4 {
        let mut views = views(&model, &truth(frame), &[0, 1]);
        if frame == 0 {
            for view in &mut views {
                let nobody = Mask::filled(view.camera.width(), view.camera.height(), Label::Background);
                view.evidence = Evidence::Mask(Arc::new(nobody.unwrap()));
            }
        }
        let found = tracker.track_frame(frame, views, &CancelToken::new()).unwrap();
        if frame == 0 {
            assert_eq!(found.lost_because, Some(Lost::Nobody));
            continue;
        }
        let error = mean_joint_error_mm(&model, &found.pose, &truth(frame));
        assert!(error < 60.0 && !found.is_lost(), "frame {frame}: {error:.0} mm {:?}", found.lost_because);
        assert_eq!(found.hypotheses.is_empty(), frame > 1, "one search");
    }
}
