//! A start that faces the wrong way: silhouettes hardly tell, a fit never crosses over, and the search must.

use std::sync::Arc;

use backlit_lab::synthetic::{Build, Figure, motion, silhouette, studio};
use backlit_tracking::body::{Kinematics, Model, Pose, Sides, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView, Preset};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::posing::turn_round;
use backlit_tracking::search::{Origin, SearchOptions, SearchResult, search};

/// Frames of the built-in movement, far apart.
const FRAMES: [usize; 3] = [0, 24, 48];

fn views(model: &Model, pose: &Pose, cameras: usize) -> Vec<FitView> {
    let figure = Figure::new(model, pose, Build::default()).unwrap();
    let view = |camera: &backlit_tracking::camera::Camera| {
        let camera = camera.without_distortion();
        let mask = silhouette(&figure, &camera).unwrap();
        FitView::of_mask(camera, mask)
    };
    studio::cameras().cameras().iter().take(cameras).map(view).collect()
}

fn search_from(model: &Arc<Model>, start: &Pose, views: Vec<FitView>, turned: bool) -> SearchResult {
    let effort = SearchOptions { turned, ..SearchOptions::default() };
    let options = FitOptions::preset(Preset::Robust);
    search(model, views, start, &options, &effort, &CancelToken::new()).unwrap()
}

#[test]
fn a_search_from_a_body_turned_round_finds_the_way_it_faces() {
    let model = Arc::new(builtin::full_body());
    for cameras in [2, 4] {
        for frame in FRAMES {
            let truth = motion::pose(&model, frame as f64);
            let start = turn_round(&model, &truth);
            let found = search_from(&model, &start, views(&model, &truth, cameras), true);
            let best = &found.hypotheses[0];
            let ahead = |pose| Sides::of(&model, &Kinematics::new(&model, pose)).unwrap().ahead;
            assert!(ahead(&best.pose).dot(ahead(&truth)) > 0.5, "{cameras} cameras, frame {frame}");
            let error = mean_joint_error_mm(&model, &best.pose, &truth);
            assert!(error < 60.0, "{cameras} cameras, frame {frame}: {error:.0} mm, {:?}", best.origin);
        }
    }
}

#[test]
fn without_the_turned_candidate_it_stays_turned_round() {
    let model = Arc::new(builtin::full_body());
    let truth = motion::pose(&model, FRAMES[0] as f64);
    let start = turn_round(&model, &truth);
    let found = search_from(&model, &start, views(&model, &truth, 4), false);
    assert!(mean_joint_error_mm(&model, &found.hypotheses[0].pose, &truth) > 150.0);
}

#[test]
fn a_right_start_stays_and_the_turned_body_is_offered_behind_it() {
    let model = Arc::new(builtin::full_body());
    let truth = motion::pose(&model, FRAMES[1] as f64);
    let found = search_from(&model, &truth, views(&model, &truth, 2), true);
    assert!(mean_joint_error_mm(&model, &found.hypotheses[0].pose, &truth) < 60.0);
    assert!(found.hypotheses[1..].iter().any(|found| found.origin == Origin::TurnedRound));
}
