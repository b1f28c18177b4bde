//! The filter, step by step: one part of the body a step, all parts a layer.

use std::sync::Arc;

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::likelihood::{Likelihood, resampled, tempered};
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{FitError, FitOptions, FitView, PreparedFit};
use crate::geometry::rotation::exp;
use crate::numbers::{NOT_NEGATIVE, OptionError, Range, check_options};
use crate::search::Chains;

/// Particles that a thread takes at a time.
const BATCH: usize = 16;

/// A pose with its weight.
#[derive(Debug, Clone, PartialEq)]
pub struct Particle {
    /// The pose.
    pub pose: Pose,
    /// Its cost by the layer's stage, of what is drawn, squared grey levels.
    pub cost: f64,
    /// Its share of all weights, 0 to 1.
    pub weight: f64,
}

/// A part of the body that is sampled in one step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Partition {
    /// What it is called: "trunk", or a chain's first limb; "body" where all is sampled at once.
    pub name: String,
    /// Its rotations.
    pub rotations: Vec<usize>,
    /// Whether the root moves with it.
    pub moves_root: bool,
    /// Per limb, whether it is drawn after this part was sampled in the first layer.
    pub drawn: Vec<bool>,
}

/// All particles after one part was sampled and weighted, before they are resampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Generation {
    /// Index of the layer.
    pub layer: usize,
    /// Index of the part ([`ParticleFilter::parts`]).
    pub part: usize,
    /// Per limb, whether it was drawn: in the first layer, what is sampled so far.
    pub drawn: Vec<bool>,
    /// All of them.
    pub particles: Vec<Particle>,
    /// Evaluations of Λ up to here.
    pub evaluations: usize,
}

impl Generation {
    /// The particle of least cost.
    #[must_use]
    pub fn best(&self) -> &Particle {
        let least = self.particles.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        least.unwrap_or(&self.particles[0])
    }

    /// How many particles share the weights: 1/Σ wᵢ².
    #[must_use]
    pub fn effective(&self) -> f64 {
        1.0 / self.particles.iter().map(|particle| particle.weight.powi(2)).sum::<f64>()
    }
}

/// What a filter found.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterSummary {
    /// The pose of least cost in the last generation.
    pub pose: Pose,
    /// Evaluations of Λ: predictions of whole or partial bodies in all cameras.
    pub evaluations: usize,
    /// Whether it was cancelled before its end.
    pub cancelled: bool,
}

/// A filter that is stepped from outside.
#[derive(Debug)]
pub struct ParticleFilter {
    model: Arc<Model>,
    options: ParticleOptions,
    /// One a layer.
    likelihoods: Vec<Arc<Likelihood>>,
    parts: Vec<Partition>,
    /// Where the particles of the next step come from, and which child of its parent each is.
    poses: Vec<(Pose, usize)>,
    next: usize,
    evaluations: usize,
    best: Pose,
}

impl ParticleFilter {
    /// A filter whose particles begin at the starts, in turn.
    ///
    /// # Errors
    /// Returns an error if there is no start or one that is not the model's, if data are not the cameras', if an option is out
    /// of range, or if no camera has a silhouette.
    pub fn new(
        model: Arc<Model>,
        views: Vec<FitView>,
        starts: &[Pose],
        options: ParticleOptions,
    ) -> Result<Self, ParticleError> {
        options.check()?;
        let first = starts.first().ok_or(ParticleError::NoStart)?;
        let fit = options.fit.clone().at_scale(&model, &views, first);
        for start in starts {
            start.check(&model).map_err(FitError::from)?;
        }
        let prepared = PreparedFit::new(&model, views, first, &fit, |_, _, _| 0.0)?;
        let stages = fit.stages.iter();
        let stages: Vec<Arc<Likelihood>> = stages
            .map(|stage| Arc::new(Likelihood::new(Arc::clone(&model), &prepared.views, &fit, stage)))
            .collect();
        let stage_of = |layer: usize| Arc::clone(&stages[layer * stages.len() / options.layers]);
        let pose = |index: usize| (starts[index % starts.len()].normalized(), index / starts.len());
        Ok(Self {
            likelihoods: (0..options.layers).map(stage_of).collect(),
            parts: parts(&model, options.partitioned),
            poses: (0..options.particles).map(pose).collect(),
            next: 0,
            evaluations: 0,
            best: prepared.start,
            model,
            options,
        })
    }

    /// The parts of the body, in the order in which they are sampled.
    #[must_use]
    pub fn parts(&self) -> &[Partition] {
        &self.parts
    }

    /// How many steps there are in all.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.options.layers * self.parts.len()
    }

    /// Samples, weighs and resamples one part; `None` after the last.
    pub fn step(&mut self) -> Option<Generation> {
        if self.next == self.steps() {
            return None;
        }
        let (layer, index) = (self.next / self.parts.len(), self.next % self.parts.len());
        let (part, likelihood) = (&self.parts[index], &self.likelihoods[layer]);
        let drawn = if layer == 0 { part.drawn.clone() } else { vec![true; self.model.limbs().len()] };
        let shrunk = self.options.decay.powi(i32::try_from(layer).unwrap_or(i32::MAX));
        let step = self.next as u64;
        let sampled = self.poses.par_iter().enumerate().with_min_len(BATCH).map_init(
            || likelihood.memory(),
            |memory, (index, (parent, child))| {
                let mut random = self.random(step, index as u64 + 1);
                // A first child stays where its parent was.
                let pose =
                    if *child == 0 { parent.clone() } else { self.moved(parent, part, shrunk, &mut random) };
                (likelihood.cost(memory, &pose, &drawn), pose)
            },
        );
        let sampled: Vec<(f64, Pose)> = sampled.collect();
        let costs: Vec<f64> = sampled.iter().map(|(cost, _)| *cost).collect();
        let (weights, _) = tempered(&costs, self.options.alive);
        self.poses = children(&sampled, &resampled(&weights, self.random(step, 0).random_range(0.0..1.0)));
        let particles = sampled.into_iter().zip(weights);
        let particles: Vec<Particle> =
            particles.map(|((cost, pose), weight)| Particle { pose, cost, weight }).collect();
        self.evaluations += particles.len();
        self.next += 1;
        let generation = Generation { layer, part: index, drawn, particles, evaluations: self.evaluations };
        self.best = generation.best().pose.clone();
        Some(generation)
    }

    /// Runs to the end or until cancelled.
    pub fn run(&mut self, cancel: &CancelToken, mut on_step: impl FnMut(&Generation)) -> FilterSummary {
        while !cancel.is_cancelled() {
            match self.step() {
                Some(generation) => on_step(&generation),
                None => break,
            }
        }
        let (pose, evaluations) = (self.best.clone(), self.evaluations);
        FilterSummary { pose, evaluations, cancelled: self.next < self.steps() }
    }

    /// A pose with one part moved by the layer's noise.
    fn moved(&self, from: &Pose, part: &Partition, shrunk: f64, random: &mut Pcg64Mcg) -> Pose {
        let options = &self.options;
        let mut pose = from.clone();
        let turn = if part.moves_root { options.trunk_turn_rad } else { options.chain_turn_rad };
        if part.moves_root {
            pose.root += normal(random) * (options.move_m * shrunk);
        }
        for &rotation in &part.rotations {
            let step = normal(random) * (turn * shrunk);
            pose.rotations[rotation] = (exp(step) * pose.rotations[rotation]).normalize();
        }
        pose
    }

    /// Random numbers of one particle in one step.
    fn random(&self, step: u64, index: u64) -> Pcg64Mcg {
        // Odd factors keep neighbours' seeds apart; the generator's own seeding mixes them.
        let seed = self.options.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let seed = seed.wrapping_add(step.wrapping_mul(0xD134_2543_DE82_EF95));
        Pcg64Mcg::seed_from_u64(seed ^ index.wrapping_mul(0xA24B_AED4_963E_E407))
    }
}

/// Every child's pose and which of its parent's children it is.
fn children(sampled: &[(f64, Pose)], parents: &[usize]) -> Vec<(Pose, usize)> {
    let mut before = (usize::MAX, 0);
    let child = |&parent: &usize| {
        before = if parent == before.0 { (parent, before.1 + 1) } else { (parent, 0) };
        (sampled[parent].1.clone(), before.1)
    };
    parents.iter().map(child).collect()
}

/// The trunk and then every chain, the shortest first; or all at once.
fn parts(model: &Model, partitioned: bool) -> Vec<Partition> {
    let limbs = model.limbs().len();
    if !partitioned {
        let rotations = (0..model.rotation_count()).collect();
        return vec![Partition {
            name: "body".into(),
            rotations,
            moves_root: true,
            drawn: vec![true; limbs],
        }];
    }
    let mut chains = Chains::new(model);
    chains.chains.sort_by_key(Vec::len);
    let trunk = ("trunk".to_owned(), chains.trunk.clone());
    let name = |rotation: usize| model.limbs()[model.rotation_owners()[rotation]].name.clone();
    let own = chains.chains.iter().map(|chain| (name(chain[0]), chain.clone()));
    let mut drawn = vec![false; limbs];
    let mut list = Vec::with_capacity(chains.chains.len() + 1);
    for (index, (name, rotations)) in std::iter::once(trunk).chain(own).enumerate() {
        for &limb in rotations.iter().flat_map(|&rotation| &chains.groups[rotation]) {
            drawn[limb] = true;
        }
        list.push(Partition { name, rotations, moves_root: index == 0, drawn: drawn.clone() });
    }
    list
}

/// Three normal deviates (G. Box and M. Muller 1958).
fn normal(random: &mut Pcg64Mcg) -> DVec3 {
    let mut pair = || {
        let radius = (-2.0 * (1.0 - random.random_range(0.0..1.0_f64)).ln()).sqrt();
        let (sine, cosine) = random.random_range(0.0..std::f64::consts::TAU).sin_cos();
        (radius * cosine, radius * sine)
    };
    let ((x, y), (z, _)) = (pair(), pair());
    DVec3::new(x, y, z)
}

/// Numbers of particles, each of which holds a pose, and of layers.
const PARTICLES: Range = Range(|value| (2.0..=1e6).contains(&value), "2 to 1000000");
const LAYERS: Range = Range(|value| (1.0..=1000.0).contains(&value), "1 to 1000");
/// What a layer leaves of deviations, and of particles.
const DECAY: Range = Range(|value| value > 0.0 && value <= 1.0, "more than 0 and less than 1");
const ALIVE: Range = Range(|value| value > 0.0 && value <= 0.999, DECAY.1);

/// How to look with particles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ParticleOptions {
    /// How many.
    pub particles: usize,
    /// Annealing layers; each samples every part of the body once. They share out the fit's stages, widest ramp first.
    pub layers: usize,
    /// Deviation of the trunk's turns in the first layer, radians about each axis.
    pub trunk_turn_rad: f64,
    /// The same of the rotations of chains.
    pub chain_turn_rad: f64,
    /// Deviation of the root in the first layer, metres along each axis.
    pub move_m: f64,
    /// Every layer's deviations, of the layer before.
    pub decay: f64,
    /// Survival rate: the share of particles that is left alive by the weights, between 0 and 1.
    pub alive: f64,
    /// Whether the trunk is sampled first and every chain after it; otherwise all at once.
    pub partitioned: bool,
    /// Seed of the random numbers.
    pub seed: u64,
    /// The solid, the stages' ramps and the weight of limits.
    pub fit: FitOptions,
}

impl Default for ParticleOptions {
    fn default() -> Self {
        Self {
            particles: 200,
            layers: 8,
            trunk_turn_rad: 0.15,
            chain_turn_rad: 0.3,
            move_m: 0.08,
            decay: 0.75,
            alive: 0.25,
            partitioned: true,
            seed: 1,
            fit: FitOptions::default(),
        }
    }
}

/// Why a particle filter cannot begin.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ParticleError {
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    Option(#[from] OptionError),
    #[error("no start was given; expected at least one pose")]
    NoStart,
}

impl ParticleOptions {
    /// Checks all but the fit's options, which are checked where the filter begins.
    ///
    /// # Errors
    /// The first option that is out of range.
    pub fn check(&self) -> Result<(), OptionError> {
        check_options([
            ("particles", self.particles as f64, PARTICLES),
            ("layers", self.layers as f64, LAYERS),
            ("trunk_turn_rad", self.trunk_turn_rad, NOT_NEGATIVE),
            ("chain_turn_rad", self.chain_turn_rad, NOT_NEGATIVE),
            ("move_m", self.move_m, NOT_NEGATIVE),
            ("decay", self.decay, DECAY),
            ("alive", self.alive, ALIVE),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_out_of_range_are_named() {
        let good = ParticleOptions::default();
        assert_eq!(good.check(), Ok(()));
        type Spoil = fn(&mut ParticleOptions);
        let wrong: [(Spoil, &str); 6] = [
            (|options| options.particles = 1, "particles"),
            (|options| options.particles = usize::MAX, "particles"),
            (|options| options.layers = 0, "layers"),
            (|options| options.move_m = f64::NAN, "move_m"),
            (|options| options.decay = 0.0, "decay"),
            (|options| options.alive = 1.0, "alive"),
        ];
        for (change, expected) in wrong {
            let mut options = good.clone();
            change(&mut options);
            let said = options.check().unwrap_err().to_string();
            assert!(said.contains(expected) && said.contains("expected"), "{said}");
        }
    }
}
