//! The cost of a pose without its derivatives: what the fit's kernels say, of all limbs or of some.

use std::sync::Arc;

use crate::body::{Kinematics, Model, Pose};
use crate::fit::{FitOptions, FitView, Stage};
use crate::render::{BACKGROUND, Ramp, RendererKind, View};
use crate::residual::pose_prior;
use crate::residual::silhouette::{KernelMemory, SampledData};

/// One stage's cost of a pose in squared grey levels: Σ w (D − Λ)² over all cameras and what joint limits add, as if every
/// pixel were sampled. To be asked from many threads, each with memory of its own.
#[derive(Debug)]
pub struct Likelihood {
    model: Arc<Model>,
    renderer: RendererKind,
    ramp: Ramp,
    cameras: Vec<(FitView, SampledData)>,
    /// Of joint limits, per rad².
    limit_weight: f64,
    /// Pixels that a sample stands for.
    pixels: f64,
}

/// What one thread needs to ask.
#[derive(Debug, Clone)]
pub struct LikelihoodMemory {
    kinematics: Kinematics,
    views: Vec<View>,
    kernels: Vec<KernelMemory>,
}

impl Likelihood {
    /// Prepares a stage. Views without a subject say nothing and are left out.
    #[must_use]
    pub fn new(model: Arc<Model>, views: &[FitView], options: &FitOptions, stage: &Stage) -> Self {
        let data = |view: &FitView| {
            let distance = view.distance(&[*stage]);
            (view.clone(), SampledData::new(&view.data(stage, distance.as_ref()), stage.stride))
        };
        Self {
            renderer: options.renderer,
            ramp: stage.ramp,
            cameras: views.iter().filter(|view| view.has_data()).map(data).collect(),
            limit_weight: options.limit_weight * stage.priors * BACKGROUND * BACKGROUND,
            pixels: (stage.stride * stage.stride) as f64,
            model,
        }
    }

    /// Memory for one thread.
    #[must_use]
    pub fn memory(&self) -> LikelihoodMemory {
        let kinematics = Kinematics::new(&self.model, &Pose::rest(&self.model));
        let view = |(view, _): &(FitView, SampledData)| {
            View::new(&self.model, &kinematics, &view.camera, self.renderer, self.ramp)
        };
        LikelihoodMemory {
            views: self.cameras.iter().map(view).collect(),
            kernels: vec![KernelMemory::default(); self.cameras.len()],
            kinematics,
        }
    }

    /// The cost of a pose. Limbs for which `drawn` is false are as if the body did not have them.
    pub fn cost(&self, memory: &mut LikelihoodMemory, pose: &Pose, drawn: &[bool]) -> f64 {
        memory.kinematics.update(&self.model, pose);
        let mut cost = 0.0;
        let own = memory.views.iter_mut().zip(&mut memory.kernels);
        for ((view, data), (drawing, kernel)) in self.cameras.iter().zip(own) {
            drawing.prepare(&self.model, &memory.kinematics, &view.camera, self.renderer, self.ramp);
            drawing.keep_limbs(drawn);
            cost += view.weight * data.cost(drawing, kernel);
        }
        self.pixels * cost + pose_prior::limit_cost(&self.model, pose, self.limit_weight)
    }
}

/// Halvings of the interval of log β.
const HALVINGS: usize = 60;
/// log β is looked for within this many powers of e about one over the costs' mean excess.
const POWERS: f64 = 40.0;

/// Normalised weights wᵢ ∝ exp(−β (cᵢ − min c)) with the β that leaves a share of them alive, 1/(N Σ wᵢ²) = `alive`; and β.
///
/// Costs that are not finite have no weight. Where all others are the same, so are the weights, and β is 0. Where no β leaves
/// as few alive (many share the least cost), the largest is taken.
///
/// ```
/// use backlit_tracking::particles::tempered;
///
/// let (weights, beta) = tempered(&[3.0, 1.0, 2.0, f64::NAN], 0.5);
/// let alive = 1.0 / (4.0 * weights.iter().map(|w| w * w).sum::<f64>());
/// assert!((alive - 0.5).abs() < 1e-9 && beta > 0.0);
/// assert!(weights[1] > weights[2] && weights[2] > weights[0] && weights[3] == 0.0);
/// ```
#[must_use]
pub fn tempered(costs: &[f64], alive: f64) -> (Vec<f64>, f64) {
    let finite = || costs.iter().copied().filter(|cost| cost.is_finite());
    let least = finite().fold(f64::INFINITY, f64::min);
    let (sum, count) = finite().fold((0.0, 0.0), |(sum, count), cost| (sum + (cost - least), count + 1.0));
    if sum <= 0.0 {
        let one = if count > 0.0 { 1.0 / count } else { 0.0 };
        return (costs.iter().map(|cost| if cost.is_finite() { one } else { 0.0 }).collect(), 0.0);
    }
    let unit = count / sum;
    let weights = |beta: f64| -> Vec<f64> {
        let raw =
            costs.iter().map(|cost| if cost.is_finite() { (-beta * (cost - least)).exp() } else { 0.0 });
        let raw: Vec<f64> = raw.collect();
        let sum: f64 = raw.iter().sum();
        raw.into_iter().map(|weight| weight / sum).collect()
    };
    let left = |weights: &[f64]| 1.0 / (costs.len() as f64 * weights.iter().map(|w| w * w).sum::<f64>());
    // The share that is alive falls as β grows.
    let (mut low, mut high) = (-POWERS, POWERS);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if left(&weights(unit * middle.exp())) > alive { low = middle } else { high = middle }
    }
    let beta = unit * (0.5 * (low + high)).exp();
    (weights(beta), beta)
}

/// Systematic resampling: the parents of as many children as there are weights, in order. `u` is uniform between 0 and 1.
///
/// Particle i has ⌊N wᵢ⌋ or ⌈N wᵢ⌉ children.
#[must_use]
pub fn resampled(weights: &[f64], u: f64) -> Vec<usize> {
    let count = weights.len();
    let mut parents = Vec::with_capacity(count);
    let (mut parent, mut up_to) = (0, weights.first().copied().unwrap_or(0.0));
    let last = weights.iter().rposition(|weight| *weight > 0.0).unwrap_or(0);
    for child in 0..count {
        let at = (child as f64 + u) / count as f64;
        while at >= up_to && parent < last {
            parent += 1;
            up_to += weights[parent];
        }
        parents.push(parent);
    }
    parents
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn alive(weights: &[f64]) -> f64 {
        1.0 / (weights.len() as f64 * weights.iter().map(|w| w * w).sum::<f64>())
    }

    proptest! {
        #[test]
        fn tempering_leaves_the_wanted_share_alive(
            costs in prop::collection::vec(0.0..1e9_f64, 20..60),
            share in 0.1..0.9_f64,
        ) {
            let (weights, beta) = tempered(&costs, share);
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            prop_assert!((alive(&weights) - share).abs() < 1e-6, "{} {share}", alive(&weights));
            // The ratio of any two weights is that of their likelihoods.
            let ratio = (weights[0] / weights[1]).ln();
            if weights[0] > 1e-200 && weights[1] > 1e-200 {
                prop_assert!((ratio + beta * (costs[0] - costs[1])).abs() < 1e-6);
            }
        }

        #[test]
        fn every_particle_has_its_share_of_children(
            raw in prop::collection::vec(0.0..1.0_f64, 2..50),
            u in 0.0..1.0_f64,
        ) {
            let sum: f64 = raw.iter().sum::<f64>() + 1e-12;
            let weights: Vec<f64> = raw.iter().map(|w| (w + 1e-12 / raw.len() as f64) / sum).collect();
            let parents = resampled(&weights, u);
            prop_assert_eq!(parents.len(), weights.len());
            prop_assert!(parents.is_sorted());
            for (index, weight) in weights.iter().enumerate() {
                let children = parents.iter().filter(|parent| **parent == index).count() as f64;
                let expected = weight * weights.len() as f64;
                prop_assert!((children - expected).abs() < 1.0 + 1e-6, "{children} of {expected}");
            }
        }
    }

    #[test]
    fn equal_costs_and_none_are_answered() {
        assert_eq!(tempered(&[2.0, 2.0], 0.5), (vec![0.5, 0.5], 0.0));
        assert_eq!(tempered(&[f64::INFINITY, 2.0], 0.5), (vec![0.0, 1.0], 0.0));
        assert_eq!(tempered(&[f64::NAN], 0.5).0, [0.0]);
        assert_eq!(resampled(&[0.0, 1.0, 0.0], 0.99), [1, 1, 1]);
        assert_eq!(resampled(&[], 0.5), Vec::<usize>::new());
    }
}
