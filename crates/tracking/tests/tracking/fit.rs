//! Whole fits of the upper body in two small cameras, from known truth.

use std::sync::Arc;

use backlit_tracking::body::{Model, Parameters, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitError, FitOptions, FitView, Preset, SolverSummary};
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::optimize::Termination;
use backlit_tracking::render::RendererKind;
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::track::{Tracker, WhenToSearch};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::fixtures::{Failures, LEFT_AND_RIGHT, camera_pair, fit_view, posed};

const WIDTH: u64 = 96;
const HEIGHT: u64 = 72;

struct Scene {
    model: Arc<Model>,
    truth: Pose,
    views: Vec<FitView>,
}

/// The upper body with bent arms, seen by two cameras a quarter turn apart.
fn scene() -> Scene {
    let model = Arc::new(builtin::upper_body());
    let turns = [
        ("torso", DVec3::new(0.1, 0.3, -0.05)),
        ("right upper arm", DVec3::new(-0.4, 0.1, -0.6)),
        ("right forearm", DVec3::new(-0.9, 0.2, -0.2)),
        ("left upper arm", DVec3::new(0.3, 0.0, 0.7)),
        ("left forearm", DVec3::new(-0.7, -0.3, 0.1)),
        ("head", DVec3::new(0.2, 0.0, 0.1)),
    ];
    let turns = turns.map(|(limb, turn)| (limb, exp(turn)));
    let truth = posed(&model, DVec3::new(0.02, -0.03, 0.04), &turns);
    let cameras = camera_pair(LEFT_AND_RIGHT, [WIDTH, HEIGHT], 130.0, DVec3::Y);
    let views = cameras.map(|camera| fit_view(&model, &truth, camera)).into();
    Scene { model, truth, views }
}

fn direction(random: &mut Pcg64Mcg) -> DVec3 {
    loop {
        let v = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// Every rotation turned by an angle about its own random axis, the root moved by a distance.
fn disturbed(pose: &Pose, seed: u64, degrees: f64, metres: f64) -> Pose {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut step = (direction(&mut random) * metres).to_array().to_vec();
    for _ in &pose.rotations {
        step.extend((direction(&mut random) * degrees.to_radians()).to_array());
    }
    pose.retract(Parameters::Tangent, &step)
}

impl Scene {
    fn fit(&self, start: Pose, options: FitOptions) -> Fit {
        Fit::new(Arc::clone(&self.model), self.views.clone(), start, options).unwrap()
    }
}

fn run(scene: &Scene, start: Pose, options: FitOptions) -> SolverSummary {
    scene.fit(start, options).run(&CancelToken::new(), |_| {})
}

fn is_finite(summary: &SolverSummary) -> bool {
    let numbers = [summary.initial_cost, summary.final_cost, summary.final_rms];
    numbers.iter().all(|x| x.is_finite()) && summary.pose.to_state().iter().all(|x| x.is_finite())
}

/// The same view with nobody in it.
fn emptied(view: &FitView) -> FitView {
    let mask = Mask::filled(WIDTH as usize, HEIGHT as usize, Label::Background).unwrap();
    FitView::of_mask(Arc::clone(&view.camera), mask)
}

#[test]
fn the_robust_preset_recovers_from_ten_degrees_and_five_centimetres() {
    let scene = scene();
    let mut failures = Failures::default();
    for seed in 0..24 {
        let start = disturbed(&scene.truth, seed, 10.0, 0.05);
        let before = mean_joint_error_mm(&scene.model, &start, &scene.truth);
        assert!(before > 50.0, "seed {seed} starts only {before:.0} mm off");
        let summary = run(&scene, start, FitOptions::preset(Preset::Robust));
        let after = mean_joint_error_mm(&scene.model, &summary.pose, &scene.truth);
        failures.expect(
            after < 8.0,
            format_args!("seed {seed}: {before:.1} mm became {after:.1} mm; {}", summary.termination),
        );
    }
}

/// From 5° the report's preset finds the pose of half of the starts, and then ends in the same place, 17 mm off: undone
/// stretching and a ramp that is wider than the masks' edges keep it there. The others stay far above.
#[test]
fn the_report_preset_finds_half_of_the_starts_from_five_degrees() {
    let scene = scene();
    let options = FitOptions::preset(Preset::Report);
    let at_truth = scene.fit(scene.truth.clone(), options.clone()).cost();
    let (mut found, mut lines) = (Vec::new(), Vec::new());
    for seed in 0..10 {
        let start = disturbed(&scene.truth, seed, 5.0, 0.02);
        let before = mean_joint_error_mm(&scene.model, &start, &scene.truth);
        let summary = run(&scene, start, options.clone());
        assert_eq!(summary.termination, Termination::StepLimit { steps: 25 });
        let after = mean_joint_error_mm(&scene.model, &summary.pose, &scene.truth);
        let [first, last] = [summary.initial_cost, summary.final_cost].map(|cost| cost / at_truth);
        lines.push(format!(
            "seed {seed}: cost {first:.2} to {last:.2} of the truth's, {before:.1} to {after:.1} mm"
        ));
        assert!(last < first, "{lines:#?}");
        let is_found = after < 20.0;
        assert_eq!(is_found, last < 3.0, "{lines:#?}");
        if is_found {
            assert!((2.6..3.0).contains(&last) && (16.0..19.0).contains(&after), "{lines:#?}");
            found.push(seed);
        }
    }
    assert_eq!(found, [0, 1, 2, 7, 8], "{lines:#?}");
}

#[test]
fn the_first_report_step_is_the_damped_gauss_newton_step() {
    let scene = scene();
    let start = disturbed(&scene.truth, 3, 5.0, 0.02);
    let options = FitOptions::preset(Preset::Report);
    let mut fit = scene.fit(start.clone(), options);
    let step = fit.equations().step(0.1);
    let predicted = fit.equations().predicted_decrease(&step);
    let record = fit.step().unwrap();
    let expected = start.normalized().retract(Parameters::Raw, step.as_slice());
    assert_eq!((record.point, record.predicted_decrease), (expected, predicted));
}

#[test]
fn summaries_hold_every_iteration() {
    let scene = scene();
    let start = disturbed(&scene.truth, 1, 20.0, 0.1);
    // Steps too long for the linear model: some are rejected.
    let mut options = FitOptions { damping: 1e-6, largest_turn: None, ..FitOptions::preset(Preset::Robust) };
    options.largest_move = None;
    let mut fit = scene.fit(start.clone(), options);
    let mut heard = Vec::new();
    let summary = fit.run(&CancelToken::new(), |record| heard.push(record.clone()));
    assert_eq!(summary.iterations, heard);
    assert!(summary.iterations.iter().any(|record| !record.accepted), "no step was rejected");
    let mut before = (start.normalized(), 0, summary.initial_cost);
    for record in &summary.iterations {
        if record.stage == before.1 {
            let fallen = before.2 - record.trial_cost;
            assert_eq!(record.actual_decrease, fallen);
            assert_eq!(record.accepted, fallen > 0.0);
        }
        if record.accepted {
            assert_eq!(record.cost, record.trial_cost);
        } else {
            assert_eq!(record.point, before.0, "a rejected step moved the pose");
        }
        assert!(record.stage >= before.1 && record.predicted_decrease > 0.0 && record.gradient_max > 0.0);
        before = (record.point.clone(), record.stage, record.cost);
    }
    assert_eq!((summary.pose, summary.final_cost), (before.0, before.2));
}

#[test]
fn results_are_the_same_to_the_bit() {
    let scene = scene();
    for preset in Preset::ALL {
        let start = disturbed(&scene.truth, 5, 8.0, 0.04);
        let run = || run(&scene, start.clone(), FitOptions::preset(preset));
        let first = run();
        assert_eq!(first, run(), "{preset}: a second run differs");
        for threads in [1, 2, 4] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(first, pool.install(run), "{preset}: {threads} threads give another result");
        }
    }
}

#[test]
fn cameras_without_a_subject_are_named() {
    let mut scene = scene();
    scene.views[1] = emptied(&scene.views[1]);
    let start = disturbed(&scene.truth, 2, 3.0, 0.01);
    let summary = run(&scene, start.clone(), FitOptions::preset(Preset::Robust));
    assert_eq!(summary.empty_cameras, ["right"]);
    assert!(is_finite(&summary));

    scene.views[0] = emptied(&scene.views[0]);
    let options = FitOptions::preset(Preset::Robust);
    let error = Fit::new(Arc::clone(&scene.model), scene.views.clone(), start, options).unwrap_err();
    assert!(matches!(error, FitError::NoData { .. }));
    assert!(error.to_string().contains("left, right"), "{error}");
}

#[test]
fn a_start_behind_every_camera_ends_clearly() {
    let scene = scene();
    for preset in Preset::ALL {
        for renderer in RendererKind::ALL {
            let start = Pose { root: DVec3::new(0.0, 1.0, 30.0), ..scene.truth.clone() };
            let options = FitOptions { renderer, ..FitOptions::preset(preset) };
            let summary = run(&scene, start.clone(), options);
            assert!(is_finite(&summary), "{preset}, {renderer}: {summary:?}");
            assert_eq!(summary.termination, Termination::NoGradient, "{preset}, {renderer}");
            assert_eq!(summary.pose, start.normalized(), "nothing pulls, nothing moves");
        }
    }
}

#[test]
fn free_rotations_are_counted() {
    let scene = scene();
    let expected = scene.model.rotation_count();
    for found in [0, expected - 1, expected + 1] {
        let (model, views) = (Arc::clone(&scene.model), scene.views.clone());
        let options = FitOptions::default();
        let fit =
            Fit::with_free_rotations(model, views, scene.truth.clone(), options, Some(vec![true; found]));
        assert_eq!(fit.unwrap_err(), FitError::FreeRotations { found, expected });
    }
}

#[test]
fn only_free_rotations_move() {
    let scene = scene();
    let arm = ["right upper arm", "right forearm"].map(|name| {
        let limb = scene.model.limb_index(name).unwrap();
        scene.model.limbs()[limb].rotation
    });
    let free: Vec<bool> = (0..scene.model.rotation_count()).map(|rotation| arm.contains(&rotation)).collect();
    for preset in Preset::ALL {
        let mut start = scene.truth.clone();
        let disturbed = disturbed(&start, 4, 5.0, 0.0);
        for rotation in arm {
            start.rotations[rotation] = disturbed.rotations[rotation];
        }
        let options = FitOptions::preset(preset);
        let (model, views) = (Arc::clone(&scene.model), scene.views.clone());
        let mut fit =
            Fit::with_free_rotations(model, views, start.clone(), options, Some(free.clone())).unwrap();
        let summary = fit.run(&CancelToken::new(), |_| {});
        let moved = summary.pose.local(&start.normalized());
        assert_eq!(moved[..3], [0.0; 3], "{preset}: the root moved");
        for (rotation, block) in moved[3..].chunks(3).enumerate() {
            let angle = block.iter().map(|x| x * x).sum::<f64>().sqrt();
            if arm.contains(&rotation) {
                assert!(angle > 0.01, "{preset}: free rotation {rotation} stayed");
            } else {
                // Renormalising may turn the last bit.
                assert!(angle < 1e-14, "{preset}: held rotation {rotation} moved by {angle:e}");
            }
        }
        let before = mean_joint_error_mm(&scene.model, &start, &scene.truth);
        let after = mean_joint_error_mm(&scene.model, &summary.pose, &scene.truth);
        assert!(after < before, "{preset}: {before} mm became {after} mm");
    }
}

/// From far away the plain fit ends in another pose; with a search the tracker finds the right one, in a first frame
/// and after one in which nobody was seen.
#[test]
fn a_tracker_that_begins_far_away_searches() {
    let scene = scene();
    let mut helped = 0;
    for seed in 0..4 {
        let start = disturbed(&scene.truth, seed, 50.0, 0.1);
        let errors = [WhenToSearch::Never, WhenToSearch::WhenPoor, WhenToSearch::Always].map(|search| {
            let options = FitOptions::preset(Preset::Robust);
            let tracker = Tracker::new(Arc::clone(&scene.model), options, start.clone()).unwrap();
            let mut tracker = tracker.with_search(search);
            if seed % 2 == 1 {
                let empty = scene.views.iter().map(emptied).collect();
                assert!(tracker.track_frame(0, empty, &CancelToken::new()).unwrap().is_lost());
            }
            let found = tracker.track_frame(1, scene.views.clone(), &CancelToken::new()).unwrap();
            mean_joint_error_mm(&scene.model, &found.pose, &scene.truth)
        });
        println!("seed {seed}: never, when poor, always: {errors:.1?} mm");
        let [never, poor, always] = errors;
        assert!(poor < 60.0 && always < 60.0, "seed {seed}: {errors:?}");
        helped |= usize::from(never > 100.0) << (seed % 2);
    }
    assert_eq!(helped, 0b11, "the plain fit had no need of a search");
}
