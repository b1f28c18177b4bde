//! Poses and sizes as one least-squares problem: columns are θ, then size and girth, then the silhouettes' widening where it is
//! unknown, then the cameras where they are, then the poses frame by frame.
//!
//! The [solver](crate::optimize::StepMemory) takes columns from the last to the first and passes over zeros: poses, which have no
//! product with one another, fill nothing but what all frames share.

use std::borrow::Cow;
use std::ops::Range;

use nalgebra::DVector;
use rayon::prelude::*;

use super::cameras::{CameraSet, CameraState};
use super::frames::BodyFrame;
use super::options::{BodyFitOptions, BodyStage};
use super::widening;
use crate::body::sizes::bounded;
use crate::body::{Kinematics, Model, Parameters, Pose, Sizes};
use crate::camera::Camera;
use crate::fit::FitView;
use crate::optimize::{LeastSquares, NormalEquations};
use crate::render::{BACKGROUND, RendererKind, RowWinners, View};
use crate::residual::body_size::{SizeBlock, SizeData, SizeMap};
use crate::residual::proportion_prior::{self, BodySizes, SizePrior};
use crate::residual::{Loss, pose_prior};
use crate::silhouette::SignedDistance;

/// A widening stays within this many of its prior's deviations.
const LARGEST_WIDENING: f64 = 4.0;

/// Poses of all frames, sizes and cameras.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BodyState {
    /// One pose a frame.
    pub(super) poses: Vec<Pose>,
    /// The body's sizes.
    pub(super) body: BodySizes,
    /// The cameras; none where they are held.
    pub(super) cameras: Vec<CameraState>,
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
    cameras: Option<&'a CameraSet>,
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
    /// Which of the cameras that may change it is.
    camera: Option<usize>,
    data: SizeData,
    /// Metres that a pixel covers at every limb, in the poses that the stage began with.
    metres_per_px: Vec<f64>,
}

/// What a camera sees in a frame: the camera as it is now, and the body when its clock says.
struct TermView<'a> {
    camera: Cow<'a, Camera>,
    kinematics: Cow<'a, Kinematics>,
}

impl<'a> BodyProblem<'a> {
    /// Prepares a stage. `distances` are the distance fields of every frame's views, in their order.
    pub(super) fn new(
        sizes: &'a Sizes,
        frames: &'a [BodyFrame],
        distances: &[Vec<Option<SignedDistance>>],
        cameras: Option<&'a CameraSet>,
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
                    let camera = cameras.and_then(|cameras| cameras.index(&view.camera));
                    let data = SizeData::new(data, stage.stage.stride);
                    Term { frame, view, camera, data, metres_per_px }
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
            cameras,
            mean_metres_per_px,
            widening_deviation_px: is_free.then(|| options.widening / mean_metres_per_px),
            silhouette_cost: 0.0,
        }
    }

    fn pose_columns(&self) -> usize {
        Parameters::Tangent.columns(self.sizes.start.rotation_count())
    }

    /// Columns of the sizes, and of the widening.
    pub(super) fn of_sizes(&self) -> Range<usize> {
        0..self.sizes.count() + 2 + usize::from(self.is_widening_free())
    }

    /// Columns of the cameras.
    pub(super) fn of_cameras(&self) -> Range<usize> {
        let first = self.of_sizes().end;
        first..first + self.cameras.map_or(0, CameraSet::columns)
    }

    /// First column of a frame's pose.
    pub(super) fn first_pose(&self, frame: usize) -> usize {
        self.of_cameras().end + frame * self.pose_columns()
    }

    /// Whether the silhouettes' widening is unknown.
    pub(super) fn is_widening_free(&self) -> bool {
        self.widening_deviation_px.is_some()
    }

    /// Squared grey levels of a variance of 1 in the cameras' prior.
    pub(super) fn camera_unit(&self) -> f64 {
        self.prior_unit() * self.options.camera_weight * self.pictures()
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

    fn term_view<'b>(
        &self,
        term: &'b Term<'_>,
        model: &Model,
        kinematics: &'b [Kinematics],
        state: &BodyState,
    ) -> Option<TermView<'b>> {
        let (camera, kinematics) = (&*term.view.camera, &kinematics[term.frame]);
        let Some((cameras, index)) = self.cameras.zip(term.camera) else {
            return Some(TermView { camera: Cow::Borrowed(camera), kinematics: Cow::Borrowed(kinematics) });
        };
        let (of_camera, frame) = (&state.cameras[index], self.frames[term.frame].frame);
        let later = cameras.later(index, of_camera, frame, &state.poses[term.frame]);
        let kinematics =
            later.map_or(Cow::Borrowed(kinematics), |pose| Cow::Owned(Kinematics::new(model, &pose)));
        Some(TermView { camera: Cow::Owned(cameras.camera(index, of_camera).ok()?), kinematics })
    }

    /// Returns the silhouettes' cost; `None` where a camera's numbers make no camera.
    fn add_data(&self, model: &Model, state: &BodyState, equations: &mut NormalEquations) -> Option<f64> {
        let poses = &state.poses;
        let kinematics: Vec<Kinematics> = poses.iter().map(|pose| Kinematics::new(model, pose)).collect();
        let ramp = self.stage.stage.ramp;
        let limbs = model.limbs().len();
        let px = state.body.widening_px;
        let seen = self.terms.iter().map(|term| self.term_view(term, model, &kinematics, state));
        let seen: Vec<TermView<'_>> = seen.collect::<Option<_>>()?;
        let sums: Vec<(f64, Vec<SizeBlock>)> = (self.terms.par_iter().zip(&seen))
            .map(|(term, TermView { camera, kinematics })| {
                let wide = widening::widened(model, &term.metres_per_px, px);
                let view = View::new(&wide, kinematics, camera, RendererKind::Capsule, ramp);
                let mut blocks = vec![SizeBlock::default(); limbs];
                let mut row = RowWinners::default();
                let is_free = term.camera.is_some();
                let cost = term.data.accumulate(&view, camera, ramp, &mut row, &mut blocks, is_free);
                (cost, blocks)
            })
            .collect();
        // Added in the order of frames and cameras: the same bits however the work was shared out.
        let mut silhouette_cost = 0.0;
        let first_camera = self.of_cameras().start;
        let map = |frame: usize| SizeMap {
            sizes: self.sizes,
            model,
            kinematics: &kinematics[frame],
            first_pose: self.first_pose(frame),
            first_size: self.of_sizes().start,
            widening: self.widening_deviation_px.map(|_| self.sizes.count() + 2),
            camera: None,
        };
        for ((term, TermView { camera, kinematics }), (cost, blocks)) in
            self.terms.iter().zip(&seen).zip(&sums)
        {
            silhouette_cost += term.view.weight * cost;
            let growth = widening::growth(model, &term.metres_per_px, px);
            let of_camera = self.cameras.zip(term.camera).map(|(cameras, index)| {
                let frame = self.frames[term.frame].frame;
                cameras.columns_of(first_camera, frame, index, camera, &state.cameras[index])
            });
            let map = SizeMap { kinematics, camera: of_camera, ..map(term.frame) };
            map.add(blocks, term.view.weight, &growth, equations);
        }
        equations.cost += silhouette_cost;
        // A keypoint is as much as all pictures of its frame, at its deviation.
        let weight = self.prior_unit() * self.pictures()
            / (self.frames.len() as f64 * self.options.joint_deviation.powi(2));
        for (frame, body_frame) in self.frames.iter().enumerate() {
            for &joint in &body_frame.joints {
                map(frame).add_joint(joint, weight, poses[frame].root, equations);
            }
        }
        Some(silhouette_cost)
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
            let first = self.first_pose(frame);
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
        let Some(cost) = self.add_data(&model, state, equations) else {
            equations.cost = f64::INFINITY;
            return;
        };
        self.silhouette_cost = cost;
        self.add_pose_priors(&state.poses, equations);
        proportion_prior::add(
            equations,
            &state.body,
            &self.prior,
            self.widening_deviation_px,
            self.stage.slack,
            self.shape_unit(),
            self.of_sizes().start,
        );
        if let Some(cameras) = self.cameras {
            cameras.constrain(equations, &state.cameras, self.of_cameras().start, self.camera_unit());
        }
    }

    fn columns(&self) -> usize {
        self.first_pose(self.frames.len())
    }

    fn retract(&self, state: &BodyState, step: &DVector<f64>) -> BodyState {
        let blocks = step.as_slice()[self.first_pose(0)..].chunks_exact(self.pose_columns());
        let poses = state.poses.iter().zip(blocks);
        let sizes = &step.as_slice()[self.of_sizes()];
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
            cameras: self.cameras.map_or(Vec::new(), |cameras| {
                cameras.retract(&state.cameras, &step.as_slice()[self.of_cameras()])
            }),
        }
    }

    /// Per pixel that has weight, grey levels.
    fn rms(&self) -> f64 {
        let pixels: f64 = self.terms.iter().map(|term| term.data.total_weight * term.view.weight).sum();
        if pixels > 0.0 { (self.silhouette_cost / pixels).sqrt() } else { 0.0 }
    }

    fn cap(&self, step: &mut DVector<f64>) {
        let mut scale: f64 = 1.0;
        for block in step.as_slice()[self.first_pose(0)..].chunks_exact(self.pose_columns()) {
            let length = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-12);
            scale = scale.min(self.options.largest_move / length(&block[..3]));
            for turn in block[3..].chunks_exact(3) {
                scale = scale.min(self.options.largest_turn / length(turn));
            }
        }
        let (sizes, wider) = step.as_slice()[self.of_sizes()].split_at(self.sizes.count() + 2);
        let of_cameras = &step.as_slice()[self.of_cameras()];
        scale = scale.min(self.cameras.map_or(1.0, |cameras| cameras.shortened(of_cameras)));
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
mod tests;
