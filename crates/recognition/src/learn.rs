//! From named motions to a [`Recognizer`].

use std::collections::BTreeSet;

use nalgebra::DVector;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use thiserror::Error;

use crate::augment::{self, PersonVariation, TrackerNoise, unit};
use crate::discriminant::{AxesOptions, Discriminant, Learnt, Nuisance, Sample, balanced_weights};
use crate::features::body_size;
use crate::hmm::{HiddenMarkov, HmmOptions};
use crate::joints::{JointMotion, MotionError};
use crate::nearest::Exemplars;
use crate::novelty::Novelty;
use crate::observed::Observed;
use crate::principal::PrincipalComponents;
use crate::radial::RadialBasis;
use crate::recognizer::{PlaneCloud, Recognizer};
use crate::svm::SupportVectors;

/// A motion whose class is known.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedMotion {
    /// What the motion is called, for messages.
    pub name: String,
    /// Its class.
    pub class: String,
    /// Who moves.
    pub subject: String,
    /// The joints.
    pub motion: JointMotion,
}

/// How a recognizer is learnt.
#[derive(Debug, Clone, PartialEq)]
pub struct LearnOptions {
    /// Copies of each motion by other people, with other speed and a tracker's noise.
    pub copies: usize,
    /// Most deviation of the noise of a copy along each axis, metres of an adult; each copy has a part of it.
    pub noise_m: f64,
    /// How far the people of the copies differ from those who were recorded.
    pub variation: PersonVariation,
    /// Axes that tell classes apart.
    pub axes: AxesOptions,
    /// The classes' models.
    pub hmm: HmmOptions,
    /// What a sample costs the support vector machine of the radial basis.
    pub cost: f64,
    /// What a sample costs the support vector machine of the measures, of which there are many more.
    pub wide_cost: f64,
    /// Nats that going from one class to another costs.
    pub switch_penalty: f64,
    /// Seed of the copies.
    pub seed: u64,
}

impl Default for LearnOptions {
    fn default() -> Self {
        Self {
            copies: 4,
            noise_m: 0.03,
            variation: PersonVariation::default(),
            axes: AxesOptions::default(),
            hmm: HmmOptions::default(),
            cost: 0.03,
            wide_cost: 0.0003,
            switch_penalty: 6.0,
            seed: 1,
        }
    }
}

/// Why nothing can be learnt.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum LearnError {
    #[error("{found} classes among the motions; expected two at least")]
    Classes { found: usize },
    #[error("{name}: {error}")]
    Motion { name: String, error: MotionError },
}

impl LearnError {
    /// What is wrong with a motion.
    pub(crate) fn of(named: &NamedMotion) -> impl Fn(MotionError) -> Self {
        |error| Self::Motion { name: named.name.clone(), error }
    }
}

/// A motion and its copies, measured once to be learnt from many times.
#[derive(Debug, Clone)]
pub struct Prepared<'a> {
    /// The motion.
    pub named: &'a NamedMotion,
    /// The motion as it is, first, and its copies.
    pub seen: Vec<Observed>,
}

/// Speeds of copies.
const SPEEDS: [f64; 5] = [0.85, 0.92, 1.0, 1.08, 1.18];
/// How long the smooth part of the noise lasts, seconds.
const MEMORY_S: f64 = 0.25;
/// Every n frames one is used for the plane.
const PLANE_STEP: usize = 5;

/// Measures a motion and its copies.
///
/// # Errors
/// The joints do not lie as a person's.
pub fn prepare<'a>(
    named: &'a NamedMotion,
    options: &LearnOptions,
    number: u64,
) -> Result<Prepared<'a>, LearnError> {
    let mut random = Pcg64Mcg::seed_from_u64(options.seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let size = body_size(&named.motion);
    let mut seen = vec![Observed::new(&named.motion).map_err(LearnError::of(named))?];
    for copy in 0..options.copies {
        let speed = SPEEDS[(unit(&mut random) * SPEEDS.len() as f64) as usize];
        let noise = TrackerNoise {
            deviation: options.noise_m * size * unit(&mut random),
            smooth: unit(&mut random),
            memory_s: MEMORY_S,
        };
        let changed = augment::faster(&named.motion, speed);
        let seed = options.seed + 1000 * number + copy as u64;
        let changed = augment::by_another_person(&changed, options.variation, seed);
        let changed = augment::noisy(&changed, noise, seed);
        seen.push(Observed::new(&changed).map_err(LearnError::of(named))?);
    }
    Ok(Prepared { named, seen })
}

/// All of some motions.
pub(crate) fn prepare_all<'a>(
    motions: &'a [NamedMotion],
    options: &LearnOptions,
) -> Result<Vec<Prepared<'a>>, LearnError> {
    motions.iter().zip(0..).map(|(named, number)| prepare(named, options, number)).collect()
}

/// Names without repetition, in their order.
pub(crate) fn distinct<'a>(names: impl Iterator<Item = &'a String>) -> Vec<String> {
    names.collect::<BTreeSet<_>>().into_iter().cloned().collect()
}

impl Recognizer {
    /// Learns from motions of two classes at least. The same input gives the same recognizer.
    ///
    /// # Errors
    /// One class only, or joints that do not lie as a person's.
    pub fn learn(motions: &[NamedMotion], options: &LearnOptions) -> Result<Self, LearnError> {
        Self::learn_prepared(&prepare_all(motions, options)?.iter().collect::<Vec<_>>(), options)
    }

    /// The same from motions that were measured before.
    ///
    /// # Errors
    /// One class only.
    pub fn learn_prepared(motions: &[&Prepared<'_>], options: &LearnOptions) -> Result<Self, LearnError> {
        let classes = distinct(motions.iter().map(|motion| &motion.named.class));
        let subjects = distinct(motions.iter().map(|motion| &motion.named.subject));
        if classes.len() < 2 {
            return Err(LearnError::Classes { found: classes.len() });
        }
        let number = |names: &[String], name: &str| names.iter().position(|known| known == name).unwrap_or(0);
        let samples = |of: &dyn Fn(&Observed) -> Vec<Vec<f64>>| -> Vec<Sample> {
            let mut samples = Vec::new();
            for Prepared { named, seen } in motions {
                let (class, subject) = (number(&classes, &named.class), number(&subjects, &named.subject));
                samples.extend(seen.iter().flat_map(of).map(|row| Sample { row, class, subject }));
            }
            samples
        };
        let windows =
            samples(&|seen| seen.window_starts().into_iter().map(|start| seen.window(start)).collect());
        let shorts = samples(&|seen| seen.short.clone());
        let learnt = Discriminant::learn(&windows, options.axes);
        let short = Discriminant::learn(&shorts, options.axes).discriminant;
        let weights = balanced_weights(&windows);
        let novelty = Novelty::learn(&learnt, &windows, &weights, options.axes);
        let Learnt { discriminant: long, nuisance: Nuisance { whitening, .. }, .. } = learnt;
        let places: Vec<Vec<f64>> = windows.iter().map(|one| long.project(&one.row)).collect();
        let numbers: Vec<usize> = windows.iter().map(|one| one.class).collect();
        let white = |one: &Sample| &whitening * DVector::from_vec(long.standardised(&one.row));
        let white: Vec<Vec<f64>> = windows.iter().map(|one| white(one).as_slice().to_vec()).collect();
        let machine = |rows: &[Vec<f64>], cost: f64| {
            let costs: Vec<f64> = weights.iter().map(|weight| cost * weight).collect();
            SupportVectors::learn(rows, &numbers, &costs, classes.len())
        };
        let basis = RadialBasis::learn(&windows, &places);
        let near: Vec<Vec<f64>> = places.iter().map(|place| basis.values(place)).collect();
        let (plane, clouds) = plane(motions, &classes);
        Ok(Self {
            machine: machine(&near, options.cost),
            basis,
            wide_machine: machine(&white, options.wide_cost).before(&whitening),
            novelty,
            models: models(motions, &shorts, &short, classes.len(), &options.hmm),
            exemplars: Some(Exemplars { places, classes: numbers, weights }),
            classes,
            plane,
            clouds,
            short,
            long,
            switch_penalty: options.switch_penalty,
        })
    }
}

/// A model a class.
fn models(
    motions: &[&Prepared<'_>],
    shorts: &[Sample],
    axes: &Discriminant,
    class_count: usize,
    options: &HmmOptions,
) -> Vec<HiddenMarkov> {
    let weights = balanced_weights(shorts);
    let rows: Vec<Vec<f64>> = shorts.iter().map(|one| axes.project(&one.row)).collect();
    let mut sequences: Vec<Vec<Weighted<'_>>> = vec![Vec::new(); class_count];
    let mut first = 0;
    for seen in motions.iter().flat_map(|motion| &motion.seen) {
        let past = first + seen.short.len();
        sequences[shorts[first].class].push((&rows[first..past], weights[first]));
        first = past;
    }
    sequences.iter().map(|sequences| HiddenMarkov::learn(sequences, options)).collect()
}

/// Rows of a sequence, and how much they count.
type Weighted<'a> = (&'a [Vec<f64>], f64);

/// The plane of frames, and where classes lie on it.
fn plane(motions: &[&Prepared<'_>], classes: &[String]) -> (PrincipalComponents, Vec<PlaneCloud>) {
    let frames: Vec<(usize, Vec<f64>)> = motions
        .iter()
        .filter_map(|motion| Some((motion, motion.seen.first()?)))
        .flat_map(|(motion, seen)| {
            let class = classes.iter().position(|class| *class == motion.named.class).unwrap_or(0);
            seen.frames().into_iter().step_by(PLANE_STEP).map(move |row| (class, row))
        })
        .collect();
    let rows: Vec<Vec<f64>> = frames.iter().map(|(_, row)| row.clone()).collect();
    let plane = PrincipalComponents::of(&rows, 2);
    let cloud = |class: usize| {
        let places: Vec<[f64; 2]> = frames
            .iter()
            .filter(|(of, _)| *of == class)
            .map(|(_, row)| plane.project(row))
            .map(|place| [place[0], place[1]])
            .collect();
        let mean =
            |of: &dyn Fn(&[f64; 2]) -> f64| places.iter().map(of).sum::<f64>() / places.len().max(1) as f64;
        let [x, y] = [mean(&|p| p[0]), mean(&|p| p[1])];
        let covariance = [
            mean(&|p| (p[0] - x).powi(2)),
            mean(&|p| (p[1] - y).powi(2)),
            mean(&|p| (p[0] - x) * (p[1] - y)),
        ];
        PlaneCloud { mean: [x, y], covariance }
    };
    let clouds = (0..classes.len()).map(cloud).collect();
    (plane, clouds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognizer::Method;
    use crate::tests::{standing_and_walking, walker};

    #[test]
    fn a_motion_is_followed_by_copies_that_differ() {
        let named = &standing_and_walking()[2];
        let options = LearnOptions { copies: 3, ..LearnOptions::default() };
        let [prepared, again, other] = [5, 5, 6].map(|number| prepare(named, &options, number).unwrap());
        assert_eq!((prepared.seen.len(), prepared.named), (4, named));
        assert_eq!(prepared.seen[0].short, Observed::new(&named.motion).unwrap().short);
        for copy in 1..4 {
            assert_eq!(prepared.seen[copy].short, again.seen[copy].short);
            assert_ne!(prepared.seen[copy].short, other.seen[copy].short);
            assert_ne!(prepared.seen[copy].short, prepared.seen[0].short);
        }
    }

    #[test]
    fn one_class_cannot_be_learnt() {
        let motions = standing_and_walking();
        let error = Recognizer::learn(&motions[..2], &LearnOptions::default()).unwrap_err();
        assert_eq!(error, LearnError::Classes { found: 1 });
        assert!(error.to_string().contains("two at least"));
    }

    #[test]
    fn strangers_are_named_and_the_same_motions_give_the_same_recognizer() {
        let motions = standing_and_walking();
        let options = LearnOptions { copies: 1, ..LearnOptions::default() };
        let learnt = Recognizer::learn(&motions, &options).unwrap();
        assert_eq!(learnt, Recognizer::learn(&motions, &options).unwrap());
        assert_eq!(learnt.classes, ["stand", "walk"]);
        for (speed, class) in [(0.05, 0), (1.15, 1)] {
            let seen = Observed::new(&walker(2.0, speed)).unwrap();
            for method in Method::ALL {
                let shares = learnt.clip_shares(&seen, method);
                assert!(shares[class] > 0.6, "{} at {speed}: {shares:?}", method.name());
            }
        }
    }

    #[test]
    fn clouds_lie_where_their_frames_do() {
        let motions = standing_and_walking();
        let options = LearnOptions { copies: 0, ..LearnOptions::default() };
        let learnt = Recognizer::learn(&motions, &options).unwrap();
        for (cloud, class) in learnt.clouds.iter().zip(&learnt.classes) {
            let places: Vec<Vec<f64>> = motions
                .iter()
                .filter(|named| named.class == *class)
                .flat_map(|named| {
                    Observed::new(&named.motion).unwrap().frames().into_iter().step_by(PLANE_STEP)
                })
                .map(|row| learnt.plane.project(&row))
                .collect();
            for axis in 0..2 {
                let mean = places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64;
                assert!((mean - cloud.mean[axis]).abs() < 1e-9, "{class}: {mean} and {cloud:?}");
            }
        }
    }
}
