//! (4.10) as it is written, δ = (JᵀJ)⁻¹ Jᵀρ, and what can be done instead.
//!
//! JᵀJ is singular in exact arithmetic. In floating point it seldom is, and the inverse exists: then the step is as long
//! as rounding makes it. Beside it stand the pseudo-inverse and dampings from small to large, from the same starts:
//! what the report's preset uses is chosen here.

use std::sync::Arc;

use anyhow::Result;
use backlit_lab::experiment::scene;
use backlit_lab::synthetic::upper_body;
use backlit_tracking::body::{Model, Parameters, Pose, builtin};
use backlit_tracking::fit::{FitOptions, FitView, Objective, Preset};
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::optimize::{LeastSquares, NormalEquations};
use clap::Args;
use serde::Serialize;

use super::arguments::{SimulatedData, Starts};
use super::measures::{GOOD_MM, last, medians};
use super::{Experiment, Run, check_least};
use crate::output::number;
use crate::table::Table;

/// The step (4.10) as written, and the pseudo-inverse and dampings that can stand for it
#[derive(Debug, Args, Serialize)]
#[command(
    mut_arg("starts", |starts| starts.default_value("100")),
    mut_arg("start_noise", |noise| noise.default_value("5deg,3cm"))
)]
pub(crate) struct Inverses {
    /// Number of cameras
    #[arg(long, value_name = "N", default_value_t = 2)]
    cameras: usize,
    #[arg(skip = [192, 144])]
    size_px: [u64; 2],
    #[command(flatten)]
    #[serde(flatten)]
    starts: Starts,
    /// What the cameras see
    #[arg(long = "data", value_enum, default_value_t)]
    simulation: SimulatedData,
    #[arg(skip = inverses())]
    inverses: Vec<Inverse>,
}

/// How JᵀJ is inverted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Inverse {
    /// By elimination with pivots, whatever comes of it.
    Plain,
    /// Null directions stay alone.
    Pseudo,
    /// After this share of mean(diag JᵀJ) has been added to its diagonal.
    Damped(f64),
}

fn inverses() -> Vec<Inverse> {
    let damped = [1e-6, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0].map(Inverse::Damped);
    [Inverse::Plain, Inverse::Pseudo].into_iter().chain(damped).collect()
}

impl Inverse {
    fn name(self) -> String {
        match self {
            Self::Plain => "inverse, as written".to_owned(),
            Self::Pseudo => "pseudo-inverse".to_owned(),
            Self::Damped(damping) => format!("damping {damping}"),
        }
    }
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    rows: Vec<ByInverse>,
}

#[derive(Debug, Serialize)]
struct ByInverse {
    inverse: Inverse,
    /// Median over the starts of the first step's length, metres and coefficients together.
    first_step: f64,
    /// Steps of all starts that raised the cost, and all steps.
    raised: [usize; 2],
    /// Starts that ended below [`GOOD_MM`].
    good: usize,
    /// Starts that ended before the last iteration: numbers out of range, or no pixel of the body in any picture.
    broken: usize,
    median_mm: f64,
}

/// One start's way down.
struct Descent {
    costs: Vec<f64>,
    joint_error_mm: f64,
    first_step: f64,
}

impl Experiment for Inverses {
    const NAME: &'static str = "inverse";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        check_least("starts", self.starts.starts, 1)?;
        let model = Arc::new(builtin::upper_body());
        let fit = FitOptions::preset(Preset::Report);
        let truth = upper_body::motion(&model, 0);
        let cameras = upper_body::cameras(self.cameras, self.size_px)?;
        let (simulation, ramp) = (self.simulation.into(), fit.final_ramp());
        let see = |camera| scene::view(&model, &truth, camera, simulation, fit.renderer, ramp);
        let views = cameras.iter().map(see).collect::<Result<Vec<_>, _>>()?;
        let total = self.inverses.len() * self.starts.starts;
        let mut rows = Vec::new();
        for &inverse in &self.inverses {
            let mut descents = Vec::new();
            for start in 0..self.starts.starts {
                run.progress(rows.len() * self.starts.starts + start, total)?;
                let from = self.starts.from(&model, &truth, start);
                descents.push(descend(&model, &truth, &views, &from, &fit, inverse));
            }
            rows.push(ByInverse::of(inverse, &descents, fit.stages[0].iterations));
        }
        Ok(Report { rows })
    }

    fn table(&self, report: &Report) -> String {
        let starts = self.starts.starts;
        let share = |[raised, steps]: [usize; 2]| 100.0 * raised as f64 / steps.max(1) as f64;
        Table::of(
            &report.rows,
            &[
                ("step", &|row| row.inverse.name()),
                ("first step's length", &|row| format!("{:.2e}", row.first_step)),
                ("steps that raise the cost", &|row| format!("{:.1} %", share(row.raised))),
                ("broken off", &|row| format!("{} of {starts}", row.broken)),
                ("median end, mm", &|row| number(row.median_mm, 2)),
                (&format!("ends below {GOOD_MM} mm"), &|row| format!("{} of {starts}", row.good)),
            ],
        )
    }
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
    let (mut costs, mut first_step) = (vec![equations.cost], None);
    for _ in 0..stage.iterations {
        let step = match inverse {
            Inverse::Plain => equations.jtj.clone().try_inverse().map(|inverse| inverse * &equations.jtr),
            Inverse::Pseudo => Some(equations.step(0.0)),
            Inverse::Damped(damping) => Some(equations.step(damping)),
        };
        let Some(step) = step.filter(|step| step.iter().all(|x| x.is_finite()) && step.norm() > 0.0) else {
            break;
        };
        first_step.get_or_insert(step.norm());
        pose = pose.retract(Parameters::Raw, step.as_slice());
        equations.clear();
        objective.evaluate(&pose, &mut equations);
        costs.push(equations.cost);
    }
    let joint_error_mm = mean_joint_error_mm(model, &pose, truth);
    Descent { costs, joint_error_mm, first_step: first_step.unwrap_or(f64::INFINITY) }
}

impl ByInverse {
    fn of(inverse: Inverse, descents: &[Descent], iterations: usize) -> Self {
        let raised = |descent: &Descent| descent.costs.windows(2).filter(|two| two[1] > two[0]).count();
        let count = |of: &dyn Fn(&Descent) -> bool| descents.iter().filter(|descent| of(descent)).count();
        let median = |of: fn(&Descent) -> f64| last(&medians(descents.iter().map(|one| vec![of(one)])));
        Self {
            inverse,
            first_step: median(|descent| descent.first_step),
            raised: [
                descents.iter().map(raised).sum(),
                descents.iter().map(|descent| descent.costs.len() - 1).sum(),
            ],
            good: count(&|descent| descent.joint_error_mm < GOOD_MM),
            broken: count(&|descent| descent.costs.len() <= iterations),
            median_mm: median(|descent| descent.joint_error_mm),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    /// The inverse as written throws the body away in its first step; the preset's damping brings it home.
    #[test]
    fn the_plain_inverse_is_no_step() {
        let preset = Inverse::Damped(FitOptions::preset(Preset::Report).damping);
        let inverses = vec![Inverse::Plain, Inverse::Pseudo, preset];
        let mut small = Inverses { starts: Starts::new(4, 5.0, 0.03), inverses, ..defaults() };
        let report = small.run(&Run::hidden()).unwrap();
        let [plain, pseudo, preset] = &report.rows[..] else { panic!("three rows") };
        assert!(plain.first_step > 1e3 * pseudo.first_step, "{plain:?}, {pseudo:?}");
        assert!(plain.good == 0 && plain.median_mm > 100.0, "{plain:?}");
        assert!(preset.raised[0] == 0 && preset.good >= 3 && preset.median_mm < 3.0, "{preset:?}");
    }
}
