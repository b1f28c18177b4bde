//! Two of the report's errata by whole fits; the others are `crates/tracking/tests/tracking/errata.rs`.

use std::sync::Arc;

use backlit_lab::experiment::{Simulation, scene};
use backlit_lab::synthetic::{capsules, upper_body};
use backlit_tracking::body::{Model, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{DataView, Evidence, Fit, FitOptions, FitView, Objective, Preset};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::optimize::{LeastSquares, NormalEquations};
use backlit_tracking::render::Ramp;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Measurement};

/// Sub-pixels across and down of an area-averaged picture.
const SUBPIXELS: usize = 8;

/// A start 5° and 3 cm off or a pose 10° off, by its number.
fn off(model: &Model, degrees: f64, metres: f64, seed: u64) -> Pose {
    perturb(model, &upper_body::motion(model, 0), degrees.to_radians(), metres, seed)
}

/// (4.10) as written, δ = (JᵀJ)⁻¹ Jᵀρ, throws the body away in its first step; the preset's damping brings it home.
#[test]
fn the_plain_inverse_is_no_step() {
    let model = Arc::new(builtin::upper_body());
    let fit = FitOptions::preset(Preset::Report);
    let (truth, stage) = (upper_body::motion(&model, 0), fit.stages[0]);
    let cameras = upper_body::cameras(2, [192, 144]).unwrap();
    let see = |camera| {
        scene::view(&model, &truth, camera, Simulation::Prediction, fit.renderer, stage.ramp).unwrap()
    };
    let views: Vec<FitView> = cameras.iter().map(see).collect();
    // First step's length, whether no step raises the cost, and the error of each start's end.
    let descend = |step: &dyn Fn(&NormalEquations) -> Option<Vec<f64>>, seed| {
        let mut pose = off(&model, 5.0, 0.03, seed);
        let distances = vec![None; views.len()];
        let mut objective = Objective::new(Arc::clone(&model), &views, &distances, &fit, stage, pose.clone());
        let mut equations = NormalEquations::zeros(objective.columns());
        pose = pose.normalized();
        objective.evaluate(&pose, &mut equations);
        let (mut first, mut falls) = (None, true);
        for _ in 0..stage.iterations {
            let Some(step) = step(&equations).filter(|step| step.iter().all(|x| x.is_finite())) else {
                break;
            };
            let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length == 0.0 {
                break;
            }
            first.get_or_insert(length);
            pose = pose.retract(Parameters::Raw, &step);
            let before = equations.cost;
            equations.clear();
            objective.evaluate(&pose, &mut equations);
            falls &= equations.cost <= before;
        }
        (first.unwrap_or(f64::INFINITY), falls, mean_joint_error_mm(&model, &pose, &truth))
    };
    let damped = |damping: f64| move |all: &NormalEquations| Some(all.step(damping).as_slice().to_vec());
    let plain = |all: &NormalEquations| {
        all.jtj.clone().try_inverse().map(|inverse| (inverse * &all.jtr).as_slice().to_vec())
    };
    for seed in 1..=4 {
        let [written, pseudo] = [descend(&plain, seed), descend(&damped(0.0), seed)];
        assert!(written.0 > 1e3 * pseudo.0 && written.2 > 20.0, "{seed}: {written:?}, {pseudo:?}");
    }
    let preset: Vec<_> = (1..=4).map(|seed| descend(&damped(fit.damping), seed)).collect();
    assert!(preset.iter().all(|one| one.1), "{preset:?}");
    assert!(preset.iter().filter(|one| one.2 < 3.0).count() >= 3, "{preset:?}");
}

/// 255 times the share of background in each pixel's area: what a camera sees of a sharp edge.
fn area_averaged(model: &Model, truth: &Pose, camera: &Camera) -> Measurement {
    let (width, height) = (camera.width(), camera.height());
    let fine = camera.resized((width * SUBPIXELS) as u64, (height * SUBPIXELS) as u64).unwrap();
    let mask = capsules::hard_mask(model, truth, &fine).unwrap();
    let mut values = vec![0.0_f32; width * height];
    for (at, label) in mask.labels().iter().enumerate() {
        let (x, y) = (at % mask.width() / SUBPIXELS, at / mask.width() / SUBPIXELS);
        if *label == Label::Background {
            values[y * width + x] += 255.0 / (SUBPIXELS * SUBPIXELS) as f32;
        }
    }
    let weights = vec![1.0; values.len()];
    Measurement::new(width, height, values, weights).unwrap()
}

/// Where fits end that begin at the truth: half grey of (4.16) lies outside the limb, so its bodies move away.
#[test]
fn the_thesis_ramp_is_biased_on_hard_masks_and_half_is_less() {
    let model = Arc::new(builtin::upper_body());
    let bias_mm = |ramp, cameras, is_averaged: bool| {
        let cameras = upper_body::cameras(cameras, [96, 72]).unwrap();
        let errors = [1, 2].map(|seed| {
            let truth = off(&model, 10.0, 0.0, seed);
            let see = |camera: &Arc<Camera>| {
                let mask = capsules::hard_mask(&model, &truth, camera).unwrap();
                let mut view = FitView::of_mask(camera.clone(), mask);
                if is_averaged {
                    view.evidence = Evidence::Measurement(Arc::new(area_averaged(&model, &truth, camera)));
                }
                view
            };
            let options = upper_body::least_cost_fit(ramp, DataView::Hard);
            let views = cameras.iter().map(see).collect();
            let mut fit = Fit::new(Arc::clone(&model), views, truth.clone(), options).unwrap();
            mean_joint_error_mm(&model, &fit.run(&CancelToken::new(), |_| {}).pose, &truth)
        });
        0.5 * (errors[0] + errors[1])
    };
    let [alone, thesis] = [1, 2].map(|cameras| bias_mm(Ramp::Thesis, cameras, false));
    let half = bias_mm(Ramp::Half, 2, false);
    let area = bias_mm(Ramp::Width { px: 1.0 }, 2, true);
    assert!(half < 0.5 * thesis && thesis > 5.0, "with two cameras thesis {thesis} mm, half {half} mm");
    assert!(alone > 3.0 * thesis, "with one camera {alone} mm, with two {thesis} mm");
    assert!(area < 0.6 * half, "area-averaged {area} mm, half {half} mm");
}
