//! Centres and radii of spheres by the silhouettes of posed frames.
//!
//! A pixel's λ depends on one sphere, the darkest. With q its centre in the limb's rest frame and r its radius the row of the
//! Jacobian is
//!
//! ```text
//! h = [Rᵀ k, r ∂λ/∂r],   k = ∂λ/∂(centre),   unknown: q and log r
//! ```
//!
//! where R turns the limb's frame into the camera's. No pixel has two spheres, so Σ h hᵀ is a 4 × 4 block a sphere, and a step of
//! Gauss and Newton, damped after Levenberg and Marquardt, is as many small solves. What silhouettes do not show is held by a
//! prior about where the tree put each sphere.

use std::sync::Arc;

use glam::DVec3;
use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;

use super::options::SphereBodyOptions;
use super::{PosedViews, trees};
use crate::body::{Kinematics, Model};
use crate::fit::{FitView, Stage};
use crate::optimize::{DescentOptions, StructuredLeastSquares, descend};
use crate::render::{BACKGROUND, Primitive, Ramp, RendererKind, RowWinners, View};
use crate::residual::RowSums;
use crate::silhouette::Measurement;

/// Distances that the silhouettes' ramp rises over, pixels, inside and outside.
const RAMP_PX: [f64; 2] = [1.5, 3.0];

/// A radius stays within this many times what the tree gave, either way.
const LARGEST_CHANGE: f64 = 3.0;

/// What all pixels that a sphere wins say of it.
pub(super) type SphereBlock = RowSums<4>;

/// One camera in one frame.
struct Term<'a> {
    view: &'a FitView,
    frame: usize,
    data: Arc<Measurement>,
}

/// Silhouettes and poses that spheres are moved by.
pub(super) struct Silhouettes<'a> {
    terms: Vec<Term<'a>>,
    frames: &'a [PosedViews],
    stride: usize,
    /// Index of each limb's first sphere among all.
    firsts: Vec<usize>,
    count: usize,
}

const RAMP: Ramp = Ramp::Distance { inner_px: RAMP_PX[0], outer_px: RAMP_PX[1] };

impl<'a> Silhouettes<'a> {
    pub(super) fn new(model: &Model, frames: &'a [PosedViews], stride: usize) -> Self {
        let stage = Stage { ramp: RAMP, ..Stage::robust(RAMP_PX[1], stride, 1) };
        let of_frame = |(frame, posed): (usize, &'a PosedViews)| {
            let term = move |view: &'a FitView| {
                let distance = view.distance(&[stage]);
                Term { view, frame, data: view.data(&stage, distance.as_ref()) }
            };
            posed.views.par_iter().map(term).collect::<Vec<_>>()
        };
        let terms = frames.iter().enumerate().flat_map(of_frame).collect();
        let mut count = 0;
        let first = |limb: &crate::body::Limb| {
            count += limb.spheres.len();
            count - limb.spheres.len()
        };
        let firsts = model.limbs().iter().map(first).collect();
        Self { terms, frames, stride, firsts, count }
    }

    /// Σ w (D − Λ)² over all frames and cameras, and the block of every sphere, limb by limb.
    pub(super) fn blocks(&self, model: &Model) -> (f64, Vec<SphereBlock>) {
        let kinematics: Vec<Kinematics> =
            self.frames.iter().map(|frame| Kinematics::new(model, &frame.pose)).collect();
        let sums: Vec<_> =
            self.terms.par_iter().map(|term| self.of_term(term, model, &kinematics[term.frame])).collect();
        let (mut cost, mut blocks) = (0.0, vec![SphereBlock::default(); self.count]);
        // In the order of frames and cameras: the same bits however the work was shared out.
        for (of_term, found) in sums {
            cost += of_term;
            for (block, found) in blocks.iter_mut().zip(found) {
                block.products += found.products;
                block.forces += found.forces;
            }
        }
        (cost, blocks)
    }

    fn of_term(&self, term: &Term<'_>, model: &Model, kinematics: &Kinematics) -> (f64, Vec<SphereBlock>) {
        let camera = &term.view.camera;
        let view = View::new(model, kinematics, camera, RendererKind::SphereTree { spheres: None }, RAMP);
        let turn = camera.camera_from_world().rotation;
        let (offset, width) = (self.stride / 2, term.data.width());
        let mut blocks = vec![SphereBlock::default(); self.count];
        let (mut cost, mut row) = (0.0, RowWinners::default());
        for y in (offset..term.data.height()).step_by(self.stride) {
            row.find(&view, y, self.stride, offset);
            for x in (offset..width).step_by(self.stride) {
                let weight = term.view.weight * f64::from(term.data.weights()[y * width + x]);
                let level = if row.touched().contains(&x) { row.level(x).clamp(0.0, 1.0) } else { 1.0 };
                let residual = f64::from(term.data.values()[y * width + x]) - BACKGROUND * level;
                cost += weight * residual * residual;
                let Some(winner) = row.winner(x).filter(|_| weight > 0.0) else { continue };
                let primitive = &view.primitives[winner];
                let limb = &model.limbs()[primitive.limb];
                let limb_from_camera = (turn * kinematics.world_rotations()[limb.rotation]).transpose();
                if let Some((k, by_radius)) = pull(&view, primitive, [x, y]) {
                    let k = limb_from_camera * k;
                    let h = Vector4::new(k.x, k.y, k.z, by_radius);
                    blocks[self.firsts[primitive.limb] + primitive.piece].add(&h, weight, residual);
                }
            }
        }
        (cost, blocks)
    }
}

/// ∂λ/∂(centre), camera axes, and r ∂λ/∂r; `None` where λ is clipped.
fn pull(view: &View, primitive: &Primitive, [x, y]: [usize; 2]) -> Option<(DVec3, f64)> {
    let candidate = primitive.candidate(view.ray(x, y))?;
    let ramp = primitive.ramp.sample(candidate.squared);
    let rate = primitive.radius_rate(RAMP, view.pinhole.mean_focal_px(), candidate.squared);
    (ramp.by_squared > 0.0).then(|| (candidate.by_p0 * ramp.by_squared, primitive.radius * rate))
}

/// The same body with its finest spheres moved, and the root mean squared residual a pixel before and after, grey levels.
///
/// `begin` is the body whose spheres the prior holds to; it has as many spheres.
pub(super) fn refine(
    model: &Model,
    begin: &Model,
    frames: &[PosedViews],
    options: &SphereBodyOptions,
) -> (Model, [f64; 2]) {
    let silhouettes = Silhouettes::new(model, frames, options.stride);
    let pixels: f64 = silhouettes.terms.iter().map(|term| term.weight(options.stride)).sum();
    let rms = |cost: f64| (cost / pixels.max(1.0)).sqrt();
    let unit = BACKGROUND * BACKGROUND * frames.len() as f64 / (options.stride * options.stride) as f64;
    let inverse = |deviation: f64| unit / (deviation * deviation);
    let weights = [inverse(options.centre_deviation), inverse(options.radius_deviation)];
    let none = (0.0, Vec::new());
    let mut problem =
        SphereProblem { silhouettes, begin, weights, before: None, evaluated: none.clone(), at_point: none };
    let descent = DescentOptions {
        damping: 1e-2,
        lower: |damping| 0.3 * damping,
        raise: |damping| 5.0 * damping,
        most_damping: f64::INFINITY,
        max_trials: options.steps,
        max_steps: usize::MAX,
        tolerance: 0.0,
    };
    let found = descend(&mut problem, model.clone(), &descent);
    (found, [problem.before.unwrap_or(0.0), problem.at_point.0].map(rms))
}

/// Silhouettes and prior as a cost of spheres.
struct SphereProblem<'a> {
    silhouettes: Silhouettes<'a>,
    /// What the prior holds to.
    begin: &'a Model,
    /// Of the prior, on a centre and on the logarithm of a radius.
    weights: [f64; 2],
    /// Cost of the silhouettes at the start.
    before: Option<f64>,
    /// Cost of the silhouettes and the spheres' blocks, where they were evaluated last.
    evaluated: (f64, Vec<SphereBlock>),
    /// The same where the problem was linearised last.
    at_point: (f64, Vec<SphereBlock>),
}

impl StructuredLeastSquares for SphereProblem<'_> {
    type Point = Model;

    fn cost(&mut self, model: &Model) -> f64 {
        self.evaluated = self.silhouettes.blocks(model);
        self.before.get_or_insert(self.evaluated.0);
        let [centre, radius] = self.weights;
        let prior = each_sphere(model, self.begin)
            .map(|(away, growth)| centre * away.length_squared() + radius * growth * growth);
        self.evaluated.0 + prior.sum::<f64>()
    }

    fn linearise(&mut self, _model: &Model) {
        self.at_point = std::mem::take(&mut self.evaluated);
    }

    fn trial(&mut self, model: &Model, damping: f64) -> Option<Model> {
        let [centre, radius] = self.weights;
        let held = Vector4::new(centre, centre, centre, radius);
        let step = |((away, growth), block): ((DVec3, f64), &SphereBlock)| {
            let pull = Vector4::new(away.x, away.y, away.z, growth).component_mul(&held);
            let mut matrix = block.products + Matrix4::from_diagonal(&held);
            for i in 0..4 {
                matrix[(i, i)] *= 1.0 + damping;
            }
            matrix.cholesky().map_or(Vector4::zeros(), |factor| factor.solve(&(block.forces - pull)))
        };
        let steps: Vec<Vector4<f64>> =
            each_sphere(model, self.begin).zip(&self.at_point.1).map(step).collect();
        Some(moved(model, self.begin, &steps))
    }
}

impl Term<'_> {
    fn weight(&self, stride: usize) -> f64 {
        let all: f64 = self.data.weights().iter().map(|&weight| f64::from(weight)).sum();
        self.view.weight * all / (stride * stride) as f64
    }
}

/// Of every sphere how far it has moved from where it began, and the logarithm of how much larger it is.
fn each_sphere<'a>(model: &'a Model, begin: &'a Model) -> impl Iterator<Item = (DVec3, f64)> + 'a {
    model.limbs().iter().zip(begin.limbs()).flat_map(|(now, then)| {
        let spheres = now.spheres.iter().zip(&then.spheres);
        spheres.map(move |(a, b)| (now.centre(a) - then.centre(b), (a.radius / b.radius).ln()))
    })
}

fn moved(model: &Model, begin: &Model, steps: &[Vector4<f64>]) -> Model {
    let mut steps = steps.iter();
    model.with_spheres(|index, sphere_index, sphere| {
        let Some(step) = steps.next() else { return *sphere };
        let limb = &model.limbs()[index];
        let step = step.map(|part| if part.is_finite() { part } else { 0.0 });
        let shift = DVec3::new(step.x, step.y, step.z).clamp_length_max(0.5 * sphere.radius);
        let then = begin.limbs()[index].spheres[sphere_index].radius;
        let radius = (sphere.radius * step.w.clamp(-0.3, 0.3).exp())
            .clamp(then / LARGEST_CHANGE, then * LARGEST_CHANGE);
        trees::on_limb(limb, limb.centre(sphere) + shift, radius, sphere.parent)
    })
}
