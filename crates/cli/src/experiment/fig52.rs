//! Figs. 5.2 and 5.3: the upper body from many starts, before one camera and before two.
//!
//! Data are the renderer's own grey levels of the true pose, so that the cost of the truth is zero. What one
//! camera cannot see costs nothing: there the cost falls while joints stay off. The same seed gives the same
//! starts for any number of cameras.

use std::sync::Arc;

use anyhow::{Result, ensure};
use backlit_lab::experiment::{Simulation, scene};
use backlit_lab::synthetic::upper_body::{self, LM_DAMPING};
use backlit_plot::{Axis, Figure, FigureOrSheet, Line};
use backlit_tracking::body::{Parameters, builtin};
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::RendererKind;
use backlit_tracking::statistics::median;
use clap::Args;
use serde::Serialize;

use super::arguments::{SIMULATIONS, Starts};
use super::measures::{FitCurve, GOOD_MM, NamedFit, last, medians};
use super::{Experiment, Run, check_least};
use crate::fit_options::one_of;
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;

/// The upper body before this many cameras.
#[derive(Debug, Args, Serialize)]
#[command(
    about = if CAMERAS == 1 {
        "The upper body before one camera, from many starts: cost and joint error per iteration"
    } else {
        "The same from the same starts before two cameras"
    },
    mut_arg("starts", |starts| starts.default_value("100")),
    mut_arg("start_noise", |noise| noise.default_value("10deg,5cm"))
)]
pub(crate) struct UpperBody<const CAMERAS: usize> {
    #[arg(skip = CAMERAS)]
    cameras: usize,
    #[arg(skip = [192, 144])]
    size_px: [u64; 2],
    #[command(flatten)]
    #[serde(flatten)]
    starts: Starts,
    /// What the cameras see
    #[arg(long = "data", value_parser = one_of(SIMULATIONS), default_value = "prediction")]
    simulation: Simulation,
    /// Iterations of every fit, more than most need to converge [1 to 10000]
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = within(1..=10_000_usize))]
    iterations: usize,
    #[arg(skip)]
    #[serde(rename = "ways")]
    fits: Vec<NamedFit>,
}

/// The report's fit with each renderer, and the same cost lowered by Levenberg-Marquardt on tangent steps.
fn fits(iterations: usize) -> Vec<NamedFit> {
    let report = FitOptions::preset(Preset::Report).with_iterations(iterations);
    let report = FitOptions { run_all: true, ..report };
    let with = |renderer: RendererKind| {
        NamedFit::new(&renderer.label().to_lowercase(), FitOptions { renderer, ..report.clone() })
    };
    let mended = FitOptions {
        parameters: Parameters::Tangent,
        method: Method::LevenbergMarquardt,
        damping: LM_DAMPING,
        ..report.clone()
    };
    let mended = NamedFit::new("capsule, tangent LM", mended);
    RendererKind::in_report_order().into_iter().map(with).chain([mended]).collect()
}

/// A curve has settled where this share of its whole fall is left.
const SETTLED: f64 = 1e-3;

/// The iteration after which no more than [`SETTLED`] of a fit's fall of cost is left.
fn settled_after(curve: &FitCurve) -> f64 {
    let costs = &curve.costs;
    let (start, end) = (costs.first().copied().unwrap_or(0.0), last(costs));
    let within = end + SETTLED * (start - end);
    costs.iter().rposition(|&cost| cost > within).map_or(0.0, |at| (at + 1) as f64)
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    ways: Vec<FromAllStarts>,
}

/// One fit from all starts.
#[derive(Debug, Serialize)]
struct FromAllStarts {
    name: String,
    /// Of the cost in percent of the start's, at the start and after every iteration.
    median_percent: Vec<f64>,
    median_joint_error_mm: Vec<f64>,
    /// Iterations after which the cost falls by no more than [`SETTLED`] of its fall, median.
    settled_after: f64,
    /// Starts that ended below [`GOOD_MM`].
    good: usize,
    curves: Vec<FitCurve>,
}

impl<const CAMERAS: usize> Experiment for UpperBody<CAMERAS> {
    const NAME: &'static str = if CAMERAS == 1 { "fig5.2" } else { "fig5.3" };
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let noise = self.starts.start_noise;
        ensure!(noise.angle_rad.is_finite() && noise.distance_m.is_finite(), "expected finite noise");
        check_least("starts", self.starts.starts, 1)?;
        self.fits = fits(self.iterations);
        let model = Arc::new(builtin::upper_body());
        let cameras = upper_body::cameras(self.cameras, self.size_px)?;
        let truth = upper_body::motion(&model, 0);
        let total = self.fits.len() * self.starts.starts;
        let mut ways = Vec::new();
        for NamedFit { name, fit } in &self.fits {
            let (simulation, ramp) = (self.simulation, fit.final_ramp());
            let see = |camera| scene::view(&model, &truth, camera, simulation, fit.renderer, ramp);
            let views = cameras.iter().map(see).collect::<Result<Vec<_>, _>>()?;
            let curve = |start: usize| {
                run.progress(ways.len() * self.starts.starts + start, total)?;
                let from = self.starts.from(&model, &truth, start);
                let name = format!("start {start}");
                FitCurve::of(&name, &model, &truth, views.clone(), &from, fit.clone(), run)
            };
            let curves = (0..self.starts.starts).map(curve).collect::<Result<Vec<_>>>()?;
            ways.push(FromAllStarts {
                name: name.clone(),
                median_percent: medians(curves.iter().map(FitCurve::percent_of_start)),
                median_joint_error_mm: medians(curves.iter().map(|curve| curve.joint_errors_mm.clone())),
                settled_after: median(&mut curves.iter().map(settled_after).collect::<Vec<_>>())
                    .unwrap_or(0.0),
                good: curves.iter().filter(|curve| curve.final_joint_error_mm() < GOOD_MM).count(),
                curves,
            });
        }
        Ok(Report { ways })
    }

    fn table(&self, report: &Report) -> String {
        let start = |fit: &&FromAllStarts| fit.median_joint_error_mm.first().copied().unwrap_or_default();
        Table::of(
            &report.ways,
            &[
                ("fit", &|fit| fit.name.clone()),
                ("% of start cost", &|fit| number(last(&fit.median_percent), 2)),
                ("joint error, mm: start", &|fit| number(start(fit), 1)),
                ("end", &|fit| number(last(&fit.median_joint_error_mm), 1)),
                ("settled after", &|fit| number(fit.settled_after, 0)),
                (&format!("below {GOOD_MM} mm"), &|fit| format!("{} of {}", fit.good, self.starts.starts)),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, FigureOrSheet)> {
        let cameras =
            if self.cameras == 1 { "one camera".to_owned() } else { format!("{} cameras", self.cameras) };
        let figure = |what: &str, label: &str, values: &dyn Fn(&FromAllStarts) -> Vec<f64>| {
            let fits = report.ways.iter().enumerate();
            FigureOrSheet::Figure(Figure {
                title: format!("Upper body: {what} per iteration"),
                subtitle: format!("{cameras}, {}, medians; data are Λ of the truth", self.starts.text()),
                x: Axis::linear("iteration"),
                y: Axis::log(label),
                lines: fits.map(|(style, fit)| Line::of_values(&fit.name, style, &values(fit))).collect(),
            })
        };
        let cost = figure("cost", "cost, % of the start", &|fit| fit.median_percent.clone());
        let joints = figure("joint error", "mean joint error, mm", &|fit| fit.median_joint_error_mm.clone());
        vec![(format!("{}-cost", Self::NAME), cost), (format!("{}-joints", Self::NAME), joints)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    fn run_small<const CAMERAS: usize>() -> Report {
        let starts = Starts::new(4, 10.0, 0.05);
        let mut small = UpperBody::<CAMERAS> { size_px: [96, 72], starts, iterations: 25, ..defaults() };
        small.run(&Run::hidden()).unwrap()
    }

    #[test]
    fn one_camera_lowers_the_cost_but_only_two_bring_the_joints_home() {
        let (one, two) = (run_small::<1>(), run_small::<2>());
        for (one, two) in one.ways.iter().zip(&two.ways) {
            // The same starts.
            assert_eq!(one.curves[0].joint_errors_mm[0], two.curves[0].joint_errors_mm[0]);
            assert!(last(&one.median_percent) < 20.0 && last(&two.median_percent) < 20.0, "{}", one.name);
            let [one_mm, two_mm] = [one, two].map(|way| last(&way.median_joint_error_mm));
            assert!(one_mm > 1.5 * two_mm, "{}: {one_mm} mm with one camera, {two_mm} mm with two", one.name);
        }
        assert!(last(&two.ways[3].median_joint_error_mm) < GOOD_MM);
    }

    #[test]
    fn no_starts_are_refused_and_a_stopped_run_says_so() {
        let mut none = UpperBody::<2> { starts: Starts::new(0, 10.0, 0.05), ..defaults() };
        let error = none.run(&Run::hidden()).unwrap_err().to_string();
        assert!(error.contains("`starts` is 0"), "{error}");
        let run = Run::hidden();
        run.cancel.cancel();
        assert!(defaults::<UpperBody<2>>().run(&run).unwrap_err().is::<crate::interrupt::Interrupted>());
    }
}
