//! The filter, step by step: one part of the body a step, all parts a layer.

use std::sync::Arc;

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;

use super::likelihood::Likelihood;
use super::options::{ParticleError, ParticleOptions};
use super::weights::{resampled, tempered};
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{FitView, PreparedFit};
use crate::geometry::rotation::exp;
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
pub struct Part {
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
    /// The likelihood's β, per squared grey level.
    pub beta: f64,
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
    /// Its cost by the last layer's stage.
    pub cost: f64,
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
    parts: Vec<Part>,
    /// Where the particles of the next step come from, and which child of its parent each is.
    poses: Vec<(Pose, usize)>,
    next: usize,
    evaluations: usize,
    best: (f64, Pose),
}

impl ParticleFilter {
    /// A filter whose particles begin at the starts, in turn.
    ///
    /// # Errors
    /// No start or one that is not the model's, data that are not the cameras', numbers that make no sense, or no camera
    /// with a silhouette.
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
            start.check(&model).map_err(crate::fit::FitError::from)?;
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
            best: (f64::INFINITY, prepared.start),
            model,
            options,
        })
    }

    /// The parts of the body, in the order in which they are sampled.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
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
        let (weights, beta) = tempered(&costs, self.options.alive);
        self.poses = children(&sampled, &resampled(&weights, self.random(step, 0).random_range(0.0..1.0)));
        let particles = sampled.into_iter().zip(weights);
        let particles: Vec<Particle> =
            particles.map(|((cost, pose), weight)| Particle { pose, cost, weight }).collect();
        self.evaluations += particles.len();
        self.next += 1;
        let generation =
            Generation { layer, part: index, drawn, particles, beta, evaluations: self.evaluations };
        self.best = (generation.best().cost, generation.best().pose.clone());
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
        let (cost, pose) = self.best.clone();
        FilterSummary { pose, cost, evaluations: self.evaluations, cancelled: self.next < self.steps() }
    }

    /// A pose with one part moved by the layer's noise.
    fn moved(&self, from: &Pose, part: &Part, shrunk: f64, random: &mut Pcg64Mcg) -> Pose {
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
fn parts(model: &Model, partitioned: bool) -> Vec<Part> {
    let limbs = model.limbs().len();
    if !partitioned {
        let rotations = (0..model.rotation_count()).collect();
        return vec![Part { name: "body".into(), rotations, moves_root: true, drawn: vec![true; limbs] }];
    }
    let mut chains = Chains::new(model);
    chains.chains.sort_by_key(|chain| chain.rotations.len());
    let trunk = ("trunk".to_owned(), chains.trunk.clone());
    let name = |rotation: usize| model.limbs()[model.rotation_owners()[rotation]].name.clone();
    let own = chains.chains.iter().map(|chain| (name(chain.rotations[0]), chain.rotations.clone()));
    let mut drawn = vec![false; limbs];
    let mut list = Vec::with_capacity(chains.chains.len() + 1);
    for (index, (name, rotations)) in std::iter::once(trunk).chain(own).enumerate() {
        for &limb in rotations.iter().flat_map(|&rotation| &chains.groups[rotation]) {
            drawn[limb] = true;
        }
        list.push(Part { name, rotations, moves_root: index == 0, drawn: drawn.clone() });
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
