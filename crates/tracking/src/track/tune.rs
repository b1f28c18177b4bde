//! R and Q from innovations: the noise by which a track's measurements are most likely.
//!
//! Each frame's fit is a measurement of the pose: z = X ⊞ H⁺ Jᵀρ with covariance R H⁺, H = JᵀJ where the fit ended. A filter
//! over these, without pictures, takes a millisecond a frame, so it can be tried with many noises. With ν what a frame adds
//! to what was predicted along the directions U that are well seen, and S = Uᵀ P⁻ U + R D⁻¹ (H U = U D), the logarithm of the
//! likelihood is
//!
//! ```text
//! −½ Σ (log det S + νᵀ S⁻¹ ν)
//! ```
//!
//! (F. C. Schweppe, "Evaluation of likelihood functions for Gaussian signals", 1965). R and Q together scale S, so their
//! common size is known at once, the mean of νᵀ S⁻¹ ν; what is left, the ratios of the accelerations to R, is searched in
//! steps by halves. A constant error is in no innovation: what comes out is the noise about it.

use nalgebra::{DMatrix, DVector};

use super::estimate::Track;
use super::motion::{KalmanOptions, MotionModel, start_belief};
use crate::body::Pose;
use crate::filter::{Belief, Innovation, tangent};

/// Directions of less than this share of the largest eigenvalue of JᵀJ tell of priors and noise, not of motion.
const WELL_SEEN: f64 = 1e-3;
/// Frames that tell nothing of motion by themselves.
const FEWEST_FRAMES: usize = 10;
/// Factors by which an acceleration is changed, one after the other.
const FACTORS: [f64; 3] = [4.0, 2.0, 1.25];
/// Accelerations stay within this many times what they began with, either way.
const FARTHEST: f64 = 1000.0;

/// Noise that suits a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuned {
    /// With the memory that was given.
    pub noise: KalmanOptions,
    /// How the frames agree with it: the ratio is one by construction.
    pub innovation: Innovation,
    /// The same with the noise that was given.
    pub before: Innovation,
    /// By how much the logarithm of the likelihood rose.
    pub gain: f64,
}

/// A frame as a measurement of the pose.
struct Measured {
    /// Since the frame before and the step from its pose; `None` where the filter began.
    since: Option<(f64, DVector<f64>)>,
    /// U, n × m.
    directions: DMatrix<f64>,
    /// Uᵀ H⁺ Jᵀρ.
    offset: DVector<f64>,
    /// D⁻¹: variances per R.
    variances: DVector<f64>,
}

/// All frames, and how the joints of their body move.
struct Measurements<'a> {
    frames: Vec<Measured>,
    motion: &'a MotionModel,
}

/// The noise by which a track that a Kalman filter followed is most likely. `None` where fewer than ten frames go on from
/// the one before.
#[must_use]
pub fn tune(track: &Track, from: KalmanOptions) -> Option<Tuned> {
    let measured = measurements(track);
    if measured.iter().filter(|frame| frame.since.is_some()).count() < FEWEST_FRAMES {
        return None;
    }
    let beliefs = || track.frames.values().filter_map(|frame| frame.belief.as_ref());
    let motion = beliefs().find_map(|belief| Some(&belief.predicted.as_ref()?.motion))?;
    // One R for all frames, which begins as their mean where each had its own.
    let variances: Vec<f64> =
        beliefs().filter_map(|belief| Some(belief.measurement.as_ref()?.variance)).collect();
    let mean = (variances.iter().sum::<f64>() / variances.len() as f64).sqrt();
    let deviation = Some(from.measurement_deviation.unwrap_or(mean));
    let from = KalmanOptions { measurement_deviation: deviation, ..from };
    let measured = Measurements { frames: measured, motion };
    let (likelihood_before, before) = score(&measured, &from);
    let mut best = scaled(&measured, from);
    for factor in FACTORS {
        loop {
            let begun = best;
            for (of_moves, of_turns) in
                [(factor, 1.0), (1.0 / factor, 1.0), (1.0, factor), (1.0, 1.0 / factor)]
            {
                let noise = KalmanOptions {
                    move_acceleration: best.0.move_acceleration * of_moves,
                    turn_acceleration: best.0.turn_acceleration * of_turns,
                    ..best.0
                };
                let is_near = |value: f64, of: f64| (of / FARTHEST..of * FARTHEST).contains(&value);
                if is_near(noise.move_acceleration, from.move_acceleration)
                    && is_near(noise.turn_acceleration, from.turn_acceleration)
                {
                    let tried = scaled(&measured, noise);
                    if tried.1 > best.1 {
                        best = tried;
                    }
                }
            }
            if best.1 <= begun.1 {
                break;
            }
        }
    }
    let (likelihood, innovation) = score(&measured, &best.0);
    Some(Tuned { noise: best.0, innovation, before, gain: likelihood - likelihood_before })
}

/// The noise at its most likely common size, and the logarithm of the likelihood.
fn scaled(measured: &Measurements, noise: KalmanOptions) -> (KalmanOptions, f64) {
    let by = score(measured, &noise).1.ratio().unwrap_or(1.0).sqrt();
    let noise = KalmanOptions {
        measurement_deviation: noise.measurement_deviation.map(|deviation| deviation * by),
        move_acceleration: noise.move_acceleration * by,
        turn_acceleration: noise.turn_acceleration * by,
        ..noise
    };
    let likelihood = score(measured, &noise).0;
    let is_good = noise.check().is_ok() && likelihood.is_finite();
    (noise, if is_good { likelihood } else { f64::NEG_INFINITY })
}

fn measurements(track: &Track) -> Vec<Measured> {
    let mut before: Option<&Pose> = None;
    let mut found = Vec::new();
    let backwards = |frame: &&super::FrameEstimate| {
        let predicted = frame.belief.as_ref().and_then(|belief| belief.predicted.as_ref());
        predicted.is_some_and(|predicted| predicted.seconds < 0.0)
    };
    let mut frames: Vec<_> = track.frames.values().collect();
    if frames.iter().any(backwards) {
        frames.reverse();
    }
    for frame in frames {
        let last = before.take();
        let Some(belief) = &frame.belief else { continue };
        let Some(measurement) = &belief.measurement else { continue };
        let since = belief.predicted.as_ref().zip(last);
        let since =
            since.map(|(predicted, last)| (predicted.seconds, DVector::from_vec(frame.pose.local(last))));
        let eigen = measurement.products.clone().symmetric_eigen();
        let least = WELL_SEEN * eigen.eigenvalues.amax();
        let kept: Vec<usize> =
            (0..eigen.eigenvalues.len()).filter(|&at| eigen.eigenvalues[at] > least).collect();
        let directions = eigen.eigenvectors.select_columns(&kept);
        let variances =
            DVector::from_iterator(kept.len(), kept.iter().map(|&at| 1.0 / eigen.eigenvalues[at]));
        let offset = directions.tr_mul(&measurement.pull).component_mul(&variances);
        found.push(Measured { since, directions, offset, variances });
        before = Some(&frame.pose);
    }
    found
}

/// The logarithm of the likelihood but for a constant, and νᵀ S⁻¹ ν, of all frames that go on.
fn score(measured: &Measurements, noise: &KalmanOptions) -> (f64, Innovation) {
    let (mut likelihood, mut sum) = (0.0, Innovation::default());
    // The mean as a step from the frame's fitted pose, and what is believed about it.
    let mut state: Option<(DVector<f64>, Belief)> = None;
    let model = measured.motion.with_noise(*noise).constant_velocity();
    let variance = noise.measurement_deviation.unwrap_or_default().powi(2);
    for frame in &measured.frames {
        let n = frame.directions.nrows();
        let (mean, prior, counts) = match (&frame.since, state.take()) {
            (Some((seconds, step)), Some((mean, belief))) => {
                let (onwards, belief) = model.predict(&belief, *seconds);
                let prediction = tangent::compose(&tangent::compose(&-step, &mean), &onwards);
                (prediction, belief, true)
            }
            _ => (DVector::zeros(n), start_belief(n), false),
        };
        let innovation = &frame.offset - frame.directions.tr_mul(&mean);
        let to_seen = prior.covariance.columns(0, n) * &frame.directions;
        let spread = frame.directions.tr_mul(&to_seen.rows(0, n))
            + DMatrix::from_diagonal(&(&frame.variances * variance));
        let Some(factor) = spread.cholesky() else { return (f64::NEG_INFINITY, sum) };
        let weighted = factor.solve(&innovation);
        if counts {
            let squared = innovation.dot(&weighted);
            likelihood -= 0.5 * squared + factor.l_dirty().diagonal().map(f64::ln).sum();
            sum += Innovation { squared, directions: innovation.len() };
        }
        let correction = &to_seen * weighted;
        let covariance = &prior.covariance - &to_seen * factor.solve(&to_seen.transpose());
        let covariance = (&covariance + covariance.transpose()) * 0.5;
        let velocity = &prior.velocity + correction.rows(n, n);
        state = Some((&mean + correction.rows(0, n), Belief { velocity, covariance }));
    }
    (likelihood, sum)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;
    use rand_pcg::rand_core::SeedableRng;

    use super::*;
    use crate::body::{Parameters, builtin};
    use crate::track::motion::{FrameMeasurement, Predicted};
    use crate::track::{Begins, FrameBelief, FrameEstimate};

    /// A limb that moves by a known noise and is measured with a known noise: both are found again, from far off.
    #[test]
    fn known_noise_is_found_again() {
        let truth = KalmanOptions {
            measurement_deviation: Some(50.0),
            turn_acceleration: 4.0,
            move_acceleration: 0.7,
            memory: 0.4,
            steers: false,
        };
        let given = KalmanOptions {
            measurement_deviation: Some(200.0),
            turn_acceleration: 1.0,
            move_acceleration: 3.0,
            ..truth
        };
        let random = &mut Pcg64Mcg::seed_from_u64(4);
        let mut normal = |size| {
            DVector::from_fn(size, |_, _| (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>())
        };
        let model = builtin::single_limb();
        let [moves, supposed] = [truth, given].map(|noise| MotionModel::new(noise, &model, None));
        let products = DMatrix::from_diagonal_element(6, 6, 1e7);
        let mut last: Option<(Pose, Belief)> = None;
        let (mut pose, mut velocity) = (Pose::rest(&model), DVector::zeros(6));
        let mut track = Track::default();
        for frame in 0..400 {
            let seconds = if frame % 3 == 0 { 0.1 } else { 1.0 / 30.0 };
            let nothing = Belief { velocity, covariance: DMatrix::zeros(12, 12) };
            let (step, noise) = moves.constant_velocity().predict(&nothing, seconds);
            let drawn = noise.covariance.cholesky().unwrap().l() * normal(12);
            pose = pose.retract(Parameters::Tangent, (step + drawn.rows(0, 6)).as_slice());
            velocity = noise.velocity + drawn.rows(6, 6);
            let error = normal(6) * (50.0 / 1e7f64.sqrt());
            let measured = pose.retract(Parameters::Tangent, error.as_slice());
            let prediction =
                |(pose, belief): &(_, _)| Predicted::after(supposed.clone(), pose, belief, seconds).into();
            let predicted = last.as_ref().map(prediction).ok_or(Begins::First);
            let measurement = FrameMeasurement {
                products: products.clone(),
                pull: DVector::zeros(6),
                variance: 200.0 * 200.0,
            };
            let belief = FrameBelief::learnt(&measured, Some(measurement), predicted);
            last = Some((measured.clone(), belief.belief.clone()));
            let estimate = FrameEstimate { belief: Some(belief), ..FrameEstimate::of_pose(frame, measured) };
            track.frames.insert(frame, estimate);
        }
        let tuned = tune(&track, given).unwrap();
        for (name, found, expected) in [
            ("R", tuned.noise.measurement_deviation.unwrap(), 50.0),
            ("turns", tuned.noise.turn_acceleration, truth.turn_acceleration),
            ("moves", tuned.noise.move_acceleration, truth.move_acceleration),
        ] {
            assert!((found / expected).ln().abs() < 0.25, "{name}: {found}, expected {expected}");
        }
        assert!((tuned.innovation.ratio().unwrap() - 1.0).abs() < 0.05 && tuned.gain > 0.0, "{tuned:?}");
        track.frames.retain(|&frame, _| frame < 5);
        assert_eq!(tune(&track, given), None);
    }
}
