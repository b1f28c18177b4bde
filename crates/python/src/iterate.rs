//! `bl.iterate`: the fit of one frame, iteration by iteration, as `backlit fit` does it.

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, ensure};
use backlit_formats::Footage;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{Fit, FitOptions};
use backlit_tracking::optimize::{Iteration, NormalEquations};
use backlit_tracking::search::{WithoutStartOptions, without_start};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::arrays::{MaskShape, owned};
use crate::body::{BodyArgument, PyBody, joints};
use crate::camera_group::PyCameraGroup;
use crate::errors::{raised, refused, wrong};
use crate::fit::known_start;
use crate::options::{Choices, preset_of};
use crate::pose::PyPose;
use crate::render::DrawnBody;
use crate::take::{ArrayTake, CamerasOrTake, MaskValues};
use crate::work::{Job, interruptible, pool};

/// What all steps of a fit share.
#[derive(Debug)]
struct Setting {
    model: Arc<Model>,
    /// Ideal pinholes, for the pictures that are fitted to.
    cameras: Vec<Arc<Camera>>,
    options: FitOptions,
    threads: Option<usize>,
}

/// The iterations of a fit. The first item is the start, before any step; rejected steps are there too.
#[pyclass(frozen, name = "Iterations", module = "backlit")]
#[derive(Debug)]
pub(crate) struct PyIterations {
    state: Mutex<SteppedFit>,
    setting: Arc<Setting>,
    pool: Option<ThreadPool>,
}

#[derive(Debug)]
struct SteppedFit {
    fit: Fit,
    /// Steps that were told.
    told: usize,
}

/// One iteration of a fit: a trial step, and where the solver stands after it.
#[pyclass(frozen, name = "Step", module = "backlit")]
#[derive(Debug)]
pub(crate) struct PyStep {
    number: usize,
    iteration: Iteration<Pose>,
    equations: NormalEquations,
    setting: Arc<Setting>,
}

/// Fits one frame, iteration by iteration: ``backlit fit`` for arrays, with the same result to the bit.
///
/// ``cams`` is a :class:`CameraGroup` beside ``masks`` (C, H, W), bool or uint8, or a list of C arrays (H, W); or a :class:`Take`,
/// of which ``frame`` is fitted. ``start`` is the pose to begin with; without one the take's own, else it is searched for.
/// ``body``, ``renderer``, ``spheres``, ``preset``, ``mask_values`` and ``n_threads`` are as of :func:`fit`. ``ramp`` is as of
/// :func:`render` and makes one stage of the fit's; ``method`` is ``gauss-newton`` or ``lm``; ``parameters`` are ``raw`` or
/// ``tangent``; ``damping`` is that of a stage's first step; ``iterations`` the most of all; with ``run_all`` all of them are run.
/// Raises :class:`InputError`, :class:`FileError` or :class:`Error`. Returns :class:`Iterations`, which yield a :class:`Step` each.
#[pyfunction]
#[pyo3(signature = (cams, masks = None, start = None, *, body = None, frame = 0, preset = "robust", renderer = None,
    spheres = None, ramp = None, method = None, parameters = None, damping = None, iterations = None, run_all = false,
    mask_values = None, n_threads = None))]
#[expect(clippy::too_many_arguments, reason = "each is an argument of Python's, most by name")]
pub(crate) fn iterate(
    py: Python<'_>,
    cams: CamerasOrTake<'_>,
    masks: Option<&Bound<'_, PyAny>>,
    start: Option<&PyPose>,
    body: Option<BodyArgument<'_>>,
    frame: usize,
    preset: &str,
    renderer: Option<&str>,
    spheres: Option<usize>,
    ramp: Option<&str>,
    method: Option<&str>,
    parameters: Option<&str>,
    damping: Option<f64>,
    iterations: Option<usize>,
    run_all: bool,
    mask_values: Option<MaskValues>,
    n_threads: Option<usize>,
) -> PyResult<PyIterations> {
    let choices = Choices { renderer, spheres, ramp, method, parameters, damping, iterations, run_all };
    let options = choices.options(preset_of(preset)?)?;
    let told = ArrayTake { body, mask_values, ..ArrayTake::default() };
    let footage = cams.take(py, masks, MaskShape::Moment, told)?.footage;
    if frame >= footage.frame_count() {
        return Err(wrong("frame", &format!("a number below {}", footage.frame_count()), &frame.to_string()));
    }
    let start = start.map(|start| start.pose.clone());
    if let Some(start) = &start {
        start.check(footage.take().model()).map_err(refused)?;
    }
    let begin = |job: &Job| begin(&footage, frame, start, options, job);
    let fit = interruptible(py, n_threads, None, begin)?.map_err(raised)?;
    let setting = Setting {
        model: Arc::clone(footage.take().model()),
        cameras: footage.cameras.to_vec(),
        options: fit.options.clone(),
        threads: n_threads,
    };
    let state = Mutex::new(SteppedFit { fit, told: 0 });
    Ok(PyIterations { state, setting: Arc::new(setting), pool: pool(n_threads)? })
}

fn begin(
    footage: &Footage,
    frame: usize,
    start: Option<Pose>,
    options: FitOptions,
    job: &Job,
) -> anyhow::Result<Fit> {
    let model = footage.take().model();
    let cameras: Vec<usize> = (0..footage.cameras.len()).collect();
    let views = footage.fit_views(&cameras, frame)?;
    let start = match start.or_else(|| known_start(footage.take(), frame)) {
        Some(start) => start,
        None => {
            let choices = WithoutStartOptions { fit: options.clone(), ..WithoutStartOptions::default() };
            let found = without_start(model, &views, &choices, &job.cancel);
            found.with_context(|| format!("frame {frame}: no start can be found"))?.pose().clone()
        }
    };
    let fit = Fit::new(Arc::clone(model), views, start, options)?;
    ensure!(
        fit.cost().is_finite(),
        "the fit has no cost: its numbers ran out of range; is the start near the cameras' view?"
    );
    Ok(fit)
}

impl SteppedFit {
    /// The next step; the first is the start.
    fn next(&mut self) -> Option<(usize, Iteration<Pose>, NormalEquations)> {
        let iteration = match self.told {
            0 => {
                let start = Iteration::start(self.fit.pose().clone(), self.fit.cost());
                Iteration { rms: self.fit.rms(), stage: self.fit.stage, ..start }
            }
            _ => self.fit.step()?,
        };
        self.told += 1;
        Some((self.told - 1, iteration, self.fit.equations().clone()))
    }
}

#[pymethods]
impl PyIterations {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> Option<PyStep> {
        let next = || self.state.lock().unwrap_or_else(PoisonError::into_inner).next();
        let next = py.detach(|| match &self.pool {
            Some(pool) => pool.install(next),
            None => next(),
        });
        let (number, iteration, equations) = next?;
        Some(PyStep { number, iteration, equations, setting: Arc::clone(&self.setting) })
    }

    /// Why the fit ended: ``converged-by-gain``, ``step-limit``, ``no-decrease`` …; None while it may go on.
    #[getter]
    fn termination(&self, py: Python<'_>) -> Option<&'static str> {
        let why = py.detach(|| self.state.lock().unwrap_or_else(PoisonError::into_inner).fit.termination);
        why.map(|why| why.name())
    }

    /// The cameras that are fitted to, with the lens taken out: of the pictures of :attr:`Step.prediction`.
    #[getter]
    fn cameras(&self) -> PyResult<PyCameraGroup> {
        PyCameraGroup::of(self.setting.cameras.iter().map(|camera| (**camera).clone()).collect())
    }

    /// The body.
    #[getter]
    fn body(&self) -> PyBody {
        PyBody::new(Arc::clone(&self.setting.model))
    }
}

impl PyStep {
    fn scene(&self) -> DrawnBody<'_> {
        let Setting { model, options, .. } = &*self.setting;
        let ramp = options.stages.get(self.iteration.stage).map_or(options.final_ramp(), |stage| stage.ramp);
        DrawnBody { model, pose: &self.iteration.point, renderer: options.renderer, ramp }
    }

    fn cameras(&self) -> Vec<&Camera> {
        self.setting.cameras.iter().map(|camera| &**camera).collect()
    }
}

#[pymethods]
impl PyStep {
    /// 0 for the start, then counting every trial.
    #[getter]
    fn number(&self) -> usize {
        self.number
    }

    /// Index of the stage it belongs to. Costs are comparable within a stage.
    #[getter]
    fn stage(&self) -> usize {
        self.iteration.stage
    }

    /// Cost where the solver stands after it, squared grey levels, priors included.
    #[getter]
    fn cost(&self) -> f64 {
        self.iteration.cost
    }

    /// Root of the mean squared residual a pixel there, grey levels.
    #[getter]
    fn rms(&self) -> f64 {
        self.iteration.rms
    }

    /// Cost of the trial: ``cost`` if it was accepted.
    #[getter]
    fn trial_cost(&self) -> f64 {
        self.iteration.trial_cost
    }

    /// Whether the trial was kept. If not, pose and arrays are those before it.
    #[getter]
    fn accepted(&self) -> bool {
        self.iteration.accepted
    }

    /// Damping of the trial.
    #[getter]
    fn damping(&self) -> f64 {
        self.iteration.damping
    }

    /// By how much the linear model predicted that the cost would fall.
    #[getter]
    fn predicted_decrease(&self) -> f64 {
        self.iteration.predicted_decrease
    }

    /// By how much the trial lowered it; negative if it rose.
    #[getter]
    fn actual_decrease(&self) -> f64 {
        self.iteration.actual_decrease
    }

    /// Length of the trial's step.
    #[getter]
    fn step_norm(&self) -> f64 {
        self.iteration.step_norm
    }

    /// The pose where the solver stands.
    #[getter]
    fn pose(&self) -> PyPose {
        PyPose::new(self.iteration.point.clone())
    }

    /// (J, 3): its joints, metres.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let model = &self.setting.model;
        owned(py, [model.limbs().len() + 1, 3], &joints(model, &self.iteration.point))
    }

    /// The ramp of the stage, as :func:`render` takes it.
    #[getter]
    fn ramp(&self) -> String {
        self.scene().ramp.to_string()
    }

    /// C arrays (H, W) of float64: the soft silhouettes of the pose, 0 subject to 255 background. Drawn when asked for.
    #[getter]
    fn prediction<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        self.scene().predictions(py, self.setting.threads, &self.cameras())
    }

    /// C arrays (H · W, n): the derivatives of ``prediction`` by the columns of the state. Computed when asked for, and large.
    #[getter]
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        self.scene().jacobians(py, self.setting.threads, &self.cameras(), self.setting.options.parameters)
    }

    /// (n,): the derivative of ``cost`` by the columns of the state, −2 Jᵀρ, priors included.
    #[getter]
    fn gradient<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let numbers: Vec<f64> = self.equations.jtr.iter().map(|pull| -2.0 * pull).collect();
        owned(py, [numbers.len()], &numbers)
    }

    /// (n, n): JᵀJ, priors included. A Gauss-Newton step δ solves ``normal_matrix @ δ = -gradient / 2``.
    #[getter]
    fn normal_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let columns = self.equations.columns();
        // It is symmetric: rows are columns.
        owned(py, [columns, columns], self.equations.jtj.as_slice())
    }

    fn __repr__(&self) -> String {
        let word = if self.iteration.accepted { "accepted" } else { "rejected" };
        format!(
            "Step({}, stage {}, cost {:.0}, {word})",
            self.number, self.iteration.stage, self.iteration.cost
        )
    }
}
