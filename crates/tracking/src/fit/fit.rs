//! One frame's fit, iteration by iteration, stage after stage. Every iteration is kept, rejected ones too.

use std::sync::Arc;

use super::evidence::{FitError, FitView, PreparedFit};
use super::objective::{Constraints, Objective};
use super::options::FitOptions;
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::optimize::{Iteration, NormalEquations, Solver, Termination};
use crate::residual::cue::CueSet;
use crate::residual::learnt_prior::PartEnergy;
use crate::residual::motion_prior::MotionPrior;
use crate::residual::{Loss, Residual};

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
    /// Its choices: what it was given, made to the scale of its views where that was asked for.
    pub options: FitOptions,
    /// Index of the stage it is in.
    pub stage: usize,
    /// Why it ended; `None` while it may go on.
    pub termination: Option<Termination>,
    /// Cost at the start.
    pub initial_cost: f64,
    /// Root of the mean squared residual per pixel at the start.
    pub initial_rms: f64,
    model: Arc<Model>,
    /// Its start is what the proximal prior pulls to.
    prepared: PreparedFit,
    constraints: Constraints,
    objective: Objective,
    solver: Solver<Pose>,
    iterations: Vec<Iteration<Pose>>,
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

    /// The same frame fitted from another start, which the pull to the start is then to.
    pub(crate) fn started_at(&self, start: Pose) -> Self {
        let prepared = PreparedFit { start: start.clone(), ..self.prepared.clone() };
        let constraints = self.constraints.clone();
        Self::begin(Arc::clone(&self.model), prepared, self.options.clone(), constraints, 0, &start)
    }

    /// What the frame says of a pose by itself, by the current stage's measure, and what motion files say
    /// ([`Objective::free_equations`]).
    pub(crate) fn free_equations(&mut self, pose: &Pose) -> (NormalEquations, Vec<PartEnergy>) {
        self.objective.free_equations(pose)
    }

    /// What each camera says by itself at the pose of [`free_equations`](Self::free_equations) ([`Objective::camera_equations`]).
    pub(crate) fn camera_equations(&mut self) -> Vec<NormalEquations> {
        self.objective.camera_equations()
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
    /// pull to the start and of all priors but the joints' limits: the iterated Kalman update, begun at the frame's own fit.
    pub(crate) fn go_on_with(&mut self, motion: MotionPrior) {
        self.stage = self.options.stages.len() - 1;
        self.carry(motion);
        self.termination = None;
    }

    /// The same fit with what the motion so far says from its first iteration on: the iterated Kalman update from the prediction.
    pub(crate) fn steered_by(mut self, motion: MotionPrior) -> Self {
        self.carry(motion);
        (self.initial_cost, self.initial_rms) = (self.solver.cost(), self.solver.rms);
        self
    }

    fn carry(&mut self, motion: MotionPrior) {
        self.options.proximal_weight = 0.0;
        self.constraints.motion = Some(Arc::new(motion));
        self.constraints.free = None;
        self.begin_anew();
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
        self.begin_anew();
        if self.iterations.is_empty() {
            (self.initial_cost, self.initial_rms) = (self.solver.cost(), self.solver.rms);
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
        let (objective, solver) = begin_stage(&model, &prepared, &options, &constraints, stage, pose);
        Self {
            initial_cost: solver.cost(),
            initial_rms: solver.rms,
            termination: objective.is_blind().then_some(Termination::NoGradient),
            model,
            options,
            prepared,
            constraints,
            stage,
            objective,
            solver,
            iterations: Vec::new(),
        }
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
                || self.solver.termination == Some(Termination::NotFinite)
            {
                self.termination = self.solver.termination;
                return None;
            }
            self.stage += 1;
            self.begin_anew();
        }
    }

    /// Begins the current stage where the fit stands.
    fn begin_anew(&mut self) {
        let Self { model, prepared, options, constraints, stage, .. } = self;
        let pose = &self.solver.point;
        (self.objective, self.solver) = begin_stage(model, prepared, options, constraints, *stage, pose);
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

    /// Where it stands.
    pub fn pose(&self) -> &Pose {
        &self.solver.point
    }

    /// Cost where it stands, by the current stage's measure.
    pub fn cost(&self) -> f64 {
        self.solver.cost()
    }

    /// Root of the mean squared residual per pixel where it stands.
    pub fn rms(&self) -> f64 {
        self.solver.rms
    }

    /// Normal equations where it stands: what the cameras see of each direction.
    pub fn equations(&self) -> &NormalEquations {
        &self.solver.equations
    }

    /// Normal equations of what the frame says by itself where the fit stands, without any pull to another pose:
    /// in tangent columns and as if every pixel were sampled, by the current stage's measure.
    pub fn frame_equations(&mut self) -> NormalEquations {
        self.objective.frame_equations(&self.solver.point)
    }

    /// Normal equations of what is measured where the fit stands ([`Objective::measured_equations`]).
    pub(crate) fn measured_equations(&mut self) -> NormalEquations {
        self.objective.measured_equations(&self.solver.point)
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
            empty_cameras: self.prepared.empty_cameras.clone(),
        }
    }
}

/// The objective and the solver of a stage that begins at a pose.
fn begin_stage(
    model: &Arc<Model>,
    prepared: &PreparedFit,
    options: &FitOptions,
    constraints: &Constraints,
    index: usize,
    pose: &Pose,
) -> (Objective, Solver<Pose>) {
    let PreparedFit { views, distances, start, .. } = prepared;
    let stage = options.stages[index];
    let mut objective = Objective::new(Arc::clone(model), views, distances, options, stage, start.clone());
    objective.constraints = constraints.clone();
    // A wide stage begins far off: there every pixel would be doubted.
    if options.pixel_loss != Loss::Squares && index > 0 && index + DOUBTING_STAGES >= options.stages.len() {
        objective.doubt_pixels(pose, options.pixel_loss);
    }
    let solver_options = stage.solver_options(options.method, options.damping, options.run_all);
    let solver = Solver::new(&mut objective, pose.clone(), solver_options);
    (objective, solver)
}
