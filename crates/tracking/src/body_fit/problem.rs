//! Poses and sizes as one least-squares problem: columns are the poses frame by frame, then θ, then size and girth, then the
//! silhouettes' widening where it is unknown.

use nalgebra::DVector;
use rayon::prelude::*;

use super::frames::BodyFrame;
use super::options::{BodyFitOptions, BodyStage};
use super::widening;
use crate::body::sizes::bounded;
use crate::body::{Kinematics, Model, Parameters, Pose, Sizes};
use crate::fit::FitView;
use crate::optimize::{LeastSquares, NormalEquations};
use crate::render::{BACKGROUND, RendererKind, RowWinners, View};
use crate::residual::body_size::{SizeBlock, SizeData, SizeMap};
use crate::residual::proportion_prior::{self, BodySizes, SizePrior};
use crate::residual::{Loss, pose_prior};
use crate::silhouette::SignedDistance;

/// A widening stays within this many of its prior's deviations.
const LARGEST_WIDENING: f64 = 4.0;

/// Poses of all frames, and the sizes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BodyState {
    /// One pose a frame.
    pub(super) poses: Vec<Pose>,
    /// The body's sizes.
    pub(super) body: BodySizes,
}

/// One stage's cost of poses and sizes.
#[derive(Debug)]
pub(super) struct BodyProblem<'a> {
    sizes: &'a Sizes,
    options: &'a BodyFitOptions,
    frames: &'a [BodyFrame],
    stage: BodyStage,
    /// What the proximal priors pull towards.
    references: Vec<Pose>,
    terms: Vec<Term<'a>>,
    prior: SizePrior,
    /// Metres that a pixel covers where the body is, mean of all cameras, frames and limbs.
    pub(super) mean_metres_per_px: f64,
    /// Standard deviation of the silhouettes' widening, pixels; `None` where it is held.
    widening_deviation_px: Option<f64>,
    silhouette_cost: f64,
}

/// One camera in one frame.
#[derive(Debug)]
struct Term<'a> {
    frame: usize,
    view: &'a FitView,
    data: SizeData,
    /// Metres that a pixel covers at every limb, in the poses that the stage began with.
    metres_per_px: Vec<f64>,
}

impl<'a> BodyProblem<'a> {
    /// Prepares a stage. `distances` are the distance fields of every frame's views, in their order.
    pub(super) fn new(
        sizes: &'a Sizes,
        frames: &'a [BodyFrame],
        distances: &[Vec<Option<SignedDistance>>],
        options: &'a BodyFitOptions,
        stage: BodyStage,
        begin: &BodyState,
    ) -> Self {
        let body = sizes.model(&begin.body.log_ratios, begin.body.size);
        let body = body.as_ref().unwrap_or(&sizes.start);
        let of_frame = |(frame, (body_frame, distances)): (usize, (&'a BodyFrame, &Vec<_>))| {
            let kinematics = Kinematics::new(body, &begin.poses[frame]);
            let terms =
                body_frame.views.iter().zip(distances).map(move |(view, distance): (_, &Option<_>)| {
                    let data = view.data(&stage.stage, distance.as_ref());
                    let metres_per_px = widening::metres_per_px(&kinematics, &view.camera);
                    Term { frame, view, data: SizeData::new(data, stage.stage.stride), metres_per_px }
                });
            terms.collect::<Vec<_>>()
        };
        let terms: Vec<Term<'a>> = frames.iter().zip(distances).enumerate().flat_map(of_frame).collect();
        let pixels = terms.iter().flat_map(|term| &term.metres_per_px);
        let mean_metres_per_px = pixels.sum::<f64>() / (terms.len() * body.limbs().len()).max(1) as f64;
        let prior = options.proportions.prior(sizes);
        // Only people's girths tell a widening from a girth.
        let knows_girths = options.choice.radii && prior.is_surveyed;
        let is_free = knows_girths && options.widening > 0.0 && mean_metres_per_px > 0.0;
        Self {
            sizes,
            options,
            frames,
            stage,
            references: begin.poses.clone(),
            terms,
            prior,
            mean_metres_per_px,
            widening_deviation_px: is_free.then(|| options.widening / mean_metres_per_px),
            silhouette_cost: 0.0,
        }
    }

    fn pose_columns(&self) -> usize {
        Parameters::Tangent.columns(self.sizes.start.rotation_count())
    }

    /// First column of the sizes.
    pub(super) fn first_size(&self) -> usize {
        self.references.len() * self.pose_columns()
    }

    /// Squared grey levels of a prior weight of 1 at this stage's stride.
    pub(super) fn prior_unit(&self) -> f64 {
        BACKGROUND * BACKGROUND / (self.stage.stage.stride * self.stage.stage.stride) as f64
    }

    /// Squared grey levels of a variance of 1 in the prior of proportions.
    pub(super) fn shape_unit(&self) -> f64 {
        self.prior_unit() * self.options.shape_weight * self.pictures()
    }

    fn pictures(&self) -> f64 {
        self.terms.iter().map(|term| term.view.weight).sum()
    }

    fn add_data(&mut self, model: &Model, state: &BodyState, equations: &mut NormalEquations) {
        let poses = &state.poses;
        let kinematics: Vec<Kinematics> = poses.iter().map(|pose| Kinematics::new(model, pose)).collect();
        let ramp = self.stage.stage.ramp;
        let limbs = model.limbs().len();
        let px = state.body.widening_px;
        let sums: Vec<(f64, Vec<SizeBlock>)> = self
            .terms
            .par_iter()
            .map(|term| {
                let camera = &term.view.camera;
                let wide = widening::widened(model, &term.metres_per_px, px);
                let view = View::new(&wide, &kinematics[term.frame], camera, RendererKind::Capsule, ramp);
                let mut blocks = vec![SizeBlock::default(); limbs];
                let mut row = RowWinners::default();
                let cost = term.data.accumulate(&view, camera, ramp, &mut row, &mut blocks);
                (cost, blocks)
            })
            .collect();
        // Added in the order of frames and cameras: the same bits however the work was shared out.
        self.silhouette_cost = 0.0;
        let (columns, first) = (self.pose_columns(), self.first_size());
        let map = |frame: usize| SizeMap {
            sizes: self.sizes,
            model,
            kinematics: &kinematics[frame],
            first_pose: frame * columns,
            first_size: first,
            widening: self.widening_deviation_px.map(|_| first + self.sizes.count() + 2),
        };
        for (term, (cost, blocks)) in self.terms.iter().zip(&sums) {
            self.silhouette_cost += term.view.weight * cost;
            let growth = widening::growth(model, &term.metres_per_px, px);
            map(term.frame).add(blocks, term.view.weight, &growth, equations);
        }
        equations.cost += self.silhouette_cost;
        // A keypoint is as much as all pictures of its frame, at its deviation.
        let weight = self.prior_unit() * self.pictures()
            / (self.frames.len() as f64 * self.options.joint_deviation.powi(2));
        for (frame, body_frame) in self.frames.iter().enumerate() {
            for &joint in &body_frame.joints {
                map(frame).add_joint(joint, weight, poses[frame].root, equations);
            }
        }
    }

    fn add_pose_priors(&self, poses: &[Pose], equations: &mut NormalEquations) {
        let (options, unit, model) = (self.options, self.prior_unit(), &self.sizes.start);
        let columns = self.pose_columns();
        let mut priors = NormalEquations::zeros(columns);
        for (frame, (pose, reference)) in poses.iter().zip(&self.references).enumerate() {
            priors.clear();
            let weight = unit * options.proximal_weight;
            let root = weight * options.proximal_root_factor / weight.max(f64::MIN_POSITIVE);
            let loss = Loss::Squares;
            pose_prior::add_proximal(&mut priors, Parameters::Tangent, pose, reference, weight, root, loss);
            pose_prior::add_rest(&mut priors, Parameters::Tangent, model, pose, unit * options.rest_weight);
            let limits = unit * options.limit_weight;
            pose_prior::add_limits(&mut priors, Parameters::Tangent, model, pose, limits);
            let first = frame * columns;
            let mut block = equations.jtj.view_mut((first, first), (columns, columns));
            block += &priors.jtj;
            let mut rows = equations.jtr.rows_mut(first, columns);
            rows += &priors.jtr;
            equations.cost += priors.cost;
        }
    }
}

impl LeastSquares for BodyProblem<'_> {
    type Point = BodyState;

    fn evaluate(&mut self, state: &BodyState, equations: &mut NormalEquations) {
        let Ok(model) = self.sizes.model(&state.body.log_ratios, state.body.size) else {
            // Sizes out of range: such a step is taken back.
            equations.cost = f64::INFINITY;
            return;
        };
        self.add_data(&model, state, equations);
        self.add_pose_priors(&state.poses, equations);
        proportion_prior::add(
            equations,
            &state.body,
            &self.prior,
            self.widening_deviation_px,
            self.stage.slack,
            self.shape_unit(),
            self.first_size(),
        );
    }

    fn columns(&self) -> usize {
        self.first_size() + self.sizes.count() + 2 + usize::from(self.widening_deviation_px.is_some())
    }

    fn retract(&self, state: &BodyState, step: &DVector<f64>) -> BodyState {
        let columns = self.pose_columns();
        let blocks = step.as_slice().chunks_exact(columns);
        let poses = state.poses.iter().zip(blocks);
        let sizes = &step.as_slice()[self.first_size()..];
        let body = &state.body;
        let grown = body.log_ratios.iter().zip(sizes);
        BodyState {
            poses: poses.map(|(pose, block)| pose.retract(Parameters::Tangent, block)).collect(),
            body: BodySizes {
                log_ratios: grown.map(|(theta, grown)| bounded(theta + grown)).collect(),
                size: bounded(body.size + sizes[self.sizes.count()]),
                girth: bounded(body.girth + sizes[self.sizes.count() + 1]),
                widening_px: match (self.widening_deviation_px, sizes.get(self.sizes.count() + 2)) {
                    (Some(deviation), Some(step)) => (body.widening_px + step)
                        .clamp(-LARGEST_WIDENING * deviation, LARGEST_WIDENING * deviation),
                    _ => 0.0,
                },
            },
        }
    }

    /// Per pixel that has weight, grey levels.
    fn rms(&self) -> f64 {
        let pixels: f64 = self.terms.iter().map(|term| term.data.total_weight * term.view.weight).sum();
        if pixels > 0.0 { (self.silhouette_cost / pixels).sqrt() } else { 0.0 }
    }

    fn cap(&self, step: &mut DVector<f64>) {
        let columns = self.pose_columns();
        let mut scale: f64 = 1.0;
        for block in step.as_slice()[..self.first_size()].chunks_exact(columns) {
            let length = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-12);
            scale = scale.min(self.options.largest_move / length(&block[..3]));
            for turn in block[3..].chunks_exact(3) {
                scale = scale.min(self.options.largest_turn / length(turn));
            }
        }
        let (sizes, wider) = step.as_slice()[self.first_size()..].split_at(self.sizes.count() + 2);
        for grown in sizes {
            scale = scale.min(self.options.largest_growth / grown.abs().max(1e-12));
        }
        for (px, deviation) in wider.iter().zip(self.widening_deviation_px) {
            scale = scale.min(0.5 * deviation / px.abs().max(1e-12));
        }
        if scale < 1.0 {
            *step *= scale;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::body::{SizeChoice, builtin};
    use crate::fit::Evidence;
    use crate::fixtures;
    use crate::optimize::gradient_check::{DifferenceOptions, check_gradient};
    use crate::silhouette::Measurement;

    #[test]
    fn the_gradient_is_that_of_the_cost() {
        for (lengths, radii) in [(true, true), (true, false), (false, true), (false, false)] {
            check_choice(SizeChoice { lengths, radii, symmetric: radii }, 0.0);
        }
        check_choice(SizeChoice::default(), 0.02);
    }

    /// Two frames with two cameras, grey data, joints and all priors: the gradient of the whole by every column.
    fn check_choice(choice: SizeChoice, widening: f64) {
        let body = if widening > 0.0 { builtin::full_body() } else { builtin::upper_body() };
        let start = Arc::new(body);
        let sizes = Sizes::new(start.clone(), choice);
        let camera = |centre: DVec3| {
            let at = DVec3::new(0.0, 0.3, 0.0);
            Arc::new(fixtures::camera([40, 32], [40.0, 41.0, 19.5, 15.5], centre, at, DVec3::Y))
        };
        let view = |centre: DVec3, weight: f64| {
            let values = (0..40 * 32).map(|i| 127.0 + 120.0 * (i as f32 * 0.31).sin()).collect();
            let data = Measurement::new(40, 32, values, vec![1.0; 40 * 32]).unwrap();
            FitView { camera: camera(centre), evidence: Evidence::Measurement(Arc::new(data)), weight }
        };
        let columns = Parameters::Tangent.columns(start.rotation_count());
        let bent = |seed: f64| fixtures::bent(&start, 0.2, seed);
        let frames: Vec<BodyFrame> = [0.0, 2.0]
            .map(|seed| BodyFrame {
                frame: seed as usize,
                views: vec![view(DVec3::new(0.1, 0.3, 2.0), 1.0), view(DVec3::new(1.8, 0.5, 0.4), 0.5)],
                start: bent(seed),
                joints: vec![(None, DVec3::new(0.1, -0.05, 0.0)), (Some(5), DVec3::new(-0.4, 0.3, 0.2))],
            })
            .to_vec();
        let options = BodyFitOptions { widening, ..BodyFitOptions::default() };
        let distances = vec![vec![None, None]; 2];
        let mut stage = options.stages[1];
        stage.stage.stride = 1;
        let begin = BodyState { poses: vec![bent(0.3), bent(2.2)], body: BodySizes::scaled(&sizes, 0.0) };
        let mut problem = BodyProblem::new(&sizes, &frames, &distances, &options, stage, &begin);
        let ratios = (0..sizes.count()).map(|i| 0.1 * (i as f64 * 2.3).sin()).collect();
        let state = BodyState {
            poses: vec![bent(0.0), bent(2.0)],
            body: BodySizes {
                log_ratios: ratios,
                size: 0.07,
                girth: -0.04,
                widening_px: if widening > 0.0 { 0.8 } else { 0.0 },
            },
        };
        assert_eq!(problem.widening_deviation_px.is_some(), widening > 0.0);
        let first_size = problem.first_size();
        let moved = |column: usize, offset: f64| {
            let mut moved = state.clone();
            if column < first_size {
                let (frame, column) = (column / columns, column % columns);
                moved.poses[frame] = moved.poses[frame].nudged(Parameters::Tangent, column, offset);
            } else {
                match column - first_size {
                    size if size < sizes.count() => moved.body.log_ratios[size] += offset,
                    size if size == sizes.count() => moved.body.size += offset,
                    size if size == sizes.count() + 1 => moved.body.girth += offset,
                    _ => moved.body.widening_px += offset,
                }
            }
            moved
        };
        let name = |column: usize| match column.checked_sub(first_size) {
            None => format!("frame {}, pose column {}", column / columns, column % columns),
            Some(size) => sizes.parameters.get(size).map_or_else(
                || "size, girth or widening".to_owned(),
                |parameter| format!("{} {}", parameter.name, parameter.kind),
            ),
        };
        let options = DifferenceOptions { tolerance: 1e-5, ..DifferenceOptions::default() };
        let check = check_gradient(&mut problem, &state, moved, name, &options);
        assert!(check.passes() && check.skipped_share() < 0.3, "{choice:?}, {widening}: {check}");
    }
}
