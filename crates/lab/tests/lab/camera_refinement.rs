//! Cameras that are not where their calibration says, refined by the silhouettes of a person.

use std::sync::Arc;

use backlit_lab::experiment::ExperimentError;
use backlit_lab::experiment::disturbed_cameras::{Disturbance, RigError, film};
use backlit_lab::synthetic::{exercise, two_people};
use backlit_tracking::body::builtin;
use backlit_tracking::body_fit::{
    BodyFitOptions, CameraChoice, CameraRefinementError, CameraRefinementOptions, RefinedCameras, WELL_SEEN,
    refine_cameras,
};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView};

const FRAME_RATE: f64 = 20.0;

#[derive(Debug)]
enum Failure {
    Film { _why: ExperimentError },
    Refinement(CameraRefinementError),
}

impl From<CameraRefinementError> for Failure {
    fn from(error: CameraRefinementError) -> Self {
        Self::Refinement(error)
    }
}

/// What is found, the cameras as they are, as they are given, and by how many seconds each is late.
struct Refined {
    found: Result<RefinedCameras, Failure>,
    truth: Vec<Camera>,
    given: Vec<Camera>,
    late_s: Vec<f64>,
}

fn refine(disturbance: Disturbance, choice: CameraChoice, cameras: usize, cancel: &CancelToken) -> Refined {
    let model = Arc::new(builtin::full_body());
    let filming = two_people::cameras([280, 280]).unwrap()[..cameras].to_vec();
    let disturbed = filming.iter().enumerate().map(|(index, own)| disturbance.of(own, index, 3).unwrap());
    let (given, late_s): (Vec<Camera>, Vec<f64>) = disturbed.unzip();
    let shared: Vec<Arc<Camera>> = given.iter().cloned().map(Arc::new).collect();
    let views = |frame: usize| {
        let seen = film(&model, &filming, &late_s, frame as f64 / FRAME_RATE, 1)
            .map_err(|_why| Failure::Film { _why })?;
        let seen = seen.into_iter().zip(&shared);
        Ok(seen.map(|(view, camera)| FitView { camera: Arc::clone(camera), ..view }).collect())
    };
    let mut options = CameraRefinementOptions::new(FitOptions::default(), FRAME_RATE);
    options.fit = BodyFitOptions::default().with_proportions(WELL_SEEN);
    (options.choice, options.fitted, options.held_out, options.rounds) = (choice, 12, 1, 2);
    let frames: Vec<usize> = (0..60).collect();
    let start = exercise::pose(&model, 0.0);
    let found = refine_cameras(&model, start, &frames, &options, cancel, views, |_| {});
    let truth = filming.iter().map(|camera| (**camera).clone()).collect();
    Refined { found, truth, given, late_s }
}

#[test]
fn turned_cameras_are_turned_back_and_the_rig_stays_where_it_is() {
    let disturbance = Disturbance { turn: 1_f64.to_radians(), ..Disturbance::default() };
    let Refined { found, truth, given, .. } =
        refine(disturbance, CameraChoice::default(), 4, &CancelToken::new());
    let found = found.unwrap();
    let refined: Vec<Camera> = found.cameras.iter().map(|camera| camera.camera.clone()).collect();
    let [before, after] = [&given, &refined].map(|rig| RigError::between(rig, &truth).unwrap());
    assert!(before.turn_deg > 0.8 && after.turn_deg < 0.15, "{before:?}, {after:?}");
    assert!(after.shift_mm < 8.0, "{after:?}");
    for camera in &found.cameras {
        let [before, after] = camera.held_out_iou.map(Option::unwrap);
        assert!(after > before + 0.02 && after > 0.85, "{before} {after}");
        assert!(camera.deviation.change.turn.is_finite() && camera.deviation.change.turn.length() > 0.0);
    }
    // The mean of the centres is one of the seven freedoms.
    let mean = found.cameras.iter().map(|camera| camera.change.change.shift).sum::<glam::DVec3>() / 4.0;
    assert!(mean.length() < 1e-3, "{mean}");
}

#[test]
fn focal_lengths_and_clocks_are_found_where_they_are_free() {
    let disturbance = Disturbance { focal_length: 0.05, offset_s: 0.05, ..Disturbance::default() };
    let choice = CameraChoice { focal_length: true, offset: true, ..CameraChoice::default() };
    let Refined { found, truth, late_s, .. } = refine(disturbance, choice, 4, &CancelToken::new());
    let found = found.unwrap();
    let refined: Vec<Camera> = found.cameras.iter().map(|camera| camera.camera.clone()).collect();
    let after = RigError::between(&refined, &truth).unwrap();
    assert!(after.focal_percent < 1.5, "of 5 %: {after:?}");
    let mean = late_s.iter().sum::<f64>() / 4.0;
    for (camera, late_s) in found.cameras.iter().zip(&late_s) {
        let off = camera.change.late_s - (late_s - mean);
        assert!(off.abs() < 0.01, "{} s off", off);
    }
}

#[test]
fn one_camera_and_a_stop_are_told() {
    let one = refine(Disturbance::default(), CameraChoice::default(), 1, &CancelToken::new());
    let Err(Failure::Refinement(error)) = one.found else { panic!("one camera has nothing to agree on") };
    assert!(error.to_string().contains("cameras that are used: 1; expected 2"), "{error}");
    let cancel = CancelToken::new();
    cancel.cancel();
    let stopped = refine(Disturbance::default(), CameraChoice::default(), 4, &cancel).found;
    assert!(matches!(stopped, Err(Failure::Refinement(CameraRefinementError::Cancelled))));
}
