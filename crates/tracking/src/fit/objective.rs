//! The cost of a pose: silhouettes of all cameras plus priors, as a least-squares problem.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;

use super::evidence::FitView;
use super::options::{FitOptions, Stage};
use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::optimize::{LeastSquares, NormalEquations};
use crate::render::wrench::WrenchBlock;
use crate::render::{BACKGROUND, View};
use crate::residual::cue::CueSet;
use crate::residual::interpenetration::{self, LimbPairs};
use crate::residual::learnt_prior::{BoundPrior, PartEnergy};
use crate::residual::motion_prior::{self, MotionPrior};
use crate::residual::silhouette::{KernelMemory, SampledData, StateMap, WorldBlocks};
use crate::residual::{Loss, Residual, ResidualPoint, pose_prior};
use crate::silhouette::SignedDistance;

/// Sharing cameras among threads pays above some 200 µs of work: about this many pixels in the solids' boxes.
const PARALLEL_PIXELS: usize = 150_000;

/// One stage's cost of a pose. Keeps its memory from evaluation to evaluation.
#[derive(Debug)]
pub struct Objective {
    model: Arc<Model>,
    options: FitOptions,
    stage: Stage,
    cameras: Vec<CameraTerm>,
    reference: Pose,
    pub(super) constraints: Constraints,
    kinematics: Kinematics,
    world: WorldBlocks,
    /// What cues pull, apart from the pixels.
    cue_blocks: WorldBlocks,
    map: StateMap,
    /// Limbs that must not overlap; none where that is not asked for.
    pairs: Option<LimbPairs>,
    /// What motion files say, if they are asked.
    prior: Option<BoundPrior>,
    silhouette_cost: f64,
}

/// What a fit holds and what pulls at it besides its options.
#[derive(Debug, Clone, Default)]
pub(super) struct Constraints {
    /// Rotations that may move; all when `None`. The root's position moves only when all rotations do.
    pub(super) free: Option<Vec<bool>>,
    /// What the motion so far says of the pose. It takes the place of the proximal prior.
    pub(super) motion: Option<Arc<MotionPrior>>,
    /// What the pictures say beside their silhouettes.
    pub(super) cues: Option<Arc<CueSet>>,
    /// Residuals of the caller's own.
    pub(super) residuals: Vec<Arc<dyn Residual>>,
}

#[derive(Debug)]
struct CameraTerm {
    fit_view: FitView,
    data: SampledData,
    view: View,
    memory: KernelMemory,
    blocks: Vec<WrenchBlock>,
    cost: f64,
}

impl CameraTerm {
    /// Sampled pixels in the boxes of all solids at the last evaluated pose: how much work it is, roughly.
    fn area_px(&self, stride: usize) -> usize {
        self.view.primitives.iter().map(|primitive| primitive.bounds.pixels()).sum::<usize>()
            / (stride * stride)
    }
}

impl Objective {
    /// Prepares a stage. `distances` are the views' distance fields, in their order; `reference` is what the
    /// proximal prior pulls towards.
    pub fn new(
        model: Arc<Model>,
        views: &[FitView],
        distances: &[Option<SignedDistance>],
        options: &FitOptions,
        stage: Stage,
        reference: Pose,
    ) -> Self {
        let kinematics = Kinematics::new(&model, &reference);
        let limbs = model.limbs().len();
        let prior = options.prior.as_ref().and_then(|prior| BoundPrior::new(prior, &model, &reference));
        let cameras = views
            .iter()
            .zip(distances)
            .map(|(view, distance)| CameraTerm {
                data: view.sampled_data(&stage, distance.as_ref()),
                view: View::new(&model, &kinematics, &view.camera, options.renderer, stage.ramp),
                memory: KernelMemory::default(),
                blocks: vec![WrenchBlock::default(); limbs],
                fit_view: view.clone(),
                cost: 0.0,
            })
            .collect();
        Self {
            options: options.clone(),
            stage,
            cameras,
            reference,
            constraints: Constraints::default(),
            world: WorldBlocks::new(limbs),
            cue_blocks: WorldBlocks::new(limbs),
            map: StateMap::default(),
            pairs: (options.interpenetration_weight > 0.0).then(|| LimbPairs::of(&model)),
            prior,
            kinematics,
            model,
            silhouette_cost: 0.0,
        }
    }

    /// Doubts pixels whose residual at a pose is too large to be believed.
    pub(super) fn doubt_pixels(&mut self, pose: &Pose, loss: Loss) {
        self.kinematics.update(&self.model, pose);
        for term in &mut self.cameras {
            let camera = &term.fit_view.camera;
            term.view.prepare(&self.model, &self.kinematics, camera, self.options.renderer, self.stage.ramp);
            term.data = term.data.doubted(&term.view, loss);
        }
    }

    /// JᵀJ, Jᵀρ and cost of what a frame says by itself: silhouettes, cues, rest and limits, without any pull to another
    /// pose. In tangent columns and as if every pixel were sampled.
    pub fn frame_equations(&mut self, pose: &Pose) -> NormalEquations {
        let mut equations = self.measured(pose);
        self.add_rest(pose, Parameters::Tangent, &mut equations);
        self.add_limits(pose, Parameters::Tangent, &mut equations);
        self.as_if_all_were_sampled(equations)
    }

    /// Silhouettes and cues of the pixels that are sampled, in tangent columns.
    fn measured(&mut self, pose: &Pose) -> NormalEquations {
        let mut equations = NormalEquations::zeros(Parameters::Tangent.columns(self.model.rotation_count()));
        self.render_cameras(pose);
        self.world.add_to(&self.kinematics, Parameters::Tangent, &mut self.map, &mut equations);
        equations.cost = self.silhouette_cost;
        self.add_cues(Parameters::Tangent, &mut equations);
        equations
    }

    fn as_if_all_were_sampled(&self, mut equations: NormalEquations) -> NormalEquations {
        let pixels = (self.stage.stride * self.stage.stride) as f64;
        equations.jtj *= pixels;
        equations.jtr *= pixels;
        equations.cost *= pixels;
        equations
    }

    /// JᵀJ, Jᵀρ and cost of what is measured: silhouettes and cues, no prior of any kind. In tangent columns and as if every pixel
    /// were sampled.
    pub fn measured_equations(&mut self, pose: &Pose) -> NormalEquations {
        let equations = self.measured(pose);
        self.as_if_all_were_sampled(equations)
    }

    /// What a frame says by itself ([`frame_equations`](Self::frame_equations)), and what motion files say of the pose, by part of
    /// the body.
    pub(crate) fn free_equations(&mut self, pose: &Pose) -> (NormalEquations, Vec<PartEnergy>) {
        let equations = self.frame_equations(pose);
        let energies = |prior: &BoundPrior| prior.energies(&self.model, &self.kinematics);
        (equations, self.prior.as_ref().map_or_else(Vec::new, energies))
    }

    /// What the silhouettes of each camera say by themselves at the pose that was looked at last, in tangent columns and as if every
    /// pixel were sampled.
    pub(crate) fn camera_equations(&mut self) -> Vec<NormalEquations> {
        let columns = Parameters::Tangent.columns(self.model.rotation_count());
        let pixels = (self.stage.stride * self.stage.stride) as f64;
        let of_camera = |term: &CameraTerm| {
            self.world.clear();
            self.world.add(&term.fit_view.camera, &term.blocks, term.fit_view.weight * pixels);
            let mut equations = NormalEquations::zeros(columns);
            self.world.add_to(&self.kinematics, Parameters::Tangent, &mut self.map, &mut equations);
            equations
        };
        self.cameras.iter().map(of_camera).collect()
    }

    /// Whether no pixel had a gradient at the last evaluated pose: the cameras do not see the body.
    pub(super) fn is_blind(&self) -> bool {
        self.world.is_empty()
    }

    /// Squared grey levels per rad² of a prior weight of 1.
    fn prior_unit(&self) -> f64 {
        self.stage.priors * BACKGROUND * BACKGROUND / (self.stage.stride * self.stage.stride) as f64
    }

    /// At the pose that was looked at last.
    fn add_cues(&mut self, parameters: Parameters, equations: &mut NormalEquations) {
        let Some(cues) = &self.constraints.cues else { return };
        self.cue_blocks.clear();
        let unit = self.prior_unit();
        equations.cost += cues.add(&self.model, &self.kinematics, unit, &mut self.cue_blocks);
        self.cue_blocks.add_to(&self.kinematics, parameters, &mut self.map, equations);
    }

    /// What pulls to another pose: the motion so far, or else the fit's start.
    fn add_proximal(&self, pose: &Pose, equations: &mut NormalEquations) {
        let options = &self.options;
        if let Some(prior) = &self.constraints.motion {
            let scale = 1.0 / (self.stage.stride * self.stage.stride) as f64;
            motion_prior::add(equations, options.parameters, pose, prior, scale);
        } else if options.proximal_weight > 0.0 {
            let weight = self.prior_unit() * options.proximal_weight;
            let (root, loss) = (options.proximal_root_factor, options.proximal_loss);
            let reference = &self.reference;
            pose_prior::add_proximal(equations, options.parameters, pose, reference, weight, root, loss);
        }
    }

    fn add_rest(&self, pose: &Pose, parameters: Parameters, equations: &mut NormalEquations) {
        let weight = self.prior_unit() * self.options.rest_weight;
        if weight > 0.0 {
            pose_prior::add_rest(equations, parameters, &self.model, pose, weight);
        }
    }

    fn add_limits(&self, pose: &Pose, parameters: Parameters, equations: &mut NormalEquations) {
        let weight = self.prior_unit() * self.options.limit_weight;
        if weight > 0.0 {
            pose_prior::add_limits(equations, parameters, &self.model, pose, weight);
        }
    }

    fn hold_rotations(&self, equations: &mut NormalEquations) {
        let Some(free) = &self.constraints.free else { return };
        let parameters = self.options.parameters;
        let held = (0..free.len()).filter(|&rotation| !free[rotation]).flat_map(|rotation| {
            let first = parameters.first_column(rotation);
            first..first + parameters.per_rotation()
        });
        let root = if free.iter().all(|&is_free| is_free) { 0..0 } else { 0..3 };
        for column in root.chain(held) {
            equations.jtj.row_mut(column).fill(0.0);
            equations.jtj.column_mut(column).fill(0.0);
            equations.jtr[column] = 0.0;
        }
    }

    /// Renders the pose in every camera: costs and world blocks.
    fn render_cameras(&mut self, pose: &Pose) {
        let (model, options, ramp) = (&self.model, &self.options, self.stage.ramp);
        self.kinematics.update(model, pose);
        let kinematics = &self.kinematics;
        let one = |term: &mut CameraTerm| {
            term.view.prepare(model, kinematics, &term.fit_view.camera, options.renderer, ramp);
            term.blocks.fill(WrenchBlock::default());
            let sum = if options.exact { SampledData::accumulate_scalar } else { SampledData::accumulate };
            term.cost = sum(&term.data, &term.view, &mut term.memory, &mut term.blocks);
        };
        let stride = self.stage.stride;
        let area: usize = self.cameras.iter().map(|term| term.area_px(stride)).sum();
        let is_large = area >= PARALLEL_PIXELS;
        if is_large && self.cameras.len() > 1 && rayon::current_num_threads() > 1 {
            self.cameras.par_iter_mut().for_each(one);
        } else {
            self.cameras.iter_mut().for_each(one);
        }
        // Merged in the cameras' order: the same bits however the work was shared out.
        self.world.clear();
        self.silhouette_cost = 0.0;
        for term in &self.cameras {
            self.silhouette_cost += term.fit_view.weight * term.cost;
            self.world.add(&term.fit_view.camera, &term.blocks, term.fit_view.weight);
        }
    }
}

impl LeastSquares for Objective {
    type Point = Pose;

    fn evaluate(&mut self, pose: &Pose, equations: &mut NormalEquations) {
        self.render_cameras(pose);
        equations.cost += self.silhouette_cost;
        let (parameters, unit) = (self.options.parameters, self.prior_unit());
        self.world.add_to(&self.kinematics, parameters, &mut self.map, equations);
        self.add_cues(parameters, equations);
        self.add_proximal(pose, equations);
        // What motion says of a pose knows already how bodies rest and which poses are likely.
        let is_free = self.constraints.motion.is_none();
        if is_free {
            self.add_rest(pose, parameters, equations);
        }
        self.add_limits(pose, parameters, equations);
        let (model, kinematics) = (&*self.model, &self.kinematics);
        if let Some(pairs) = &self.pairs {
            let (weight, columns) = (unit * self.options.interpenetration_weight, &mut self.map.columns);
            interpenetration::add(equations, parameters, model, kinematics, pairs, weight, columns);
        }
        if let Some(prior) = self.prior.as_ref().filter(|_| is_free) {
            prior.add(equations, parameters, model, kinematics, unit);
        }
        let at = ResidualPoint { model, pose, kinematics, parameters, unit };
        self.constraints.residuals.iter().for_each(|residual| residual.add(&at, equations));
        self.hold_rotations(equations);
    }

    fn columns(&self) -> usize {
        self.options.parameters.columns(self.model.rotation_count())
    }

    fn retract(&self, pose: &Pose, step: &DVector<f64>) -> Pose {
        pose.retract(self.options.parameters, step.as_slice())
    }

    /// Per pixel that has weight, grey levels.
    fn rms(&self) -> f64 {
        let pixels: f64 = self.cameras.iter().map(|term| term.data.total_weight * term.fit_view.weight).sum();
        if pixels > 0.0 { (self.silhouette_cost / pixels).sqrt() } else { 0.0 }
    }

    fn cap(&self, step: &mut DVector<f64>) {
        let parameters = self.options.parameters;
        // Half the angle is what four coefficients measure.
        let unit = if parameters == Parameters::Raw { 2.0 } else { 1.0 };
        let mut scale: f64 = 1.0;
        if let Some(largest) = self.options.largest_move {
            scale = scale.min(largest / step.rows(0, 3).norm().max(1e-12));
        }
        if let Some(largest) = self.options.largest_turn {
            for rotation in 0..self.model.rotation_count() {
                let block = step.rows(parameters.first_column(rotation), parameters.per_rotation());
                scale = scale.min(largest / (unit * block.norm()).max(1e-12));
            }
        }
        if scale < 1.0 {
            *step *= scale;
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::*;
    use crate::cancel::CancelToken;
    use crate::fit::Fit;
    use crate::fixtures;
    use crate::prior::{BodyDirection, PosePrior, PriorPart, StepStatistics, StudentComponent};
    use crate::residual::learnt_prior::LearntPrior;

    /// People who hold their right arm ahead of them.
    fn ahead() -> LearntPrior {
        let (sine, cosine) = 0.7_f64.sin_cos();
        let lower = |diagonal: f64| -> Vec<f64> {
            (0..6).flat_map(|i| (0..=i).map(move |j| if i == j { diagonal } else { 0.0 })).collect()
        };
        let mean = vec![-0.3, sine, -cosine, -0.3, sine, -cosine];
        let component = StudentComponent { share: 1.0, mean, covariance: lower(0.04) };
        let step = StepStatistics { seconds: 0.1, exponent: 2.0, covariance: lower(0.01) };
        let directions = vec![BodyDirection::RightUpperArm, BodyDirection::RightForearm];
        let part = PriorPart::new("right arm", directions, vec![component], step, 4.0).unwrap();
        LearntPrior::new(Arc::new(PosePrior::new("test", vec![part]).unwrap()))
    }

    /// In a picture that is so many times as fine as one of 120 × 160.
    fn view(model: &Model, truth: &Pose, from: DVec3, finer: u64) -> FitView {
        let scale = finer as f64;
        let pinhole = [160.0 * scale, 160.0 * scale, 60.0 * scale - 0.5, 80.0 * scale - 0.5];
        let size = [120 * finer, 160 * finer];
        fixtures::fit_view(model, truth, fixtures::camera(size, pinhole, from, DVec3::Z * 0.9, DVec3::Z))
    }

    /// Whether an arm is ahead of the trunk or behind it one camera in front cannot tell, and the prior does. A second one from
    /// the side tells, whatever the prior says. Finer pictures change neither.
    #[test]
    fn a_prior_decides_where_silhouettes_do_not_and_yields_where_they_do() {
        let model = Arc::new(crate::body::builtin::full_body());
        let hand = model.limb_index("right forearm").unwrap();
        let out = DQuat::from_rotation_y(-0.35);
        let posed = |raised: f64| {
            let turns = [("right upper arm", out * DQuat::from_rotation_x(raised))];
            fixtures::posed(&model, DVec3::Z * 0.92, &turns)
        };
        let (front, side) = (DVec3::new(0.0, 2.6, 1.0), DVec3::new(2.6, 0.3, 1.0));
        let place = |pose: &Pose| Kinematics::new(&model, pose).ends()[hand];
        let fitted = |truth: f64, start: f64, cameras: &[DVec3], prior: Option<LearntPrior>, finer| {
            let views = cameras.iter().map(|&at| view(&model, &posed(truth), at, finer)).collect();
            let options = FitOptions { prior, ..FitOptions::default() };
            let mut fit = Fit::new(model.clone(), views, posed(start), options).unwrap();
            place(&fit.run(&CancelToken::new(), |_| {}).pose)
        };
        let behind = place(&posed(-0.5));
        for finer in [1, 6] {
            let alone = fitted(0.5, -0.3, &[front], None, finer);
            let with = fitted(0.5, -0.3, &[front], Some(ahead()), finer);
            assert!(alone.y < 0.0 && with.y > 0.15, "{finer}: {alone} {with}");
            let alone = fitted(-0.5, -0.3, &[front, side], None, finer);
            let with = fitted(-0.5, -0.3, &[front, side], Some(ahead()), finer);
            let [alone, with] = [alone, with].map(|hand| hand.distance(behind));
            assert!(alone < 0.01 && with < 0.03, "{finer}: {alone} {with}");
        }
    }
}
