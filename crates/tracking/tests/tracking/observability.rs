//! What the cameras see of a pose: null directions that are known, depth of one camera, covariances against noisy fits,
//! sets of cameras against looking again.

use std::sync::Arc;

use backlit_lab::synthetic::capsules::hard_mask;
use backlit_lab::synthetic::upper_body;
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{Evidence, FitOptions, FitView, Objective, Preset};
use backlit_tracking::observability::{Cause, FrameInformation, Noise, Visibility, camera_subsets};
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::silhouette::{Label, Mask, Measurement};
use glam::{DQuat, DVec3};
use nalgebra::{DVector, Matrix3, Vector3};

use crate::fixtures::{self, Failures};

fn options() -> FitOptions {
    FitOptions::preset(Preset::Robust)
}

fn masked(model: &Model, pose: &Pose, camera: &Arc<Camera>) -> Option<FitView> {
    let mask = hard_mask(model, pose, camera).unwrap();
    Some(FitView { camera: Arc::clone(camera), evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 })
}

/// The upper body in its movement, seen by some of the cameras around it.
fn upper(cameras: usize, frame: usize) -> FrameInformation {
    let model = Arc::new(builtin::upper_body());
    let pose = upper_body::motion(&model, frame);
    let cameras = upper_body::cameras(cameras, [192, 144]).unwrap();
    let views: Vec<_> = cameras.iter().map(|camera| masked(&model, &pose, camera)).collect();
    FrameInformation::new(&model, &views, &options(), &pose).unwrap()
}

#[test]
fn twists_of_the_upper_body_are_null_and_named() {
    for (cameras, frame) in [(1, 3), (2, 3), (2, 17), (4, 3), (4, 40)] {
        let information = upper(cameras, frame);
        let found = information.observe(&(0..cameras).collect::<Vec<_>>());
        assert_eq!(found.directions.len(), 27);
        assert_eq!(found.null_count(), 7, "{cameras} cameras, frame {frame}");
        let kinematics = &information.kinematics;
        let mut twisted = Vec::new();
        for direction in found.directions.iter().filter(|direction| direction.is_null) {
            assert_eq!(direction.shares[0].cause, Cause::Twist, "{:?}", direction.shares);
            assert!(direction.shares[0].share > 1.0 - 1e-9 && direction.moves_no_joint());
            twisted.push(direction.shares[0].limb);
            // Far along it the body is where it was.
            let swayed = Kinematics::new(&found.model, &direction.swayed(&found.pose, 0.8));
            for (a, b) in swayed.ends().iter().zip(kinematics.ends()) {
                assert!(a.distance(*b) < 1e-12, "{a} {b}");
            }
            assert_eq!(direction.visibility(), Visibility::Null);
        }
        twisted.sort_unstable();
        twisted.dedup();
        assert_eq!(twisted.len(), 7, "one of each limb but the torso");
        for pair in found.directions.windows(2) {
            assert!(pair[0].value >= pair[1].value);
        }
    }
}

#[test]
fn what_one_camera_sees_least_is_depth() {
    let found = upper(1, 3).observe(&[0]);
    let weakest: Vec<_> =
        found.directions.iter().filter(|direction| !direction.is_null).rev().take(4).collect();
    for direction in weakest {
        let depth: f64 = direction
            .shares
            .iter()
            .filter(|share| share.cause == Cause::Depth(vec![0]))
            .map(|s| s.share)
            .sum();
        assert!(depth > 0.5, "{:?}", direction.shares);
        assert_ne!(direction.visibility(), Visibility::Well);
    }
}

/// Grey levels of a pose with independent noise of a known deviation, by a small generator.
fn noisy(
    model: &Model,
    pose: &Pose,
    camera: &Arc<Camera>,
    deviation: f64,
    seed: &mut u64,
) -> Option<FitView> {
    let kinematics = Kinematics::new(model, pose);
    let view = View::new(model, &kinematics, camera, RendererKind::Capsule, Ramp::Half);
    let mut uniform = || {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*seed >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let mut normal = || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
    let values: Vec<f32> =
        prediction::levels(&view).into_iter().map(|level| (level + deviation * normal()) as f32).collect();
    let weights = vec![1.0; values.len()];
    let data = Measurement::new(camera.width(), camera.height(), values, weights).unwrap();
    Some(FitView { camera: Arc::clone(camera), evidence: Evidence::Measurement(Arc::new(data)), weight: 1.0 })
}

/// Hundreds of fits to noisy data scatter as the covariance says.
#[test]
fn joints_of_noisy_fits_scatter_as_predicted() {
    const FITS: usize = 240;
    const DEVIATION: f64 = 2.0;
    let model = Arc::new(builtin::upper_body());
    let truth = upper_body::motion(&model, 3);
    let cameras = upper_body::cameras(2, [96, 72]).unwrap();
    let options = options().with_ramp(Ramp::Half);
    let mut seed = 7;
    let look = |pose: &Pose, views: &[Option<FitView>]| {
        FrameInformation::new(&model, views, &options, pose).unwrap()
    };
    let draw = |seed: &mut u64| -> Vec<Option<FitView>> {
        cameras.iter().map(|camera| noisy(&model, &truth, camera, DEVIATION, seed)).collect()
    };
    let views = draw(&mut seed);
    let prediction = look(&truth, &views).observe_with_noise(&[0, 1], Some(Noise::white(DEVIATION)));
    let centre = Kinematics::new(&model, &truth);
    let mut scatter = vec![Matrix3::zeros(); model.limbs().len()];
    let (mut pixel, mut together) = (0.0, 0.0);
    for _ in 0..FITS {
        let views = draw(&mut seed);
        let mut pose = truth.clone();
        for _ in 0..3 {
            let pull = look(&pose, &views).equations(&[0, 1]).jtr;
            // Gauss-Newton in the seen directions of the truth: their steps are δ = D u, orthogonal by H.
            let mut step = DVector::zeros(pull.len());
            for direction in prediction.directions.iter().filter(|direction| !direction.is_null) {
                step += &direction.step * (direction.step.dot(&pull) / direction.value);
            }
            pose = pose.retract(Parameters::Tangent, step.as_slice());
        }
        let noise = look(&pose, &views).observe(&[0, 1]).noise;
        pixel += noise.pixel_deviation / FITS as f64;
        together += noise.together / FITS as f64;
        let fitted = Kinematics::new(&model, &pose);
        for (limb, sum) in scatter.iter_mut().enumerate() {
            let off = fitted.ends()[limb] - centre.ends()[limb];
            let off = Vector3::new(off.x, off.y, off.z);
            *sum += off * off.transpose() / FITS as f64;
        }
    }
    assert!((pixel / DEVIATION - 1.0).abs() < 0.05, "{pixel}");
    assert!(together < 1.3, "independent pixels err by themselves: {together}");
    let mut failures = Failures::default();
    for joint in prediction.joints.iter().filter(|joint| joint.limb.is_some()) {
        let name = &model.limbs()[joint.limb.unwrap()].name;
        let found = &scatter[joint.limb.unwrap()];
        // In each of its own axes: what is known well and what is known badly.
        let eigen = joint.covariance.symmetric_eigen();
        for (axis, variance) in eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter()) {
            let ratio = (axis.dot(&(found * axis)) / variance).sqrt();
            failures.expect(
                (0.8..1.25).contains(&ratio),
                format_args!("{name}: {:.3} mm, scatter is {ratio:.2} of it", 1e3 * variance.sqrt()),
            );
        }
    }
}

/// Sums of cameras are what a fit steps on, and sets of them are what looking through those alone gives.
#[test]
fn sets_of_cameras_are_what_looking_anew_gives() {
    let model = Arc::new(builtin::upper_body());
    let pose = upper_body::motion(&model, 9);
    let cameras = upper_body::cameras(4, [96, 72]).unwrap();
    let weights = [1.0, 0.3, 2.0, 1.0];
    let views: Vec<Option<FitView>> = cameras
        .iter()
        .zip(weights)
        .map(|(camera, weight)| masked(&model, &pose, camera).map(|view| FitView { weight, ..view }))
        .collect();
    let plain = FitOptions { rest_weight: 0.0, limit_weight: 0.0, ..options() };
    let all = FrameInformation::new(&model, &views, &plain, &pose).unwrap();
    let noise = all.observe(&[0, 1, 2, 3]).noise;
    assert!(noise.pixel_deviation > 0.0);
    let figures = all.compare_subsets(noise);
    assert_eq!(figures.len(), 15);
    for set in camera_subsets(&[0, 1, 2, 3]) {
        let alone: Vec<Option<FitView>> =
            views.iter().enumerate().map(|(at, view)| view.clone().filter(|_| set.contains(&at))).collect();
        let again = FrameInformation::new(&model, &alone, &plain, &pose).unwrap();
        let expected = again.observe_with_noise(&[0, 1, 2, 3], Some(noise));
        assert_eq!(expected.cameras, set);
        let found = figures.iter().find(|figures| figures.cameras == set).unwrap();
        assert_eq!(found.null_count, expected.null_count(), "{set:?}");
        assert_eq!(found.worst, expected.worst_joint().unwrap(), "{set:?}");

        let stage = *plain.stages.last().unwrap();
        let used: Vec<FitView> = alone.into_iter().flatten().collect();
        let stage = backlit_tracking::fit::Stage { stride: 1, ..stage };
        let distances: Vec<_> = used.iter().map(|view| view.distance(&[stage])).collect();
        let mut objective =
            Objective::new(Arc::clone(&model), &used, &distances, &plain, stage, pose.clone());
        let direct = objective.frame_equations(&pose);
        let sum = all.equations(&set);
        let off = (&direct.jtj - &sum.jtj).amax() / direct.jtj.amax();
        assert!(off < 1e-4, "{set:?}: {off}");
        let off = (&direct.jtr - &sum.jtr).amax() / direct.jtr.amax();
        assert!(off < 1e-3, "{set:?}: {off}");
    }
    let best = &figures[0];
    let is_sorted = figures.is_sorted_by_key(|figures| figures.null_count);
    assert!(best.cameras.len() >= 3 && is_sorted);
}

/// An arm of which one camera sees only the upper part.
#[test]
fn a_limb_outside_all_pictures_is_without_bound() {
    let model = Arc::new(builtin::upper_body());
    let mut pose = Pose::rest(&model);
    let limb = model.limb_index("right upper arm").unwrap();
    pose.rotations[model.limbs()[limb].rotation] = DQuat::from_rotation_z(-1.3);
    let ends = Kinematics::new(&model, &pose);
    let forearm = model.limb_index("right forearm").unwrap();
    let elbow = ends.starts()[forearm];
    // The right edge of the picture goes through the elbow.
    let project = |cx: f64| {
        fixtures::camera([120, 120], [160.0, 160.0, cx, 60.0], [0.0, 0.3, 2.5], [0.0, 0.3, 0.0], DVec3::Y)
    };
    let off = project(60.0).project(elbow).unwrap().x;
    let camera = Arc::new(project(if off < 60.0 { 60.0 - off - 14.0 } else { 60.0 + 119.0 - off + 14.0 }));
    let view = masked(&model, &pose, &camera);
    let evidence = &view.as_ref().unwrap().evidence;
    assert!(matches!(evidence, Evidence::Mask(mask) if mask.count(Label::Subject) > 300));
    let found = FrameInformation::new(&model, &[view, None], &options(), &pose).unwrap().observe(&[0, 1]);
    assert_eq!(found.cameras, [0], "a camera without a silhouette says nothing");
    let out = found.directions.iter().filter(|d| d.is_null && d.shares[0].cause == Cause::OutOfPictures);
    assert!(out.count() >= 2);
    let wrist = found.joints.iter().find(|joint| joint.limb == Some(forearm)).unwrap();
    assert!(wrist.is_unbounded() && wrist.worst_deviation_m().is_infinite());
    assert_eq!(found.worst_joint().unwrap().1, f64::INFINITY);
    let ellipse = wrist.ellipse(&camera).unwrap();
    assert!(!ellipse.unseen.is_empty());
    assert!(ellipse.unseen.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-9));
    let head = found.joints.iter().find(|joint| joint.limb == model.limb_index("head")).unwrap();
    assert!(!head.is_unbounded(), "{head:?}");
}

/// The ellipse is the picture of the covariance: points on its border, by differences.
#[test]
fn ellipses_are_pictures_of_covariances() {
    let information = upper(2, 11);
    let found = information.observe(&[0, 1]);
    for camera in information.cameras.iter().flatten().map(|part| &part.camera) {
        for joint in &found.joints {
            let ellipse = joint.ellipse(camera).unwrap();
            assert!(ellipse.unseen.is_empty());
            let [long, short] = ellipse.half_axes;
            assert!(long.length() >= short.length() && long.dot(short).abs() < 1e-9 * long.length_squared());
            // √(gᵀ Cov g) of the picture's x and y, from tiny moves of the joint.
            for (axis, expected) in [(0, long.x.hypot(short.x)), (1, long.y.hypot(short.y))] {
                let slope = DVec3::AXES.map(|unit| {
                    let at = |sign: f64| camera.project(joint.at + unit * (sign * 1e-6)).unwrap()[axis];
                    (at(1.0) - at(-1.0)) / 2e-6
                });
                let slope = Vector3::from(slope);
                let direct = slope.dot(&(joint.covariance * slope)).sqrt();
                assert!((direct / expected - 1.0).abs() < 1e-6, "{direct} {expected}");
            }
        }
    }
}

#[test]
fn nothing_is_seen_without_a_silhouette() {
    let model = Arc::new(builtin::upper_body());
    let pose = upper_body::motion(&model, 0);
    let camera = upper_body::cameras(1, [48, 36]).unwrap().remove(0);
    let empty = Mask::filled(48, 36, Label::Background).unwrap();
    let evidence = Evidence::Mask(Arc::new(empty));
    let view = Some(FitView { camera, evidence, weight: 1.0 });
    let information = FrameInformation::new(&model, &[view], &options(), &pose).unwrap();
    let found = information.observe(&[0]);
    assert_eq!((found.cameras.len(), found.null_count()), (0, 27));
    assert!(found.joints.iter().all(|joint| joint.is_unbounded()));
    assert!(information.compare_subsets(found.noise).is_empty());
}
