//! Fig. 5.1: one limb seen from the side, started off along its own axis, with three renderers.
//!
//! Moving along the axis changes only the ends of the limb's silhouette. A capsule's round ends and the spheres
//! of a sphere tree pull it home. A cylinder's flat cap, seen from the side, covers no pixel, and the distance to
//! its axis does not depend on where along the axis the ray passes: the pixels at the ends have no gradient, and
//! the fit stays where it began. A camera that is near looks at the caps from the front a little; there the
//! cylinder feels them.
//!
//! What is fitted to is a capsule's grey levels for all three, or each renderer's own, for which the truth costs nothing.

use std::sync::Arc;

use anyhow::{Result, ensure};
use backlit_lab::experiment::{Simulation, scene};
use backlit_lab::synthetic::single_limb::{OFFSET_M, camera, start, truth};
use backlit_plot::{Axis, Figure, FigureOrSheet, Line};
use backlit_tracking::body::builtin;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::render::RendererKind;
use clap::Args;
use serde::Serialize;

use super::arguments::SIMULATIONS;
use super::measures::FitCurve;
use super::{Experiment, Run};
use crate::fit_options::one_of;
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;

/// As many as the report shows.
const ITERATIONS: usize = 60;

/// One limb seen from the side: the cylinder never moves along its axis, capsule and sphere tree do
#[derive(Debug, Args, Serialize)]
pub(crate) struct SingleLimb {
    /// Distances of the camera, metres; the limb is as large in all pictures [0.3 to 1000]
    #[arg(long = "distance", value_name = "M,…", value_delimiter = ',', default_values_t = [10.0, 0.8], value_parser = within(0.3..=1000.0_f64))]
    distances_m: Vec<f64>,
    /// How far along its axis the limb starts from the truth, metres [-10 to 10]
    #[arg(long = "offset", value_name = "M", default_value_t = OFFSET_M, value_parser = within(-10.0..=10.0_f64))]
    offset_m: f64,
    #[arg(skip = [192, 144])]
    size_px: [u64; 2],
    /// What the camera sees
    #[arg(long = "data", value_parser = one_of(SIMULATIONS), default_value = "prediction")]
    simulation: Simulation,
    /// Its renderer is replaced by each of the three.
    #[arg(skip = FitOptions { run_all: true, ..FitOptions::preset(Preset::Report).with_iterations(ITERATIONS) })]
    fit: FitOptions,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    parts: Vec<Distance>,
}

/// One distance of the camera, and one kind of data.
#[derive(Debug, Serialize)]
struct Distance {
    distance_m: f64,
    data: Source,
    /// One a renderer, named after it.
    curves: Vec<FitCurve>,
}

/// What the camera's data are made with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Source {
    Capsule,
    OwnRenderer,
    Mask,
}

impl Source {
    fn label(self) -> &'static str {
        match self {
            Self::Capsule => "a capsule's grey levels",
            Self::OwnRenderer => "its own grey levels",
            Self::Mask => "a mask",
        }
    }
}

impl Experiment for SingleLimb {
    const NAME: &'static str = "fig5.1";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        ensure!(
            self.offset_m.is_finite(),
            "`offset_m` is {}; expected a finite number of metres",
            self.offset_m
        );
        let model = Arc::new(builtin::single_limb());
        let (truth, start) = (truth(), start(self.offset_m));
        let mut parts = Vec::new();
        for &distance_m in &self.distances_m {
            let camera = camera(distance_m, self.size_px)?;
            let ramp = self.fit.final_ramp();
            let sources: &[Source] = match self.simulation {
                Simulation::Prediction => &[Source::Capsule, Source::OwnRenderer],
                Simulation::Mask => &[Source::Mask],
            };
            for &data in sources {
                let curve = |renderer: RendererKind| {
                    let drawn = if data == Source::OwnRenderer { renderer } else { RendererKind::Capsule };
                    let view = scene::view(&model, &truth, &camera, self.simulation, drawn, ramp)?;
                    let fit = FitOptions { renderer, ..self.fit.clone() };
                    FitCurve::of(renderer.name(), &model, &truth, vec![view], &start, fit, run)
                };
                let curves = RendererKind::in_report_order().into_iter().map(curve).collect::<Result<_>>()?;
                parts.push(Distance { distance_m, data, curves });
            }
        }
        Ok(Report { parts })
    }

    fn table(&self, report: &Report) -> String {
        Table::of(
            report.parts.iter().flat_map(|part| part.curves.iter().map(move |curve| (part, curve))),
            &[
                ("camera, renderer", &|(part, curve)| format!("{} m, {}", part.distance_m, curve.name)),
                ("data", &|(part, _)| part.data.label().to_owned()),
                ("start cost", &|(_, curve)| number(curve.costs[0], 0)),
                ("end cost", &|(_, curve)| number(curve.costs.last().copied(), 0)),
                ("% of start after 25", &|(_, curve)| number(curve.percent_of_start().get(25).copied(), 2)),
                ("after 60", &|(_, curve)| number(curve.final_percent(), 2)),
                ("joint error, mm", &|(_, curve)| number(curve.final_joint_error_mm(), 1)),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, FigureOrSheet)> {
        let figure = |Distance { distance_m, data, curves }: &Distance| {
            let line = |(style, curve): (_, &FitCurve)| {
                Line::of_values(&curve.name, style, &curve.percent_of_start())
            };
            let figure = Figure {
                title: "One limb seen from the side, started off along its axis".to_owned(),
                subtitle: format!("Report 2004, {}; the camera is {distance_m} m away", data.label()),
                x: Axis::linear("iteration"),
                y: Axis::log("cost, % of the start").within(0.01, 150.0),
                lines: curves.iter().enumerate().map(line).collect(),
            };
            let own = if *data == Source::OwnRenderer { "-own" } else { "" };
            (format!("fig5.1-{distance_m}m{own}"), FigureOrSheet::Figure(figure))
        };
        report.parts.iter().map(figure).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    #[test]
    fn from_afar_the_cylinder_stays_and_the_others_come_home_and_near_by_it_feels_its_caps() {
        let report = defaults::<SingleLimb>().run(&Run::hidden()).unwrap();
        let percent =
            |part: usize| report.parts[part].curves.iter().map(FitCurve::final_percent).collect::<Vec<_>>();
        let [far, own, near, _] = [0, 1, 2, 3].map(percent);
        // It stays for as long as a frame's fit takes; later it turns until its cap is seen.
        let stays = |part: usize| report.parts[part].curves[0].percent_of_start()[25];
        assert!(stays(0) >= 99.0 && stays(1) >= 99.0 && far[0] > 80.0, "{far:?}");
        assert!(far[1] < 5.0 && far[2] < 5.0, "{far:?}");
        assert!(report.parts[0].curves[1].final_joint_error_mm() < 10.0);
        assert!(near[0] < 90.0, "{near:?}");
        // Data of its own leave a renderer no trace where it arrives.
        assert_eq!(report.parts[1].data, Source::OwnRenderer);
        assert!(own[1] < 1e-4 && own[2] < 1e-4 && far[2] > 0.01, "{own:?}");
    }
}
