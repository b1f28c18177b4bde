//! `backlit experiment fig5.4`: the first frame of a sequence, iteration by iteration.

use backlit_lab::experiment::fig54::{self, ITERATIONS, Options, Report, WayReport};
use backlit_lab::experiment::{Simulation, fig55};
use backlit_plot::Sheet;
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::{OutputArguments, PictureSize, StartArguments};
use super::files;
use super::sequence::{Conditions, SequenceArguments, legend, rows, short_name};
use crate::table::Table;

/// What `backlit experiment fig5.4` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    sequence: SequenceArguments,
    /// Size of the pictures, pixels; portrait pictures of a take stay portrait
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "192x144")]
    size: PictureSize,
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be read or written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let sequence = arguments.sequence.sequence(arguments.size.0, 1)?;
    let defaults = fig55::Options::default();
    let (_, angle_rad, distance_m) = arguments.start.or(1, defaults.angle_rad, defaults.distance_m);
    let mut ways = arguments.sequence.smoothed(defaults.ways);
    ways.retain(|way| way.simulation == Simulation::Mask);
    ways.truncate(2);
    let options =
        Options { iterations: ITERATIONS.to_vec(), seed: arguments.start.seed, angle_rad, distance_m, ways };
    let report = fig54::run(&options, &sequence, &CancelToken::new())?;
    let conditions = Conditions::of(&options, &sequence);
    let sheet = |way: &WayReport| {
        let looks: Vec<_> = way.shown.iter().map(|shown| shown.looks.clone()).collect();
        let column = |shown: &fig54::Shown| {
            let error = shown.joint_error_mm.map_or_else(String::new, |mm| format!(", {mm:.0} mm"));
            format!("iteration {}{error}", shown.iteration)
        };
        let sheet = Sheet {
            title: format!("One frame, iteration by iteration: {}", way.name),
            subtitle: conditions.text() + legend(&looks),
            columns: way.shown.iter().map(column).collect(),
            rows: rows(&conditions.cameras, &looks),
        };
        (format!("fig5.4-{}", short_name(&way.name)), sheet)
    };
    let sheets: Vec<_> = report.ways.iter().map(sheet).collect();
    files::finish(&arguments.output, "fig5.4", &conditions, &report, &sheets, &table(&report))
}

fn table(report: &Report) -> String {
    let mut table = Table::new(["fit", "iteration", "RMS, grey levels", "joint error, mm"]);
    for way in &report.ways {
        for shown in &way.shown {
            table.row([
                way.name.clone(),
                shown.iteration.to_string(),
                format!("{:.1}", shown.rms),
                shown.joint_error_mm.map_or_else(|| "–".to_owned(), |mm| format!("{mm:.1}")),
            ]);
        }
    }
    table.to_text()
}
