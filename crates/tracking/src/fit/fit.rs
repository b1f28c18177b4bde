//! One frame's fit, iteration by iteration, stage after stage. Every iteration is kept, rejected ones too.

use std::sync::Arc;

use super::evidence::{FitError, FitView, PreparedFit};
use super::objective::{Constraints, Objective};
use super::options::FitOptions;
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::optimize::{Iteration, NormalEquations, Solver, Termination};
use crate::residual::cue::CueSet;
use crate::residual::motion_prior::MotionPrior;
use crate::residual::{Loss, Residual};
use crate::silhouette::SignedDistance;

/// The last stages, in which pixels may be doubted.
const DOUBTING_STAGES: usize = 2;

/// What a fit did.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverSummary {
    /// Why it ended.
    pub termination: Termination,
    /// Where it ended.
    pub pose: Pose,
    /// Cost at the start of the first stage.
    pub initial_cost: f64,
    /// Cost at the end, by the last stage's measure.
    pub final_cost: f64,
    /// Root of the mean squared residual per pixel at the end.
    pub final_rms: f64,
    /// Every iteration.
    pub iterations: Vec<Iteration<Pose>>,
    /// Cameras that had nothing to say, by name.
    pub empty_cameras: Vec<String>,
}

impl SolverSummary {
    /// Whether the numbers ran out of range: then the pose, however it looks, says nothing.
    pub fn is_broken(&self) -> bool {
        self.termination == Termination::NotFinite
            || !(self.final_cost.is_finite() && self.final_rms.is_finite())
    }
}

/// A fit that is stepped from outside.
#[derive(Debug)]
pub struct Fit {
    model: Arc<Model>,
    options: FitOptions,
    views: Vec<FitView>,
    distances: Vec<Option<SignedDistance>>,
    reference: Pose,
    constraints: Constraints,
    stage: usize,
    objective: Objective,
    solver: Solver<Pose>,
    initial_cost: f64,
    initial_rms: f64,
    iterations: Vec<Iteration<Pose>>,
    empty_cameras: Vec<String>,
    termination: Option<Termination>,
}

impl Fit {
    /// Prepares a fit. Cameras whose silhouette is empty are left out and named in the summary.
    ///
    /// A start that no camera sees ends before the first step with [`Termination::NoGradient`]: priors alone
    /// never move the body.
    ///
    /// # Errors
    /// If the pose is not the model's, data are not of the camera's size, an option is out of range, or no camera has a
    /// silhouette.
    pub fn new(
        model: Arc<Model>,
        views: Vec<FitView>,
        start: Pose,
        options: FitOptions,
    ) -> Result<Self, FitError> {
        Self::with_free_rotations(model, views, start, options, None)
    }

    /// The same with only some rotations free to move (`free[rotation]`), to refit a limb or a chain.
    ///
    /// # Errors
    /// As [`new`](Self::new), or `free` is not as long as the model has rotations.
    pub fn with_free_rotations(
        model: Arc<Model>,
        views: Vec<FitView>,
        start: Pose,
        options: FitOptions,
        free: Option<Vec<bool>>,
    ) -> Result<Self, FitError> {
        if let Some(found) = free.as_ref().map(Vec::len)
            && found != model.rotation_count()
        {
            return Err(FitError::FreeRotations { found, expected: model.rotation_count() });
        }
        let options = options.at_scale(&model, &views, &start);
        let prepared = PreparedFit::new(&model, views, &start, &options, |_, _, _| 0.0)?;
        let pose = prepared.start.clone();
        let constraints = Constraints { free, ..Constraints::default() };
        Ok(Self::begin(model, prepared, options, constraints, 0, &pose))
    }

    /// A fit that goes on from a pose with the last stage alone.
    pub(crate) fn at_last_stage(
        model: Arc<Model>,
        prepared: PreparedFit,
        options: FitOptions,
        pose: &Pose,
    ) -> Self {
        let last = options.stages.len() - 1;
        Self::begin(model, prepared, options, Constraints::default(), last, pose)
    }

    /// Takes the last stage up again from where the fit stands, with what the motion so far says of the pose in place of the
    /// pull to the start: the iterated Kalman update, begun at the frame's own fit.
    pub(crate) fn go_on_with(&mut self, motion: MotionPrior) {
        self.options.proximal_weight = 0.0;
        self.constraints.motion = Some(Arc::new(motion));
        self.constraints.free = None;
        self.stage = self.options.stages.len() - 1;
        let pose = self.solver.point().clone();
        self.begin_anew(&pose);
        self.termination = None;
    }

    /// The same fit with what the pictures say beside their silhouettes: pulls at limbs, from here on. The stage that it
    /// is in begins again where it stands. Without any pull nothing changes, to the bit.
    ///
    /// # Errors
    /// If a pull names a limb or a camera that does not exist, or a camera has with lens distortion.
    pub fn with_cues(mut self, cues: Arc<CueSet>) -> Result<Self, FitError> {
        cues.check(&self.model)?;
        if !cues.pulls.is_empty() {
            self.constraints.cues = Some(cues);
            self.begin_constrained();
        }
        Ok(self)
    }

    /// The same fit with a residual of the caller's own, from here on. The stage that it is in begins again where it stands.
    pub fn with_residual(mut self, residual: Arc<dyn Residual>) -> Self {
        self.constraints.residuals.push(residual);
        self.begin_constrained();
        self
    }

    fn begin_constrained(&mut self) {
        let pose = self.solver.point().clone();
        self.begin_anew(&pose);
        if self.iterations.is_empty() {
            (self.initial_cost, self.initial_rms) = (self.solver.cost(), self.solver.rms());
        }
    }

    fn begin(
        model: Arc<Model>,
        prepared: PreparedFit,
        options: FitOptions,
        constraints: Constraints,
        stage: usize,
        pose: &Pose,
    ) -> Self {
        let PreparedFit { views, distances, start, empty_cameras } = prepared;
        let (objective, solver) =
            Self::begin_stage(&model, &views, &distances, &options, stage, &start, pose, constraints.clone());
        let termination = objective.is_blind().then_some(Termination::NoGradient);
        Self {
            initial_cost: solver.cost(),
            initial_rms: solver.rms(),
            termination,
            reference: start,
            constraints,
            stage,
            objective,
            solver,
            iterations: Vec::new(),
            empty_cameras,
            model,
            options,
            views,
            distances,
        }
    }

    #[expect(clippy::too_many_arguments, reason = "the parts of a fit, before there is one")]
    fn begin_stage(
        model: &Arc<Model>,
        views: &[FitView],
        distances: &[Option<SignedDistance>],
        options: &FitOptions,
        index: usize,
        reference: &Pose,
        pose: &Pose,
        constraints: Constraints,
    ) -> (Objective, Solver<Pose>) {
        let stage = options.stages[index];
        let mut objective =
            Objective::new(Arc::clone(model), views, distances, options, stage, reference.clone());
        objective.constrain(constraints);
        // A wide stage begins far off: there every pixel would be doubted.
        if options.pixel_loss != Loss::Squares && index > 0 && index + DOUBTING_STAGES >= options.stages.len()
        {
            objective.doubt_pixels(pose, options.pixel_loss);
        }
        let solver = Solver::new(&mut objective, pose.clone(), options.solver_options(&stage));
        (objective, solver)
    }

    /// One iteration; `None` once the last stage has ended.
    pub fn step(&mut self) -> Option<Iteration<Pose>> {
        loop {
            if self.termination.is_some() {
                return None;
            }
            if let Some(iteration) = self.solver.step(&mut self.objective) {
                let record = Iteration { stage: self.stage, ..iteration };
                self.iterations.push(record.clone());
                return Some(record);
            }
            if self.stage + 1 == self.options.stages.len()
                || self.solver.termination() == Some(Termination::NotFinite)
            {
                self.termination = self.solver.termination();
                return None;
            }
            self.stage += 1;
            let pose = self.solver.point().clone();
            self.begin_anew(&pose);
        }
    }

    /// Begins the current stage at a pose.
    fn begin_anew(&mut self, pose: &Pose) {
        (self.objective, self.solver) = Self::begin_stage(
            &self.model,
            &self.views,
            &self.distances,
            &self.options,
            self.stage,
            &self.reference,
            pose,
            self.constraints.clone(),
        );
    }

    /// Runs to the end or until cancelled.
    pub fn run(&mut self, cancel: &CancelToken, mut on_step: impl FnMut(&Iteration<Pose>)) -> SolverSummary {
        while !cancel.is_cancelled() {
            match self.step() {
                Some(record) => on_step(&record),
                None => break,
            }
        }
        self.summary()
    }

    /// Its choices: what it was given, made to the scale of its views where that was asked for.
    pub fn options(&self) -> &FitOptions {
        &self.options
    }

    /// Where it stands.
    pub fn pose(&self) -> &Pose {
        self.solver.point()
    }

    /// Cost where it stands, by the current stage's measure.
    pub fn cost(&self) -> f64 {
        self.solver.cost()
    }

    /// Root of the mean squared residual per pixel where it stands.
    pub fn rms(&self) -> f64 {
        self.solver.rms()
    }

    /// Root of the mean squared residual per pixel at the start.
    pub fn initial_rms(&self) -> f64 {
        self.initial_rms
    }

    /// Cost at the start.
    pub fn initial_cost(&self) -> f64 {
        self.initial_cost
    }

    /// Index of the stage it is in.
    pub fn stage(&self) -> usize {
        self.stage
    }

    /// Normal equations where it stands: what the cameras see of each direction.
    pub fn equations(&self) -> &NormalEquations {
        self.solver.equations()
    }

    /// Normal equations of what the frame says by itself where the fit stands, without any pull to another pose:
    /// in tangent columns and as if every pixel were sampled, by the current stage's measure.
    pub fn frame_equations(&mut self) -> NormalEquations {
        self.objective.frame_equations(self.solver.point())
    }

    /// Why it ended; `None` while it may go on.
    pub fn termination(&self) -> Option<Termination> {
        self.termination
    }

    /// Cameras that had nothing to say, by name.
    pub fn empty_cameras(&self) -> &[String] {
        &self.empty_cameras
    }

    /// What it did so far; not ended means cancelled.
    pub fn summary(&self) -> SolverSummary {
        SolverSummary {
            termination: self.termination.unwrap_or(Termination::Cancelled),
            pose: self.pose().clone(),
            initial_cost: self.initial_cost,
            final_cost: self.cost(),
            final_rms: self.rms(),
            iterations: self.iterations.clone(),
            empty_cameras: self.empty_cameras.clone(),
        }
    }
}
