//! Motion carried from frame to frame: by time and not by frames, and not over the jump to a pose that was found again; and
//! whether the Kalman filter errs as it says.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::filter::update::update;
use backlit_tracking::filter::{Belief, ConstantVelocity, Innovation, tangent};
use backlit_tracking::fit::{Evidence, FitOptions, FitView};
use backlit_tracking::geometry::rotation;
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::silhouette::{Label, Mask};
use backlit_tracking::track::{Begins, FrameEstimate, KalmanOptions, Motion, Tracker};
use glam::DVec3;
use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::fixtures;

const RATE: f64 = 30.0;

/// A body that moves evenly; a frame is any moment.
fn truth(model: &Model, frame: f64) -> Pose {
    let mut pose = Pose::rest(model);
    pose.root.x += 0.012 * frame;
    let arm = model.limbs()[model.limb_index("right upper arm").unwrap()].rotation;
    pose.rotations[arm] = rotation::exp(DVec3::new(0.0, 0.0, -0.05 * frame)) * pose.rotations[arm];
    pose
}

fn views(model: &Model, pose: Option<&Pose>) -> Vec<FitView> {
    let view = |camera: Arc<Camera>| match pose {
        Some(pose) => fixtures::fit_view(model, pose, camera),
        None => {
            let mask = Mask::filled(192, 144, Label::Background).unwrap();
            FitView { camera, evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 }
        }
    };
    fixtures::camera_pair(fixtures::FRONT_AND_RIGHT, [192, 144], 200.0, DVec3::NEG_Y).map(view).into()
}

fn motions() -> [Motion; 2] {
    [Motion::Velocity, Motion::Kalman(KalmanOptions::default())]
}

fn tracker(model: &Arc<Model>, motion: Motion, first: f64) -> Tracker {
    let tracker = Tracker::new(Arc::clone(model), FitOptions::default(), truth(model, first)).unwrap();
    tracker.with_motion(motion, RATE).unwrap()
}

fn track(tracker: &mut Tracker, frame: usize, views: Vec<FitView>) -> FrameEstimate {
    tracker.track_frame(frame, views, &CancelToken::new()).unwrap()
}

/// Frames 0, 10, 11, 13 and backwards: the next start lies where the body will be, not ten times as far.
#[test]
fn the_motion_goes_on_by_time_and_not_by_frames() {
    let model = Arc::new(builtin::upper_body());
    for motion in motions() {
        for frames in [[0, 10, 11, 13], [13, 11, 10, 0]] {
            let mut tracker = tracker(&model, motion, frames[0] as f64);
            for &frame in &frames[..2] {
                track(&mut tracker, frame, views(&model, Some(&truth(&model, frame as f64))));
            }
            for &frame in &frames[2..] {
                let seen = truth(&model, frame as f64);
                let off = mean_joint_error_mm(&model, &tracker.start_of(frame), &seen);
                let moved = mean_joint_error_mm(&model, &truth(&model, frames[1] as f64), &seen);
                let case = format!("{motion:?}, {frames:?}: frame {frame}");
                assert!(off < 0.8 * moved, "{case} starts {off:.0} mm off of {moved:.0}");
                let found = track(&mut tracker, frame, views(&model, Some(&seen)));
                let off = mean_joint_error_mm(&model, &found.pose, &seen);
                assert!(off < 25.0, "{motion:?}, {frames:?}: frame {frame} ends {off:.0} mm off");
            }
        }
    }
}

/// Nobody in frame 2, and in frame 3 the body is elsewhere: that was no motion.
#[test]
fn what_leads_to_a_recovered_pose_is_no_motion() {
    let model = Arc::new(builtin::upper_body());
    for motion in motions() {
        let mut tracker = tracker(&model, motion, 0.0);
        for frame in 0..2 {
            track(&mut tracker, frame, views(&model, Some(&truth(&model, frame as f64))));
        }
        assert!(track(&mut tracker, 2, views(&model, None)).is_lost());
        let elsewhere = truth(&model, 8.0);
        let found = track(&mut tracker, 3, views(&model, Some(&elsewhere)));
        assert!(!found.is_lost() && mean_joint_error_mm(&model, &found.pose, &elsewhere) < 20.0);
        assert_eq!(tracker.start_of(4), found.pose, "{motion:?}");
        let begins = found.belief.and_then(|belief| belief.begins);
        assert_eq!(begins, matches!(motion, Motion::Kalman(_)).then_some(Begins::AfterLoss));
    }
}

#[test]
fn options_that_make_no_sense_are_named() {
    let model = Arc::new(builtin::upper_body());
    let refused = |motion, rate| {
        let tracker = Tracker::new(Arc::clone(&model), FitOptions::default(), Pose::rest(&model)).unwrap();
        tracker.with_motion(motion, rate).unwrap_err().to_string()
    };
    let noise = KalmanOptions { turn_acceleration: -1.0, ..KalmanOptions::default() };
    assert!(refused(Motion::Kalman(noise), RATE).contains("kalman.turn_acceleration"));
    assert!(refused(Motion::Velocity, 0.0).contains("frame_rate"));
}

fn normal(random: &mut Pcg64Mcg, size: usize) -> DVector<f64> {
    DVector::from_fn(size, |_, _| {
        let (u, v): (f64, f64) = (random.random_range(f64::MIN_POSITIVE..1.0), random.random_range(0.0..1.0));
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    })
}

/// One simulated sequence on the manifold, of root and two rotations, drawn from the model itself and followed by a filter
/// whose accelerations are `factor` times the true ones. NIS of all frames, NEES of the last one.
fn simulated(seed: u64, factor: f64) -> (Innovation, f64) {
    const N: usize = 9;
    let random = &mut Pcg64Mcg::seed_from_u64(seed);
    let truth = ConstantVelocity { acceleration: DVector::from_element(N, 2.0), memory: 0.5 };
    let filter = ConstantVelocity { acceleration: &truth.acceleration * factor, ..truth.clone() };
    let mut belief = Belief::at_rest(&DVector::from_element(N, 0.05), &DVector::from_element(N, 1.0));
    let (mut mean, mut pose) = (DVector::zeros(N), normal(random, N) * 0.05);
    let mut velocity = normal(random, N);
    let variance: f64 = 0.3;
    let mut sum = Innovation::default();
    for frame in 0..30 {
        let seconds = [1.0 / 30.0, 1.0 / 10.0, 1.0 / 60.0][frame % 3];
        let nothing = Belief { velocity: velocity.clone(), covariance: DMatrix::zeros(2 * N, 2 * N) };
        let (step, noise) = truth.predict(&nothing, seconds);
        let drawn = noise.covariance.cholesky().unwrap().l() * normal(random, 2 * N);
        pose = tangent::compose(&tangent::compose(&pose, &step), &drawn.rows(0, N).into_owned());
        velocity = noise.velocity + drawn.rows(N, N);

        let (step, prior) = filter.predict(&belief, seconds);
        mean = tangent::compose(&mean, &step);
        // Seven numbers that tell of nine columns: two directions are not seen.
        let jacobian = DMatrix::from_fn(7, N, |i, j| 12.0 * ((3 * i + 5 * j + frame * i * j) as f64).sin());
        let residual = normal(random, 7) * variance.sqrt() + &jacobian * tangent::compose(&-&mean, &pose);
        let products = jacobian.tr_mul(&jacobian);
        let information = &products / variance + prior.pose_information().unwrap();
        let step = information.cholesky().unwrap().solve(&(jacobian.tr_mul(&residual) / variance));
        let (updated, innovation) = update(&prior, &step, &products, variance).unwrap();
        mean = tangent::compose(&mean, &step);
        belief = updated;
        sum += innovation;
    }
    let mut error = DVector::zeros(2 * N);
    error.rows_mut(0, N).copy_from(&tangent::compose(&-&mean, &pose));
    error.rows_mut(N, N).copy_from(&(velocity - &belief.velocity));
    (sum, error.dot(&belief.covariance.cholesky().unwrap().solve(&error)))
}

/// Between these 95 of 100 sums of `degrees` squares of unit normal numbers lie, divided by `degrees`
/// (E. B. Wilson, M. M. Hilferty, 1931: within 1 % from twenty degrees on).
fn chi_square_bounds(degrees: usize) -> [f64; 2] {
    let spread = 2.0 / (9.0 * degrees.max(1) as f64);
    [-1.959_964, 1.959_964].map(|z: f64| (1.0 - spread + z * spread.sqrt()).powi(3))
}

#[test]
fn the_bounds_are_the_tables() {
    // From tables of the chi-square distribution: 2.5 % and 97.5 %.
    for (degrees, table) in [(20, [9.591, 34.170]), (100, [74.222, 129.561])] {
        for (found, expected) in chi_square_bounds(degrees).into_iter().zip(table) {
            let error = found * degrees as f64 / expected - 1.0;
            assert!(error.abs() < 0.01, "{degrees}: {found} {expected}");
        }
    }
}

/// NIS and NEES, eᵀ P⁻¹ e of the state's error e, of two hundred sequences lie within the 95 % bounds of chi-square; of a filter
/// that believes in a tenth of the accelerations they do not (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with
/// Applications to Tracking and Navigation", 2001, section 5.4).
#[test]
fn the_filter_errs_as_it_says() {
    const RUNS: u64 = 200;
    let all = |factor: f64| {
        let mut sum = (Innovation::default(), 0.0);
        for (innovation, error) in (1..=RUNS).map(|seed| simulated(seed, factor)) {
            sum.0 += innovation;
            sum.1 += error;
        }
        sum
    };
    let degrees = 18 * RUNS as usize;
    let inside = |ratio: f64, degrees| {
        let [low, high] = chi_square_bounds(degrees);
        (low..high).contains(&ratio)
    };
    let (innovation, error) = all(1.0);
    let (nis, nees) = (innovation.ratio().unwrap(), error / degrees as f64);
    assert!(inside(nis, innovation.directions), "NIS {nis} of {}", innovation.directions);
    assert!(inside(nees, degrees), "NEES {nees} of {degrees}");
    let (innovation, error) = all(0.1);
    assert!(innovation.ratio().unwrap() > 1.3 && error / degrees as f64 > 1.3, "{innovation:?} {error}");
}
