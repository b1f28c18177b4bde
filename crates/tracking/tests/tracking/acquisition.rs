//! A first body of somebody of whom nothing is known: it covers the silhouettes better than the average body, and a fit of sizes may begin with it.

use std::sync::Arc;

use backlit_lab::experiment::scene;
use backlit_lab::synthetic::people::PEOPLE;
use backlit_lab::synthetic::{capsules, motion, studio};
use backlit_tracking::acquisition::{AcquireError, AcquireOptions, Acquired, acquire, acquire_posed};
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::body_fit::{BodyFitError, BodyFitOptions, BodyFrame, FirstSizes, fit_body};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Evidence, Fit, FitError, FitOptions, FitView};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::{WithoutStartError, start};
use backlit_tracking::templates::TemplateError;
use glam::DVec3;

/// A short, broad adult and a tall, slim one.
const BUILDS: [usize; 2] = [2, 4];

struct Someone {
    body: Arc<Model>,
    truth: Pose,
    views: Vec<FitView>,
}

fn someone(build: usize, moment: f64) -> Someone {
    let person = &PEOPLE[build];
    let body = Arc::new(person.of(&builtin::full_body()).unwrap());
    let mut truth = motion::pose(&body, moment);
    truth.root -= DVec3::Z * (0.9 * (1.0 - person.stature));
    let rig = studio::cameras();
    let view = |camera: &backlit_tracking::camera::Camera| {
        let camera = Arc::new(camera.without_distortion());
        let mask = capsules::hard_mask(&body, &truth, &camera).unwrap();
        FitView { camera, evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 }
    };
    let views = rig.cameras().iter().map(view).collect();
    Someone { views, body, truth }
}

/// Mean error of lengths and of radii, millimetres.
fn errors(model: &Model, truth: &Model) -> [f64; 2] {
    let limbs = || model.limbs().iter().zip(truth.limbs());
    let count = model.limbs().len() as f64;
    [
        1e3 * limbs().map(|(a, b)| (a.length - b.length).abs()).sum::<f64>() / count,
        1e3 * limbs().map(|(a, b)| (a.radius - b.radius).abs()).sum::<f64>() / count,
    ]
}

fn iou(model: &Model, pose: &Pose, views: &[FitView]) -> f64 {
    scene::overlap(model, pose, views, RendererKind::Capsule).iou().unwrap()
}

#[test]
fn a_grown_body_covers_the_silhouettes_better_than_the_average_scaled() {
    let adult = Arc::new(builtin::full_body());
    for build in BUILDS {
        let one = someone(build, 8.0);
        let scaled = Arc::new(adult.scaled(PEOPLE[build].stature).unwrap());
        let about = start::perturb(&adult, &one.truth, 0.08, 0.03, 1);
        let mut fit =
            Fit::new(Arc::clone(&scaled), one.views.clone(), about.clone(), FitOptions::default()).unwrap();
        let before = iou(&scaled, &fit.run(&CancelToken::new(), |_| {}).pose, &one.views);
        let posed = [(one.views.clone(), about)];
        let found = acquire_posed(&scaled, &posed, &AcquireOptions::default(), &CancelToken::new()).unwrap();
        let after = iou(&found.model, &found.poses[0], &one.views);
        assert!(after > before + 0.01, "{}: IoU {after:.3}, was {before:.3}", PEOPLE[build].name);
        let [length, _] = errors(&found.model, &one.body);
        assert!(length < 20.0, "{}: lengths {length:.1} mm", PEOPLE[build].name);
        assert!(found.measured > 20, "{}", found.measured);
        rounds_lead_from_the_given_body_to_the_found_one(&scaled, &found);
    }
}

fn rounds_lead_from_the_given_body_to_the_found_one(given: &Arc<Model>, found: &Acquired) {
    let rounds = &found.rounds;
    assert_eq!(rounds.len(), AcquireOptions::default().rounds);
    assert!(rounds[0].before == *given && rounds[1].before == rounds[0].after);
    assert_eq!(rounds[1].after, found.model);
    for round in rounds {
        assert!(round.poses.len() == 1 && round.measured.len() == given.limbs().len());
        let [none, all] = [false, true].map(|is_grown| round.partly(|_| is_grown));
        assert_eq!((&none, &all), (&round.before, &round.after));
        for limb in 0..given.limbs().len() {
            let half = round.partly(|other| other == limb);
            let [length, radius] = round.factors(limb);
            let [was, is] = [&round.before, &half].map(|body| body.limbs()[limb].clone());
            let off = [was.length * length - is.length, was.radius * radius - is.radius];
            assert!(off[0].abs() + off[1].abs() < 1e-12);
            // A length that nothing was measured of stays.
            assert!(round.measured[limb][0] || length == 1.0, "{}", was.name);
        }
        let grown = (0..given.limbs().len()).filter(|&limb| round.measured[limb][1]).count();
        assert!(grown > 15, "{grown}");
    }
}

#[test]
fn a_person_of_unknown_size_and_pose_is_acquired() {
    let adult = Arc::new(builtin::full_body());
    let one = someone(BUILDS[1], 8.0);
    let found = acquire(&adult, &one.views, &AcquireOptions::default(), &CancelToken::new()).unwrap();
    assert!((found.scale - PEOPLE[BUILDS[1]].stature).abs() < 0.15, "{}", found.scale);
    let error = mean_joint_error_mm(&found.model, &found.poses[0], &one.truth);
    assert!(error < 60.0, "{error:.0} mm");
    let after = iou(&found.model, &found.poses[0], &one.views);
    assert!(after > 0.88, "IoU {after:.3}");
}

#[test]
fn a_fit_of_sizes_goes_on_from_a_grown_body() {
    let adult = Arc::new(builtin::full_body());
    let one = someone(BUILDS[0], 8.0);
    let start = start::perturb(&adult, &one.truth, 0.05, 0.02, 1);
    let frames = vec![BodyFrame { frame: 0, views: one.views, start, joints: Vec::new() }];
    let options = BodyFitOptions::default();
    let from = |sizes: FirstSizes<'_>| {
        fit_body(Arc::clone(&adult), frames.clone(), sizes, &options, &CancelToken::new(), |_| {})
    };
    let begun = from(FirstSizes::Known(&one.body)).unwrap();
    let plain = from(FirstSizes::Silhouettes).unwrap();
    // Begun with the truth, it stays nearer to it than from the average, in fewer steps.
    let [near, far] = [&begun, &plain].map(|fit| errors(&fit.model, &one.body)[0]);
    assert!(near < far && begun.iterations < plain.iterations, "{near:.1} {far:.1} mm");
    let refused = from(FirstSizes::Known(&builtin::upper_body())).unwrap_err();
    assert!(matches!(refused, BodyFitError::OtherLimbs { .. }), "{refused}");
}

#[test]
fn what_cannot_be_acquired_is_said() {
    let adult = Arc::new(builtin::full_body());
    let none = acquire(&adult, &[], &AcquireOptions::default(), &CancelToken::new()).unwrap_err();
    let nobody = AcquireError::Search(WithoutStartError::Fit(FitError::NoData { reasons: String::new() }));
    assert_eq!(std::mem::discriminant(&none), std::mem::discriminant(&nobody), "{none}");
    let one = someone(BUILDS[0], 8.0);
    for (options, field) in [
        (AcquireOptions { rounds: 0, ..AcquireOptions::default() }, "rounds"),
        (AcquireOptions { background: f64::NAN, ..AcquireOptions::default() }, "background"),
        (AcquireOptions { range: [1.0, 2.0], ..AcquireOptions::default() }, "range[0]"),
    ] {
        let refused = acquire(&adult, &one.views, &options, &CancelToken::new()).unwrap_err();
        assert!(matches!(refused, AcquireError::Option(error) if error.field == field));
    }
    let limb = Arc::new(builtin::single_limb());
    let posed = [(one.views, Pose::rest(&limb))];
    let refused = acquire_posed(&limb, &posed, &AcquireOptions::default(), &CancelToken::new());
    assert!(matches!(refused, Err(AcquireError::Templates(TemplateError::NoHead { .. }))));
}
