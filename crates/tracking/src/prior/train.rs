//! From clips of motion to a prior: expectation maximisation of a mixture of Student's t (Peel and `McLachlan`, 2000), ν fixed.
//!
//! E: rₖ = πₖ pₖ(x)/p(x), uₖ = (ν + D)/(ν + mₖ). M: πₖ = mean of rₖ, μₖ = Σ rₖ uₖ x / Σ rₖ uₖ,
//! Σₖ = Σ rₖ uₖ (x − μₖ)(x − μₖ)ᵀ / Σ rₖ + f² I. The floor f is what bones, rest poses and retargeting leave unsure, and what keeps
//! few poses from being believed too well; it also stands for the length of a direction, which never differs from 1.
//!
//! Every frame counts once as it is and once mirrored. Left parts are the right ones, mirrored.

use glam::DVec3;
use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use thiserror::Error;

use super::accelerations::Accelerations;
use super::direction::{BodyDirection, BodyPoints};
use super::mixture::{StudentComponent, StudentMixture, lower_triangle, symmetric};
use super::statistics::{PosePrior, PriorError, PriorPart, StepStatistics};
use crate::numbers::{OptionError, POSITIVE, Range, check_options};

/// Times over which steps are looked at, seconds; the second one is what a prior holds.
const STEP_SECONDS: [f64; 4] = [1.0 / 30.0, 1.0 / 15.0, 2.0 / 15.0, 4.0 / 15.0];
const HELD: usize = 1;
/// Steps are never surer than this: errors of directions, as capture leaves them.
const STEP_FLOOR: f64 = 0.02;
/// Rounds of the single distribution of steps.
const STEP_ROUNDS: usize = 20;
/// The trunk, and the parts of the right side.
const TRUNK: [BodyDirection; 2] = [BodyDirection::ChestUp, BodyDirection::ChestLeft];
const ARM: [BodyDirection; 2] = [BodyDirection::RightUpperArm, BodyDirection::RightForearm];
const LEG: [BodyDirection; 3] =
    [BodyDirection::RightThigh, BodyDirection::RightCalf, BodyDirection::RightFoot];

/// A person's joints, frame after frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// Seconds from frame to frame.
    pub frame_seconds: f64,
    /// The frames.
    pub frames: Vec<BodyPoints>,
}

/// How to train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrainOptions {
    /// Components of each part.
    pub components: usize,
    /// ν: the fewer, the heavier the tails.
    pub degrees: f64,
    /// f: no component is surer than this, radians.
    pub floor: f64,
    /// Poses nearer in time than this to one another are one, seconds.
    pub every_seconds: f64,
    /// Rounds of expectation maximisation.
    pub rounds: usize,
    /// Seed of the first means.
    pub seed: u64,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self { components: 12, degrees: 4.0, floor: 0.15, every_seconds: 0.1, rounds: 60, seed: 1 }
    }
}

/// Why nothing can be learnt.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum TrainError {
    #[error("there are {found} poses; expected {expected} or more, ten a component")]
    TooFew { found: usize, expected: usize },
    #[error(transparent)]
    Option(#[from] OptionError),
    #[error(transparent)]
    Prior(#[from] PriorError),
}

/// Learns poses, steps and accelerations. The same clips give the same prior.
///
/// # Errors
/// If there are too few poses or an option is out of range.
pub fn train(clips: &[Clip], options: &TrainOptions, source: &str) -> Result<PosePrior, TrainError> {
    check(clips, options)?;
    let mut parts = Vec::new();
    for (name, directions) in [("trunk", &TRUNK[..]), ("arm", &ARM[..]), ("leg", &LEG[..])] {
        let poses = poses(clips, directions, options.every_seconds);
        let (found, expected) = (poses.len(), 10 * options.components);
        if found < expected {
            return Err(TrainError::TooFew { found, expected });
        }
        let components = mixture(&poses, options);
        let step = steps(clips, directions, options)
            .ok_or(TrainError::TooFew { found: 0, expected: 10 * directions.len() })?;
        let mut add = |name: &str, directions, components, step| {
            PriorPart::new(name, directions, components, step, options.degrees).map(|part| parts.push(part))
        };
        if directions == TRUNK {
            add(name, directions.to_vec(), components, step)?;
            continue;
        }
        let left: Vec<BodyDirection> = directions.iter().map(|direction| on_the_left(*direction)).collect();
        let mirrored = components.iter().map(mirrored_component).collect();
        let covariance = mirrored_covariance(&step.covariance, 3 * directions.len());
        let left_step = StepStatistics { covariance, ..step.clone() };
        add(&format!("right {name}"), directions.to_vec(), components, step)?;
        add(&format!("left {name}"), left, mirrored, left_step)?;
    }
    let prior = PosePrior::new(source, parts)?;
    Ok(match Accelerations::learn(clips) {
        Some(accelerations) => prior.with_accelerations(accelerations)?,
        None => prior,
    })
}

fn check(clips: &[Clip], options: &TrainOptions) -> Result<(), OptionError> {
    const SECONDS: Range = Range(POSITIVE.0, "seconds above 0");
    let components = Range(|value| (1.0..=256.0).contains(&value), "1 to 256");
    let own = [
        ("components", options.components as f64, components),
        ("degrees", options.degrees, Range(POSITIVE.0, "a number above 0")),
        ("floor", options.floor, Range(|value| value > 0.0 && value <= 1.0, "radians above 0, at most 1")),
        ("every_seconds", options.every_seconds, SECONDS),
    ];
    check_options(
        own.into_iter().chain(clips.iter().map(|clip| ("frame_seconds", clip.frame_seconds, SECONDS))),
    )
}

fn on_the_left(direction: BodyDirection) -> BodyDirection {
    let index = BodyDirection::ALL.iter().position(|one| *one == direction).unwrap_or_default();
    BodyDirection::ALL[index ^ 1]
}

/// Of directions that are no axes of the chest: those only change the sign of their first number.
fn sign(index: usize) -> f64 {
    if index.is_multiple_of(3) { -1.0 } else { 1.0 }
}

fn mirrored_component(component: &StudentComponent) -> StudentComponent {
    StudentComponent {
        share: component.share,
        mean: component.mean.iter().enumerate().map(|(index, value)| sign(index) * value).collect(),
        covariance: mirrored_covariance(&component.covariance, component.mean.len()),
    }
}

fn mirrored_covariance(lower: &[f64], size: usize) -> Vec<f64> {
    let turned = |row, column, value: f64| sign(row) * sign(column) * value;
    lower_triangle(&symmetric(lower, size).map_with_location(turned))
}

/// The numbers of every pose that counts, as it is and mirrored.
fn poses(clips: &[Clip], directions: &[BodyDirection], every_seconds: f64) -> Vec<DVector<f64>> {
    let both = |points: &BodyPoints| [*points, points.mirrored()];
    let of_clip = |clip: &Clip| {
        let every = (every_seconds / clip.frame_seconds).round().max(1.0) as usize;
        let frames = clip.frames.iter().step_by(every).flat_map(both);
        frames.filter_map(|points| points.numbers(directions).map(DVector::from_vec)).collect::<Vec<_>>()
    };
    clips.iter().flat_map(of_clip).collect()
}

fn mixture(poses: &[DVector<f64>], options: &TrainOptions) -> Vec<StudentComponent> {
    let size = poses[0].len();
    let floor = DMatrix::identity(size, size) * options.floor.powi(2);
    let overall = weighted_covariance(poses, &vec![1.0; poses.len()], poses.len() as f64, &mean_of(poses));
    let share = 1.0 / options.components as f64;
    let mut components: Vec<StudentComponent> = first_means(poses, options)
        .into_iter()
        .map(|mean| StudentComponent {
            share,
            mean: mean.as_slice().to_vec(),
            covariance: lower_triangle(&(&overall * 0.1 + &floor)),
        })
        .collect();
    for _ in 0..options.rounds {
        let Some(mixture) = StudentMixture::new(components.clone(), options.degrees) else { break };
        let believed: Vec<Vec<[f64; 2]>> = poses.iter().map(|x| mixture.weights(x)).collect();
        components = (0..components.len())
            .filter_map(|index| {
                let responsible: f64 = believed.iter().map(|all| all[index][0]).sum();
                // A component that lost its poses is none.
                if responsible < 1.0 {
                    return None;
                }
                let weights: Vec<f64> = believed.iter().map(|all| all[index][0] * all[index][1]).collect();
                let whole: f64 = weights.iter().sum();
                let mut mean = DVector::zeros(size);
                poses.iter().zip(&weights).for_each(|(x, weight)| mean.axpy(weight / whole, x, 1.0));
                let covariance = weighted_covariance(poses, &weights, responsible, &mean) + &floor;
                Some(StudentComponent {
                    share: responsible / poses.len() as f64,
                    mean: mean.as_slice().to_vec(),
                    covariance: lower_triangle(&covariance),
                })
            })
            .collect();
    }
    components
}

fn mean_of(poses: &[DVector<f64>]) -> DVector<f64> {
    let sum = poses.iter().fold(DVector::zeros(poses[0].len()), |sum, x| sum + x);
    sum / poses.len() as f64
}

fn weighted_covariance(
    poses: &[DVector<f64>],
    weights: &[f64],
    whole: f64,
    mean: &DVector<f64>,
) -> DMatrix<f64> {
    let mut sum = DMatrix::zeros(mean.len(), mean.len());
    for (x, &weight) in poses.iter().zip(weights).filter(|(_, weight)| **weight > 1e-9) {
        let off = x - mean;
        sum.ger(weight / whole, &off, &off, 1.0);
    }
    sum
}

/// Poses far from one another (k-means++: D. Arthur and S. Vassilvitskii, 2007).
fn first_means(poses: &[DVector<f64>], options: &TrainOptions) -> Vec<DVector<f64>> {
    let mut random = Pcg64Mcg::seed_from_u64(options.seed);
    let mut means = vec![poses[random.random_range(0..poses.len())].clone()];
    let mut nearest = vec![f64::INFINITY; poses.len()];
    while means.len() < options.components {
        let last = &means[means.len() - 1];
        nearest.iter_mut().zip(poses).for_each(|(near, x)| *near = near.min((x - last).norm_squared()));
        let mut left = random.random::<f64>() * nearest.iter().sum::<f64>();
        let chosen = nearest.iter().position(|near| {
            left -= near;
            left <= 0.0
        });
        means.push(poses[chosen.unwrap_or(poses.len() - 1)].clone());
    }
    means
}

/// How far a part is from where the two poses before lead, after each of [`STEP_SECONDS`]. `None` where no clip is long enough.
fn steps(clips: &[Clip], directions: &[BodyDirection], options: &TrainOptions) -> Option<StepStatistics> {
    let mut covariances = Vec::new();
    for seconds in STEP_SECONDS {
        let mut off = Vec::new();
        for clip in clips {
            let gap = (seconds / clip.frame_seconds).round() as usize;
            if gap == 0 || clip.frames.len() <= 2 * gap {
                continue;
            }
            let both = [false, true];
            for (index, mirror) in (2 * gap..clip.frames.len()).flat_map(|i| both.map(|mirror| (i, mirror))) {
                let numbers = |frame: usize| {
                    let points = &clip.frames[frame];
                    if mirror { points.mirrored() } else { *points }.numbers(directions)
                };
                let (Some(now), Some(before), Some(first)) =
                    (numbers(index), numbers(index - gap), numbers(index - 2 * gap))
                else {
                    continue;
                };
                off.push(DVector::from_vec(prediction_error(&now, &before, &first)));
            }
        }
        if off.len() < 10 * directions.len() {
            return None;
        }
        covariances.push(step_covariance(&off, options.degrees));
    }
    let spread = |index: usize| covariances[index].trace().max(f64::MIN_POSITIVE).ln();
    // The slope of a line through ln(spread) over ln(seconds), which lie at equal distances.
    let rise: f64 = (0..STEP_SECONDS.len()).map(|i| (i as f64 - 1.5) * spread(i)).sum::<f64>() / 5.0;
    Some(StepStatistics {
        seconds: STEP_SECONDS[HELD],
        exponent: (rise / std::f64::consts::LN_2).clamp(0.0, 8.0),
        covariance: lower_triangle(&covariances[HELD]),
    })
}

/// Where each direction is, from where its turn of the step before leads.
fn prediction_error(now: &[f64], before: &[f64], first: &[f64]) -> Vec<f64> {
    let threes = |all: &[f64]| all.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>();
    let (now, before, first) = (threes(now), threes(before), threes(first));
    let error = now.iter().zip(&before).zip(&first).flat_map(|((now, before), first)| {
        let turn = glam::DQuat::from_rotation_arc(*first, *before);
        (*now - turn * *before).to_array()
    });
    error.collect()
}

/// Of one Student's t of mean zero.
fn step_covariance(off: &[DVector<f64>], degrees: f64) -> DMatrix<f64> {
    let size = off[0].len();
    let zero = DVector::zeros(size);
    let floor = DMatrix::identity(size, size) * STEP_FLOOR.powi(2);
    let mut covariance = weighted_covariance(off, &vec![1.0; off.len()], off.len() as f64, &zero) + &floor;
    for _ in 0..STEP_ROUNDS {
        let one =
            StudentComponent { share: 1.0, mean: vec![0.0; size], covariance: lower_triangle(&covariance) };
        let Some(mixture) = StudentMixture::new(vec![one], degrees) else { break };
        let weights: Vec<f64> = off.iter().map(|x| mixture.weights(x)[0][1]).collect();
        covariance = weighted_covariance(off, &weights, off.len() as f64, &zero) + &floor;
    }
    covariance
}

#[cfg(test)]
mod tests {
    use super::super::direction::tests::standing;
    use super::*;

    /// Someone whose right forearm goes up and down, now ahead and now aside, while the rest stands.
    fn clips(frames: usize) -> Vec<Clip> {
        let at = |frame: usize| {
            let mut points = standing();
            let angle = 1.2 + 0.6 * (0.1 * frame as f64).sin();
            let out = if (frame / 40).is_multiple_of(2) { DVec3::Y } else { DVec3::X };
            points.wrists[0] = points.elbows[0] + 0.26 * (angle.sin() * out - angle.cos() * DVec3::Z);
            points
        };
        vec![Clip { frame_seconds: 1.0 / 30.0, frames: (0..frames).map(at).collect() }]
    }

    #[test]
    fn what_was_seen_is_likely_and_what_was_not_is_not() {
        let options = TrainOptions { components: 3, ..TrainOptions::default() };
        let prior = train(&clips(400), &options, "synthetic").unwrap();
        let names: Vec<&str> = prior.parts.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["trunk", "right arm", "left arm", "right leg", "left leg"]);
        let energy = |part: usize, points: &BodyPoints| {
            let part = &prior.parts[part];
            part.poses.pull(&DVector::from_vec(points.numbers(&part.directions).unwrap())).energy
        };
        let seen = clips(400)[0].frames[17];
        let mut behind = seen;
        behind.wrists[0] = behind.elbows[0] - 0.26 * DVec3::Y;
        assert!(energy(1, &seen) + 8.0 < energy(1, &behind), "{} {}", energy(1, &seen), energy(1, &behind));
        // The left arm never moved, but what the right one does the left one may.
        assert!((energy(2, &seen.mirrored()) - energy(1, &seen)).abs() < 1e-9);
        assert!(energy(2, &behind.mirrored()) > energy(2, &seen.mirrored()) + 8.0);
        assert!((0.0..5.0).contains(&energy(0, &seen)), "{}", energy(0, &seen));
    }

    #[test]
    fn longer_steps_lead_farther_and_the_same_clips_give_the_same() {
        let options = TrainOptions { components: 3, ..TrainOptions::default() };
        let (one, other) = (train(&clips(400), &options, "a"), train(&clips(400), &options, "a"));
        assert_eq!(one, other);
        let arm = &one.unwrap().parts[1].clone();
        assert!(arm.step.exponent > 0.5, "{}", arm.step.exponent);
        let off = DVector::from_element(6, 0.1);
        let energy = |seconds| arm.step_pull(&off, seconds).energy;
        assert!(energy(0.03) > energy(0.1) && energy(0.1) > energy(0.3));
    }

    #[test]
    fn what_cannot_be_learnt_from_is_said() {
        let wrong = |change: fn(&mut TrainOptions)| {
            let mut options = TrainOptions::default();
            change(&mut options);
            train(&clips(100), &options, "").unwrap_err().to_string()
        };
        assert!(wrong(|options| options.components = 0).contains("`components` is 0"));
        assert!(wrong(|options| options.floor = f64::NAN).contains("`floor`"));
        assert!(wrong(|options| options.components = 50).contains("expected 500 or more"));
    }
}
