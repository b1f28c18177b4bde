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
