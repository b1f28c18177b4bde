//! Fig. 5.4: the first frame of a sequence, iteration by iteration: D and Λ of each camera.

use std::sync::Arc;

use anyhow::Result;
use backlit_lab::experiment::Simulation;
use backlit_plot::FigureOrSheet;
use backlit_tracking::body::Pose;
use backlit_tracking::fit::Fit;
use clap::Args;
use serde::Serialize;

use super::arguments::{Starts, picture_size};
use super::sequence::{SequenceArguments, SequenceMethod, ViewPictures};
use super::{Experiment, Run};
use crate::output::number;
use crate::table::Table;

/// The iterations that the report shows.
const ITERATIONS: [usize; 4] = [0, 6, 10, 25];

/// One frame of a take, or of the simulated upper body, iteration by iteration: D and Λ of two cameras
#[derive(Debug, Args, Serialize)]
#[command(
    mut_arg("starts", |starts| starts.default_value("1").hide(true)),
    mut_arg("start_noise", |noise| noise.default_value("5deg,3cm"))
)]
pub(crate) struct OneFrame {
    /// A fit that has ended before shows its end.
    #[arg(skip = ITERATIONS.to_vec())]
    iterations: Vec<usize>,
    #[command(flatten)]
    #[serde(flatten)]
    start: Starts,
    #[arg(skip)]
    #[serde(rename = "ways")]
    methods: Vec<SequenceMethod>,
    /// Size of the pictures, pixels; portrait pictures of a take stay portrait
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = picture_size, default_value = "192x144")]
    #[serde(skip)]
    size: [u64; 2],
    #[command(flatten)]
    #[serde(flatten)]
    sequence: SequenceArguments,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    ways: Vec<Fig54Method>,
}

#[derive(Debug, Serialize)]
struct Fig54Method {
    name: String,
    shown: Vec<ShownIteration>,
}

#[derive(Debug, Serialize)]
struct ShownIteration {
    /// Iterations done: those asked for, or all that there were.
    iteration: usize,
    /// Root of the mean squared residual per pixel by the measure of its stage, grey levels.
    rms: f64,
    joint_error_mm: Option<f64>,
    #[serde(skip)]
    pictures: Vec<ViewPictures>,
}

impl Experiment for OneFrame {
    const NAME: &'static str = "fig5.4";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let sequence = self.sequence.open(self.size, 1)?;
        let masks = self.sequence.methods().into_iter().filter(|one| one.simulation == Simulation::Mask);
        self.methods = masks.take(2).collect();
        let (model, moment) = (&sequence.model, &sequence.moments[0]);
        let from = self.start.from(model, &sequence.start, 0);
        let mut ways = Vec::new();
        for method in &self.methods {
            let Some(views) = method.views(&sequence, 0)? else { continue };
            let mut fit = Fit::new(Arc::clone(model), views.clone(), from.clone(), method.fit.clone())?;
            let rms = fit.initial_rms;
            let summary = fit.run(&run.cancel, |_| {});
            run.check()?;
            let show = |&iteration: &usize| {
                let iteration = iteration.min(summary.iterations.len());
                let record = iteration.checked_sub(1).map(|index| &summary.iterations[index]);
                let (pose, stage, rms): (&Pose, usize, f64) =
                    record.map_or((&from, 0, rms), |record| (&record.point, record.stage, record.rms));
                let stage = &fit.options.stages[stage];
                let pictures = ViewPictures::of_stage(model, pose, &views, stage, method.fit.renderer);
                let joint_error_mm = moment.joint_error_mm(model, pose);
                ShownIteration { iteration, rms, joint_error_mm, pictures }
            };
            ways.push(Fig54Method {
                name: method.name.clone(),
                shown: self.iterations.iter().map(show).collect(),
            });
        }
        Ok(Report { ways })
    }

    fn table(&self, report: &Report) -> String {
        Table::of(
            report.ways.iter().flat_map(|method| method.shown.iter().map(move |shown| (method, shown))),
            &[
                ("fit", &|(method, _)| method.name.clone()),
                ("iteration", &|(_, shown)| shown.iteration.to_string()),
                ("RMS, grey levels", &|(_, shown)| number(shown.rms, 1)),
                ("joint error, mm", &|(_, shown)| number(shown.joint_error_mm, 1)),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, FigureOrSheet)> {
        let sheet = |(method, found): (&SequenceMethod, &Fig54Method)| {
            let column = |shown: &ShownIteration| {
                let error = shown.joint_error_mm.map_or_else(String::new, |mm| format!(", {mm:.0} mm"));
                (format!("iteration {}{error}", shown.iteration), shown.pictures.clone())
            };
            let title = format!("One frame, iteration by iteration: {}", found.name);
            let columns = found.shown.iter().map(column).collect();
            let sheet = self.sequence.conditions.sheet(title, columns);
            (format!("fig5.4-{}", method.short_name()), FigureOrSheet::Sheet(sheet))
        };
        self.methods.iter().zip(&report.ways).map(sheet).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::arguments::defaults;

    #[test]
    fn iterations_come_nearer_and_are_drawn() {
        let mut small = OneFrame { size: [96, 72], ..defaults() };
        let report = small.run(&Run::hidden()).unwrap();
        for method in &report.ways {
            let [first, .., last] = &method.shown[..] else { panic!("four columns") };
            assert_eq!((first.iteration, first.pictures.len()), (0, 2));
            let [before, after] = [first, last].map(|shown| shown.joint_error_mm.unwrap());
            assert!(after < before, "{}: {before} mm became {after}", method.name);
            let ViewPictures { data, prediction, .. } = &last.pictures[1];
            assert_eq!((data.dimensions(), prediction.dimensions()), ((96, 72), (96, 72)));
            let wrong = data.pixels().zip(prediction.pixels());
            let wrong = wrong.filter(|(d, l)| d[0].abs_diff(l[0]) > 128).count();
            assert!(wrong < 60, "{}: {wrong} pixels", method.name);
        }
    }
}
