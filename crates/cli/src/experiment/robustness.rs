//! `backlit experiment robustness`: what goes wrong with a fit, and by how much.

use std::mem::discriminant;

use backlit_lab::experiment::robustness::{self, Options, Report};
use backlit_plot::{Axis, Figure, Line};
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::{OutputArguments, StartArguments};
use super::files;
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment robustness` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    start: StartArguments,
    /// Moments of the built-in movement (its frames, 0 to 59) to look at
    #[arg(long, value_name = "K,…", value_delimiter = ',')]
    moments: Option<Vec<f64>>,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut options = Options { seed: arguments.start.seed, ..Options::default() };
    options.moments = arguments.moments.clone().unwrap_or(options.moments);
    (options.starts, options.angle_rad, options.distance_m) =
        arguments.start.or(options.starts, options.angle_rad, options.distance_m);
    let report = robustness::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    let figure = Figure {
        title: "Full body, one thing wrong at a time: mean joint error".to_owned(),
        subtitle: format!(
            "four cameras of {} × {} pixels, {} moments, {} starts each; rows are the table's",
            options.size_px[0],
            options.size_px[1],
            options.moments.len(),
            options.starts
        ),
        x: Axis::linear("row of the table"),
        y: Axis::log("mean joint error, mm"),
        lines: lines(&options, &report),
    };
    let figures = [("robustness".to_owned(), figure)];
    files::finish(&arguments.output, "robustness", &options, &report, &figures, &table(&options, &report))
}

/// One curve a way, with gaps between one kind of trouble and the next.
fn lines(options: &Options, report: &Report) -> Vec<Line> {
    let ways = options.ways.iter().enumerate();
    ways.map(|(style, way)| {
        let mut points = Vec::new();
        let mut before = None;
        let cases = report.cases.iter().filter(|case| case.way == way.name);
        for (row, case) in cases.enumerate() {
            let kind = discriminant(&case.trouble);
            if before.is_some_and(|before| before != kind) {
                points.push([row as f64 + 0.5, f64::NAN]);
            }
            before = Some(kind);
            points.push([row as f64 + 1.0, case.mean_mm]);
        }
        Line::of_points(&way.name, style, points)
    })
    .collect()
}

fn table(options: &Options, report: &Report) -> String {
    let mut table = Table::new(["what is wrong", "way", "joint error, mm: mean", "95 %", "max", "IoU"]);
    for (index, case) in report.cases.iter().enumerate() {
        let row = index / options.ways.len().max(1) + 1;
        table.row([
            format!("{row:2} {}", case.trouble.label()),
            case.way.clone(),
            format!("{:.1}", case.mean_mm),
            format!("{:.1}", case.p95_mm),
            format!("{:.0}", case.max_mm),
            case.iou.map_or_else(|| "–".to_owned(), |iou| format!("{iou:.3}")),
        ]);
    }
    table.to_text()
}
