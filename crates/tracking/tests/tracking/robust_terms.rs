//! Robust losses and the interpenetration of limbs: gradients against differences of their costs; doubted pixels.

use std::sync::Arc;

use backlit_lab::synthetic::{capsules, upper_body};
use backlit_tracking::body::{Kinematics, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::optimize::NormalEquations;
use backlit_tracking::residual::Loss;
use backlit_tracking::residual::interpenetration::{self, LimbPairs};
use backlit_tracking::residual::pose_prior;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::Label;

use crate::fixtures::{BOTH, Failures, bent, check_gradient};

#[test]
fn robust_proximal_priors_match_differences() {
    let model = builtin::upper_body();
    let reference = bent(&model, 0.3, 2.1);
    let mut failures = Failures::default();
    let scale = 0.35;
    for loss in [Loss::Squares, Loss::Huber { scale }, Loss::Cauchy { scale }, Loss::Tukey { scale }] {
        for (phase, size) in [(0.3, 0.1), (1.7, 0.4)] {
            let pose = bent(&model, size, phase);
            for parameters in BOTH {
                let name = format!("{loss:?}, pose {phase}");
                let add = |equations: &mut NormalEquations, pose: &Pose| {
                    pose_prior::add_proximal(equations, parameters, pose, &reference, 30.0, 11.0, loss);
                };
                let cost = check_gradient(&name, parameters, &pose, add, 1e-5, &mut failures).cost;
                assert!(cost > 0.0, "{name}");
            }
        }
    }
}

#[test]
fn interpenetration_matches_differences() {
    let mut failures = Failures::default();
    let mut overlapping = 0;
    for model in [builtin::upper_body(), builtin::full_body()] {
        let pairs = LimbPairs::of(&model);
        for phase in 0..8 {
            let pose = bent(&model, 0.9, f64::from(phase));
            for parameters in BOTH {
                let name = format!("{}, pose {phase}", model.name());
                let add = |equations: &mut NormalEquations, pose: &Pose| {
                    let kinematics = Kinematics::new(&model, pose);
                    let memory = &mut Vec::new();
                    interpenetration::add(equations, parameters, &model, &kinematics, &pairs, 1e4, memory);
                };
                let cost = check_gradient(&name, parameters, &pose, add, 1e-5, &mut failures).cost;
                overlapping += usize::from(cost > 0.0);
            }
        }
    }
    assert!(overlapping >= 16, "only {overlapping} poses overlap");
}

/// A small box beside an arm that segmentation took for the subject, and a slit in the trunk: fits that doubt pixels
/// come nearer to the truth than the one that believes them all.
#[test]
fn doubted_pixels_pull_less() {
    let model = Arc::new(builtin::upper_body());
    let truth = upper_body::motion(&model, 3);
    let cameras = upper_body::cameras(2, [192, 144]).unwrap();
    let views: Vec<FitView> = cameras
        .iter()
        .map(|camera| {
            let mut mask = capsules::hard_mask(&model, &truth, camera).unwrap();
            let bounds = mask.bounds().unwrap();
            let width = mask.width();
            let (middle, bottom) = ((bounds.x_min + bounds.x_max) / 2, bounds.y_max);
            for y in bottom - 24..bottom - 8 {
                mask.labels_mut()[y * width + bounds.x_max - 30..][..12].fill(Label::Subject);
                mask.labels_mut()[y * width + middle..][..6].fill(Label::Background);
            }
            FitView::of_mask(Arc::clone(camera), mask)
        })
        .collect();
    let start = perturb(&model, &truth, 0.05, 0.02, 5);
    let error_mm = |pixel_loss| {
        let options = FitOptions { pixel_loss, ..FitOptions::default() };
        let mut fit = Fit::new(Arc::clone(&model), views.clone(), start.clone(), options).unwrap();
        let summary = fit.run(&CancelToken::new(), |_| {});
        mean_joint_error_mm(&model, &summary.pose, &truth)
    };
    let believed = error_mm(Loss::Squares);
    for loss in [Loss::Huber { scale: 30.0 }, Loss::Cauchy { scale: 30.0 }, Loss::Tukey { scale: 120.0 }] {
        let doubted = error_mm(loss);
        assert!(doubted < 0.6 * believed, "{loss:?}: {doubted} mm, {believed} mm where all are believed");
    }
}
