//! Thresholds of the tracker that were set on real footage, the balancing trial, looked at on other takes: the built-in one and
//! clothed figures before other cameras. In the walk the person grows past 64 pixels, where other stages begin.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::{Footage, Take};
use backlit_lab::synthetic::masks::silhouette;
use backlit_lab::synthetic::{Build, Figure, exercise, motion, squats};
use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView};
use backlit_tracking::track::{Motion, SEARCH_BELOW_IOU, Tracker, WhenToSearch};

/// Frames of a figure's track.
const FRAMES: usize = 40;
/// A frame is good if none of its joints is farther off, millimetres.
const GOOD_MM: f64 = 100.0;

/// What a track says of the thresholds.
#[derive(Debug, Default)]
struct TrackCounts {
    good: usize,
    lost_good: usize,
    /// IoU of the first frame's fit, which a search questions if it is poor.
    first_iou: f64,
}

fn track(
    model: &Arc<Model>,
    frame_rate: f64,
    frames: usize,
    truth: impl Fn(usize) -> Pose,
    views: impl Fn(usize) -> Vec<FitView>,
) -> TrackCounts {
    let tracker = Tracker::new(model.clone(), FitOptions::default(), truth(0)).unwrap();
    let tracker = tracker.with_motion(Motion::Velocity, frame_rate).unwrap();
    let mut tracker = tracker.with_search(WhenToSearch::Never);
    let mut found = TrackCounts::default();
    for frame in 0..frames {
        let estimate = tracker.track_frame(frame, views(frame), &CancelToken::new()).unwrap();
        let [ends, true_ends] =
            [&estimate.pose, &truth(frame)].map(|pose| Kinematics::new(model, pose).ends().to_vec());
        let off = ends.iter().zip(&true_ends).map(|(a, b)| 1e3 * a.distance(*b)).fold(0.0, f64::max);
        if frame == 0 {
            found.first_iou = estimate.iou().unwrap();
        }
        if off < GOOD_MM {
            found.good += 1;
            found.lost_good += usize::from(estimate.is_lost());
        }
    }
    found
}

fn of_figure(frame_rate: f64, cameras: &[Arc<Camera>], pose: impl Fn(&Model, f64) -> Pose) -> TrackCounts {
    let model = Arc::new(builtin::full_body());
    let truth = |frame: usize| pose(&model, frame as f64 / frame_rate);
    track(&model, frame_rate, FRAMES, truth, |frame| {
        let figure = Figure::new(&model, &truth(frame), Build::default()).unwrap();
        let view =
            |camera: &Arc<Camera>| FitView::of_mask(camera.clone(), silhouette(&figure, camera).unwrap());
        cameras.iter().map(view).collect()
    })
}

#[test]
fn good_frames_of_other_takes_are_not_lost() {
    let footage =
        Footage::new(Take::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/take")).unwrap());
    let model = footage.take().model();
    let truth = |frame: usize| motion::pose(model, frame as f64);
    let rate = footage.take().frame_rate();
    let built_in = track(model, rate, footage.frame_count(), truth, |frame| {
        footage.fit_views(&[0, 1, 2, 3], frame).unwrap()
    });
    let walk = of_figure(exercise::FRAME_RATE, &exercise::cameras(3, [120, 160]).unwrap(), exercise::pose);
    let slow = of_figure(10.0, &exercise::cameras(4, [240, 320]).unwrap(), exercise::pose);
    let squats = of_figure(15.0, &squats::cameras([180, 320]).unwrap(), squats::pose);
    for (name, found) in
        [("built-in take", built_in), ("walk", walk), ("10 frames a second", slow), ("squats", squats)]
    {
        assert!(found.good > 15 && found.lost_good == 0, "{name}: {found:?}");
        // In clothes right poses overlap less than what is not searched for.
        assert!((0.8..SEARCH_BELOW_IOU).contains(&found.first_iou), "{name}: {found:?}");
    }
}
