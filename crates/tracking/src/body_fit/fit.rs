//! The fit itself, stage after stage.

use std::sync::Arc;

use thiserror::Error;

use super::cameras::{CameraSet, CameraState};
use super::frames::BodyFrame;
use super::options::BodyFitOptions;
use super::problem::{BodyProblem, BodyState};
use super::report::{self, BodyFit};
use super::scale;
use super::survey::{LeftOut, Unusable, usable_views, worst};
use super::widening::Widening;
use crate::body::{Model, ModelError, Pose, PoseError, Sizes};
use crate::cancel::CancelToken;
use crate::fit::{FitError, Stage};
use crate::optimize::{Method, Solver, Termination};
use crate::residual::proportion_prior::BodySizes;
use crate::silhouette::{Overlap, SignedDistance};

/// How far a fit is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyProgress {
    /// Index of the stage.
    pub stage: usize,
    /// How many stages there are.
    pub stages: usize,
    /// Iterations so far, all stages together.
    pub iterations: usize,
    /// Root of the mean squared residual per pixel, grey levels.
    pub rms: f64,
}

/// Why a body cannot be fitted.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum BodyFitError {
    #[error("frame {frame}: {error}")]
    Frame { frame: usize, error: FitError },
    #[error("camera \"{}\" in frame {}: {}; no silhouette of any frame can be used", .0.camera, .0.frame, .0.because)]
    Unusable(LeftOut),
    #[error("no frame was given")]
    NoFrames,
    #[error("`stages` is empty; expected at least one stage")]
    NoStages,
    #[error("`proportions` are not all finite and above 0")]
    Proportions,
    #[error("`widening` is {widening}; expected metres, 0 or more")]
    Widening { widening: f64 },
    #[error("`stages[{stage}]`: stride 0, a ramp without width or a slack that is not above 0")]
    Stage { stage: usize },
    #[error(
        "the body does not overlap the silhouettes of frame {frame} or those after it; expected a better start"
    )]
    Lost { frame: usize },
    #[error("the body \"{body}\" has other limbs than \"{of}\"; expected the same with other sizes")]
    OtherLimbs { body: String, of: String },
    #[error(transparent)]
    Size(#[from] ModelError),
    #[error("stopped by you")]
    Cancelled,
}

/// A widening is believed if it is this many of its standard deviations above 0.
const SURE: f64 = 3.0;
/// Stages that are gone through again where a widening is not believed.
const LAST_STAGES: usize = 2;

/// The sizes that a fit begins with.
#[derive(Debug, Clone, Copy)]
pub enum FirstSizes<'a> {
    /// The body's, scaled as a whole by what the silhouettes say.
    Silhouettes,
    /// The body's, scaled by exp of this.
    Scaled(f64),
    /// A body's whose sizes are about right, as [`acquire`](crate::acquisition::acquire) finds them. The fit begins with the
    /// stages in which sizes are free.
    Known(&'a Model),
}

/// Fits sizes and poses together. Frames without any silhouette are left out.
///
/// `start` is the body whose proportions the prior knows. A widening of the silhouettes that
/// is not surely there is taken for none, and the last stages are gone through again without it.
///
/// # Errors
/// Poses that are not the model's, data that are not the cameras', options out of range, no silhouette at all, or known sizes
/// of a body of other limbs.
pub fn fit_body(
    start: Arc<Model>,
    frames: Vec<BodyFrame>,
    first: FirstSizes<'_>,
    options: &BodyFitOptions,
    cancel: &CancelToken,
    mut progress: impl FnMut(BodyProgress),
) -> Result<BodyFit, BodyFitError> {
    check(options)?;
    let names =
        |model: &Model| -> Vec<String> { model.limbs().iter().map(|limb| limb.name.clone()).collect() };
    if let FirstSizes::Known(known) = first
        && names(&start) != names(known)
    {
        return Err(BodyFitError::OtherLimbs { body: known.name().to_owned(), of: start.name().to_owned() });
    }
    let usable = usable(&start, frames)?;
    let sizes = Sizes::new(start.clone(), options.choice);
    let mut stage = 0;
    let (poses, body) = match first {
        FirstSizes::Silhouettes => {
            let (size, poses) = scale::from_silhouettes(&start, &usable.0, 0.0);
            (poses, BodySizes::scaled(&sizes, size))
        }
        FirstSizes::Scaled(size) => (posed(&usable.0), BodySizes::scaled(&sizes, size)),
        FirstSizes::Known(known) => {
            stage = options.stages.iter().position(|stage| stage.slack >= 1.0).unwrap_or(0);
            (posed(&usable.0), BodySizes::of(&sizes, known))
        }
    };
    let begin = BodyState { poses, body, cameras: Vec::new() };
    let (fit, _) = fit(&sizes, usable, None, begin, stage, options, cancel, &mut progress)?;
    Ok(fit)
}

/// Fits cameras too, from poses, a body and cameras that are about right.
pub(super) fn fit_cameras(
    start: &Arc<Model>,
    frames: Vec<BodyFrame>,
    (known, changes): (&Model, &[CameraState]),
    cameras: &CameraSet,
    options: &BodyFitOptions,
    cancel: &CancelToken,
    mut progress: impl FnMut(BodyProgress),
) -> Result<(BodyFit, CameraFit), BodyFitError> {
    let usable = usable(start, frames)?;
    let sizes = Sizes::new(Arc::clone(start), options.choice);
    let begin =
        BodyState { poses: posed(&usable.0), body: BodySizes::of(&sizes, known), cameras: changes.to_vec() };
    fit(&sizes, usable, Some(cameras), begin, 0, options, cancel, &mut progress)
}

/// By how much cameras differ from their calibration, and with what deviations.
#[derive(Debug, Clone, Default)]
pub(super) struct CameraFit {
    pub(super) changes: Vec<CameraState>,
    pub(super) deviations: Vec<CameraState>,
}

fn posed(frames: &[BodyFrame]) -> Vec<Pose> {
    frames.iter().map(|frame| frame.start.normalized()).collect()
}

/// All stages from `first` on.
#[expect(clippy::too_many_arguments, reason = "both callers give each of them")]
fn fit(
    sizes: &Sizes,
    (frames, left_out): (Vec<BodyFrame>, Vec<LeftOut>),
    cameras: Option<&CameraSet>,
    begin: BodyState,
    first: usize,
    options: &BodyFitOptions,
    cancel: &CancelToken,
    progress: &mut impl FnMut(BodyProgress),
) -> Result<(BodyFit, CameraFit), BodyFitError> {
    let stages: Vec<Stage> = options.stages.iter().map(|stage| stage.stage).collect();
    let of_views = |frame: &BodyFrame| frame.views.iter().map(|view| view.distance(&stages)).collect();
    let distances: Vec<Vec<Option<SignedDistance>>> = frames.iter().map(of_views).collect();
    let overlap_before = overlap(sizes, &begin, &frames, cameras);
    let inputs = Inputs { sizes, frames: &frames, distances: &distances, cameras };
    let mut descent = descend(&inputs, begin, options, first, cancel, progress)?;
    let first_rms = descent.rms[0];
    if let Some(widening) = &mut descent.widening {
        widening.is_believed = widening.px.abs() > SURE * widening.deviation_px;
        if !widening.is_believed {
            let plain = BodyFitOptions { widening: 0.0, ..options.clone() };
            let first = options.stages.len().saturating_sub(LAST_STAGES);
            let body = BodySizes { widening_px: 0.0, ..descent.state.body };
            let begin = BodyState { body, ..descent.state };
            let again = descend(&inputs, begin, &plain, first, cancel, progress)?;
            let iterations = descent.iterations + again.iterations;
            descent = Descent { iterations, widening: descent.widening, ..again };
        }
    }
    descent.rms[0] = first_rms;
    let iou = [overlap_before, overlap(sizes, &descent.state, &frames, cameras)];
    let of_cameras = CameraFit {
        changes: descent.state.cameras.clone(),
        deviations: std::mem::take(&mut descent.camera_deviations),
    };
    Ok((BodyFit { left_out, ..report::summary(sizes, descent, options, &frames, iou)? }, of_cameras))
}

/// What every stage looks at.
struct Inputs<'a> {
    sizes: &'a Sizes,
    frames: &'a [BodyFrame],
    distances: &'a [Vec<Option<SignedDistance>>],
    cameras: Option<&'a CameraSet>,
}

/// Where the stages led.
pub(super) struct Descent {
    /// Poses and sizes.
    pub(super) state: BodyState,
    /// Posterior standard deviations of θ, size and girth.
    pub(super) deviations: Vec<f64>,
    /// The same of the cameras.
    camera_deviations: Vec<CameraState>,
    /// The silhouettes' widening, where it was unknown.
    pub(super) widening: Option<Widening>,
    /// Root of the mean squared residual per pixel before and after, each by its own stage's measure.
    pub(super) rms: [f64; 2],
    /// Rejected ones included.
    pub(super) iterations: usize,
    /// Why the last stage ended.
    pub(super) termination: Termination,
}

/// Goes through the stages from `first` on.
fn descend(
    inputs: &Inputs<'_>,
    mut state: BodyState,
    options: &BodyFitOptions,
    first: usize,
    cancel: &CancelToken,
    progress: &mut impl FnMut(BodyProgress),
) -> Result<Descent, BodyFitError> {
    let (mut iterations, mut initial_rms, mut end) = (0, None, None);
    for (index, &stage) in options.stages.iter().enumerate().skip(first) {
        let mut problem = BodyProblem::new(
            inputs.sizes,
            inputs.frames,
            inputs.distances,
            inputs.cameras,
            options,
            stage,
            &state,
        );
        let method = Method::LevenbergMarquardt;
        let solver_options = stage.stage.solver_options(method, options.damping, false);
        let mut solver = Solver::new(&mut problem, state.clone(), solver_options);
        initial_rms.get_or_insert(solver.rms);
        while let Some(iteration) = solver.step(&mut problem) {
            iterations += 1;
            let (stages, rms) = (options.stages.len(), iteration.rms);
            progress(BodyProgress { stage: index, stages, iterations, rms });
            if cancel.is_cancelled() {
                return Err(BodyFitError::Cancelled);
            }
        }
        state = solver.point.clone();
        let termination = solver.termination.unwrap_or(Termination::NotFinite);
        if index + 1 < options.stages.len() {
            continue;
        }
        let deviations = report::deviations(&solver.equations, problem.shape_unit(), problem.of_sizes());
        let of_cameras = inputs.cameras.map_or(Vec::new(), |cameras| {
            let unit = problem.camera_unit();
            cameras.deviations(&report::covariance(&solver.equations, unit, problem.of_cameras()))
        });
        end = Some((deviations, of_cameras, problem.mean_metres_per_px, solver.rms, termination));
    }
    let Some((mut deviations, camera_deviations, metres_per_px, final_rms, termination)) = end else {
        return Err(BodyFitError::NoStages);
    };
    let others = inputs.sizes.count() + 2;
    let widening = deviations.get(others).map(|&deviation_px| Widening {
        px: state.body.widening_px,
        deviation_px,
        metres_per_px,
        is_believed: true,
    });
    deviations.truncate(others);
    let rms = [initial_rms.unwrap_or(final_rms), final_rms];
    Ok(Descent { state, deviations, camera_deviations, widening, rms, iterations, termination })
}

fn check(options: &BodyFitOptions) -> Result<(), BodyFitError> {
    if options.stages.is_empty() {
        return Err(BodyFitError::NoStages);
    }
    if !options.proportions.is_valid() {
        return Err(BodyFitError::Proportions);
    }
    if !(options.widening.is_finite() && options.widening >= 0.0) {
        return Err(BodyFitError::Widening { widening: options.widening });
    }
    let is_wrong = |stage: &super::BodyStage| {
        stage.stage.stride == 0
            || !stage.stage.ramp.is_valid()
            || !(stage.slack.is_finite() && stage.slack > 0.0)
    };
    match options.stages.iter().position(is_wrong) {
        Some(stage) => Err(BodyFitError::Stage { stage }),
        None => Ok(()),
    }
}

/// Checked frames with a silhouette in at least one camera, without the cameras that have none or one that cannot be a
/// person's, and those cameras.
fn usable(model: &Model, mut frames: Vec<BodyFrame>) -> Result<(Vec<BodyFrame>, Vec<LeftOut>), BodyFitError> {
    let Some(first) = frames.first().map(|frame| frame.frame) else { return Err(BodyFitError::NoFrames) };
    let mut left_out = Vec::new();
    for BodyFrame { frame, views, start, .. } in &mut frames {
        let at_frame = |error: FitError| BodyFitError::Frame { frame: *frame, error };
        start.check(model).map_err(|error: PoseError| at_frame(error.into()))?;
        for view in views.iter() {
            view.check().map_err(at_frame)?;
        }
        *views = usable_views(*frame, std::mem::take(views), &mut left_out);
    }
    frames.retain(|frame| !frame.views.is_empty());
    if !frames.is_empty() {
        return Ok((frames, left_out));
    }
    if let Some(worst) = worst(left_out.iter()).filter(|worst| worst.because != Unusable::Nobody) {
        return Err(BodyFitError::Unusable(worst.clone()));
    }
    let reasons = "no frame has a silhouette in any camera that counts".to_owned();
    Err(BodyFitError::Frame { frame: first, error: FitError::NoData { reasons } })
}

/// IoU of model and masks, all frames and cameras together; `None` without masks.
fn overlap(
    sizes: &Sizes,
    BodyState { poses, body, cameras }: &BodyState,
    frames: &[BodyFrame],
    set: Option<&CameraSet>,
) -> Option<f64> {
    let model = sizes.model(&body.log_ratios, body.size).ok()?;
    let of_frame = |(frame, pose): (&BodyFrame, &Pose)| {
        let own = set.map(|set| set.seen(frame, pose, cameras));
        let all = own.as_deref().unwrap_or(&[]).iter().map(|(frame, pose)| (frame, pose));
        let all = all.chain(own.is_none().then_some((frame, pose)));
        all.filter_map(|(frame, pose)| frame.overlap(&model, pose, body.widening_px)).reduce(Overlap::merge)
    };
    frames.iter().zip(poses).filter_map(of_frame).reduce(Overlap::merge)?.iou()
}
