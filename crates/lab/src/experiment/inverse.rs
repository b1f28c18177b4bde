//! (4.10) as it is written, δ = (JᵀJ)⁻¹ Jᵀρ, and what can be done instead.
//!
//! JᵀJ is singular in exact arithmetic. In floating point it seldom is, and the inverse exists: then the step is as long
//! as rounding makes it. Beside it stand the pseudo-inverse and dampings from small to large, from the same starts:
//! what the report's preset uses is chosen here.

use std::sync::Arc;

use backlit_tracking::body::{Model, Parameters, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, FitView, Objective, Preset};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::optimize::{LeastSquares, NormalEquations};
use backlit_tracking::search::start::perturb;
use serde::Serialize;

use super::curve::Curve;
use super::fig52::{GOOD_MM, medians};
use super::{ExperimentError, Progress, Simulation, scene};
use crate::synthetic::upper_body;

/// How JᵀJ is turned round.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Inverse {
    /// By elimination with pivots, whatever comes of it.
    Plain,
    /// The pseudo-inverse: null directions stay alone.
    Pseudo,
    /// After so much of mean(diag JᵀJ) has been added to its diagonal.
    Damped(f64),
}

impl Inverse {
    /// Words for tables.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Plain => "inverse, as written".to_owned(),
            Self::Pseudo => "pseudo-inverse".to_owned(),
            Self::Damped(damping) => format!("damping {damping}"),
        }
    }
}

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Cameras.
    pub cameras: usize,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// Number of starts.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// How far every joint of a start is turned from the truth, radians.
    pub angle_rad: f64,
    /// How far the root of a start is from the truth, metres.
    pub distance_m: f64,
    /// How the data are made.
    pub simulation: Simulation,
    /// What is compared.
    pub inverses: Vec<Inverse>,
}

impl Default for Options {
    fn default() -> Self {
        let damped = [1e-6, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0].map(Inverse::Damped);
        Self {
            cameras: 2,
            size_px: [192, 144],
            starts: 100,
            seed: 1,
            angle_rad: 5f64.to_radians(),
            distance_m: 0.03,
            simulation: Simulation::Prediction,
            inverses: [Inverse::Plain, Inverse::Pseudo].into_iter().chain(damped).collect(),
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One entry an inverse.
    pub rows: Vec<Row>,
}

/// What came of one inverse.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What it was.
    pub inverse: Inverse,
    /// Median over the starts of the first step's length, metres and coefficients together.
    pub first_step: f64,
    /// Steps of all starts that raised the cost, and all steps.
    pub raised: [usize; 2],
    /// Starts whose end has a mean joint error below [`GOOD_MM`].
    pub good: usize,
    /// Starts that ended before the last iteration: numbers out of range, or no pixel of the body in any picture.
    pub broken: usize,
    /// Median over the starts of the last joint error, millimetres.
    pub median_mm: f64,
}

/// What one start came to.
struct Descent {
    curve: Curve,
    first_step: f64,
}

/// Runs every inverse from every start.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    if options.starts == 0 {
        return Err(ExperimentError::Option { option: "starts", value: 0.0, expected: "1 or more" });
    }
    let model = Arc::new(builtin::upper_body());
    let fit = FitOptions::preset(Preset::Report);
    let truth = upper_body::motion(&model, 0);
    let cameras = upper_body::cameras(options.cameras, options.size_px)?;
    let see =
        |camera| scene::view(&model, &truth, camera, options.simulation, fit.renderer, fit.final_ramp());
    let views = cameras.iter().map(see).collect::<Result<Vec<_>, _>>()?;
    let total = options.inverses.len() * options.starts;
    let mut rows = Vec::new();
    for &inverse in &options.inverses {
        let mut descents = Vec::new();
        for start in 0..options.starts {
            on_progress(Progress { done: rows.len() * options.starts + start, total });
            let seed = options.seed.wrapping_add(start as u64);
            let from = perturb(&model, &truth, options.angle_rad, options.distance_m, seed);
            descents.push(descend(&model, &truth, &views, &from, &fit, inverse));
            if cancel.is_cancelled() {
                return Err(ExperimentError::Cancelled);
            }
        }
        rows.push(Row::of(inverse, &descents, fit.stages[0].iterations));
    }
    on_progress(Progress { done: total, total });
    Ok(Report { rows })
}

/// The report's iterations, each step by its inverse.
fn descend(
    model: &Arc<Model>,
    truth: &Pose,
    views: &[FitView],
    from: &Pose,
    fit: &FitOptions,
    inverse: Inverse,
) -> Descent {
    let stage = fit.stages[0];
    let distances = vec![None; views.len()];
    let mut objective = Objective::new(Arc::clone(model), views, &distances, fit, stage, from.clone());
    let mut equations = NormalEquations::zeros(objective.columns());
    let mut pose = from.normalized();
    objective.evaluate(&pose, &mut equations);
    let mut curve = Curve {
        name: inverse.name(),
        costs: vec![equations.cost],
        joint_errors_mm: vec![mean_joint_error_mm(model, &pose, truth)],
        termination: "step-limit",
    };
    let mut first_step = None;
    for _ in 0..stage.iterations {
        let step = match inverse {
            Inverse::Plain => equations.jtj.clone().try_inverse().map(|inverse| inverse * &equations.jtr),
            Inverse::Pseudo => Some(equations.step(0.0)),
            Inverse::Damped(damping) => Some(equations.step(damping)),
        };
        let Some(step) = step.filter(|step| step.iter().all(|x| x.is_finite()) && step.norm() > 0.0) else {
            curve.termination = "not-finite";
            break;
        };
        first_step.get_or_insert(step.norm());
        pose = pose.retract(Parameters::Raw, step.as_slice());
        equations.clear();
        objective.evaluate(&pose, &mut equations);
        curve.costs.push(equations.cost);
        curve.joint_errors_mm.push(mean_joint_error_mm(model, &pose, truth));
    }
    Descent { curve, first_step: first_step.unwrap_or(f64::INFINITY) }
}

impl Row {
    fn of(inverse: Inverse, descents: &[Descent], iterations: usize) -> Self {
        let curves = || descents.iter().map(|descent| &descent.curve);
        let raised = curves().map(|curve| curve.costs.windows(2).filter(|two| two[1] > two[0]).count()).sum();
        let last = |list: Vec<f64>| list.last().copied().unwrap_or_default();
        Self {
            inverse,
            first_step: last(medians(descents.iter().map(|descent| vec![descent.first_step]))),
            raised: [raised, curves().map(|curve| curve.costs.len() - 1).sum()],
            good: curves().filter(|curve| curve.final_joint_error_mm() < GOOD_MM).count(),
            broken: curves().filter(|curve| curve.costs.len() <= iterations).count(),
            median_mm: last(medians(curves().map(|curve| vec![curve.final_joint_error_mm()]))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inverse as written throws the body away in its first step; the preset's damping brings it home.
    #[test]
    fn the_plain_inverse_is_no_step() {
        let preset = Inverse::Damped(FitOptions::preset(Preset::Report).damping);
        let options = Options {
            starts: 4,
            inverses: vec![Inverse::Plain, Inverse::Pseudo, preset],
            ..Options::default()
        };
        let report = run(&options, &CancelToken::new(), |_| {}).unwrap();
        let [plain, pseudo, preset] = &report.rows[..] else { panic!("three rows") };
        assert!(plain.first_step > 1e3 * pseudo.first_step, "{plain:?}, {pseudo:?}");
        assert!(plain.good == 0 && plain.median_mm > 100.0, "{plain:?}");
        assert!(preset.raised[0] == 0 && preset.good >= 3 && preset.median_mm < 3.0, "{preset:?}");
    }
}
