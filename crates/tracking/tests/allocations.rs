//! An iteration allocates nothing but what is kept of it, and a long track keeps no more than its lag.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

use std::slice::from_ref;
use std::sync::Arc;

use allocation_counter::measure;
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Objective, Preset};
use backlit_tracking::optimize::{LeastSquares, NormalEquations, StepMemory};
use backlit_tracking::render::{Ramp, RendererKind, predict};
use backlit_tracking::search::start;
use backlit_tracking::silhouette::Measurement;
use backlit_tracking::track::{FrameEstimate, KalmanOptions, Motion, Smoother, Tracker, WHOLE_LAG};
use glam::DVec3;
use nalgebra::DVector;

/// What a camera sees of a body at rest.
fn view(model: &Model, [width, height]: [u64; 2], focal: f64) -> FitView {
    let place = CameraFromWorld::looking_at(DVec3::new(0.5, 0.3, 4.0), DVec3::new(0.0, -0.2, 0.0), DVec3::Y);
    let [cx, cy] = [width, height].map(|side| 0.5 * (side as f64 - 1.0));
    let pinhole = Intrinsics { fx: focal, fy: focal, cx, cy };
    let camera = Camera::new("camera", [width, height], pinhole, Distortion::None, place).unwrap();
    let rest = Kinematics::new(model, &Pose::rest(model));
    let lambda = predict(model, &rest, &camera, RendererKind::Capsule, Ramp::Half).lambda;
    let weights = vec![1.0; lambda.len()];
    let data = Measurement::new(camera.width(), camera.height(), lambda, weights).unwrap();
    FitView { camera: Arc::new(camera), evidence: Evidence::Measurement(Arc::new(data)), weight: 1.0 }
}

#[test]
fn evaluating_and_solving_allocate_nothing_after_the_first_time() {
    let model = Arc::new(builtin::full_body());
    let pose = start::perturb(&model, &Pose::rest(&model), 0.1, 0.02, 1);
    let view = view(&model, [192, 144], 150.0);
    for renderer in RendererKind::ALL {
        for parameters in [Parameters::Raw, Parameters::Tangent] {
            let options = FitOptions { renderer, parameters, ..FitOptions::preset(Preset::Robust) };
            let stage = options.stages[0];
            let reference = pose.clone();
            let mut objective =
                Objective::new(Arc::clone(&model), from_ref(&view), &[None], &options, stage, reference);
            let mut equations = NormalEquations::zeros(objective.columns());
            let mut step = DVector::zeros(objective.columns());
            let mut memory = StepMemory::default();
            let mut iteration = || {
                equations.clear();
                objective.evaluate(&pose, &mut equations);
                equations.step_into(0.1, &mut memory, &mut step);
                std::hint::black_box(equations.predicted_decrease(&step));
            };
            iteration();
            let found = measure(iteration).count_total;
            assert_eq!(found, 0, "{renderer}, {parameters:?}: {found} allocations");
        }
    }
}

/// Two frames of the full body that a Kalman filter has followed: the second one is predicted.
fn followed() -> [FrameEstimate; 2] {
    let model = Arc::new(builtin::full_body());
    let pose = Pose::rest(&model);
    let view = view(&model, [48, 36], 40.0);
    let options = FitOptions::preset(Preset::Robust).with_ramp(Ramp::Half).with_iterations(2);
    let tracker = Tracker::new(Arc::clone(&model), options, pose).unwrap();
    let mut tracker = tracker.with_motion(Motion::Kalman(KalmanOptions::default()), 30.0).unwrap();
    [0, 1].map(|frame| tracker.track_frame(frame, vec![view.clone()], &CancelToken::new()).unwrap())
}

#[test]
fn smoothing_keeps_no_more_frames_however_long_the_track_is() {
    let [_, frame] = followed();
    assert!(frame.belief.as_ref().unwrap().predicted.is_some());
    let of_one = |frame: FrameEstimate| measure(|| drop(std::hint::black_box(frame.clone()))).bytes_max;
    let (whole, settled) = (of_one(frame.clone()), of_one(frame.clone().settled()));
    println!("a frame of the full body: {whole} bytes with all that smoothing needs, {settled} without");
    assert!(3 * settled < 2 * whole, "{settled} of {whole} bytes are left");
    // What is known of a frame goes to a file or a screen, and is not kept here.
    let most = |count: usize| {
        let follow = || {
            let mut smoother = Smoother::new(None);
            for number in 0..count {
                drop(smoother.push(FrameEstimate { frame: number, ..frame.clone() }).unwrap());
            }
            drop(smoother.finish().unwrap());
        };
        measure(follow).bytes_max
    };
    let (short, long) = (most(3 * WHOLE_LAG), most(8 * WHOLE_LAG));
    println!("at most {short} bytes for {} frames, {long} for {}", 3 * WHOLE_LAG, 8 * WHOLE_LAG);
    assert!(long <= short + short / 50, "{short} and {long} bytes");
    assert!(long < 4 * WHOLE_LAG as u64 * whole, "{long} bytes for {WHOLE_LAG} frames of {whole}");
}
