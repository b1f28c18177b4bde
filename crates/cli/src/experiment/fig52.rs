//! `backlit experiment fig5.2` and `fig5.3`: the upper body from many starts, before one camera and before two.

use backlit_lab::experiment::fig52::{self, GOOD_MM, Options, Report, WayReport};
use backlit_plot::{Axis, Figure, Line};
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::{DataWord, OutputArguments, StartArguments};
use super::files;
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment fig5.2` and `fig5.3` are told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    start: StartArguments,
    /// What the cameras see
    #[arg(long, value_enum, default_value_t = DataWord::Prediction)]
    data: DataWord,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment with so many cameras, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments, name: &str, cameras: usize) -> anyhow::Result<()> {
    let mut options = Options {
        cameras,
        seed: arguments.start.seed,
        simulation: arguments.data.into(),
        ..Options::default()
    };
    (options.starts, options.angle_rad, options.distance_m) =
        arguments.start.or(options.starts, options.angle_rad, options.distance_m);
    let report = fig52::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    let conditions = format!(
        "{}, {} starts {:.0}° and {:.0} cm off, medians; data are Λ of the truth",
        if cameras == 1 { "one camera".to_owned() } else { format!("{cameras} cameras") },
        options.starts,
        options.angle_rad.to_degrees(),
        100.0 * options.distance_m
    );
    let figures = [
        (format!("{name}-cost"), cost_figure(&report, &conditions)),
        (format!("{name}-joints"), joint_figure(&report, &conditions)),
    ];
    files::finish(&arguments.output, name, &options, &report, &figures, &table(&report, options.starts))
}

fn table(report: &Report, starts: usize) -> String {
    let good = format!("below {GOOD_MM} mm");
    let mut table = Table::new(["fit", "% of start cost", "joint error, mm: start", "end", &good]);
    for way in &report.ways {
        let last = |list: &[f64]| list.last().copied().unwrap_or_default();
        let first = way.median_joint_error_mm.first().copied().unwrap_or_default();
        table.row([
            way.name.clone(),
            format!("{:.2}", last(&way.median_percent)),
            format!("{first:.1}"),
            format!("{:.1}", last(&way.median_joint_error_mm)),
            format!("{} of {starts}", way.good),
        ]);
    }
    table.to_text()
}

fn lines(report: &Report, values: impl Fn(&WayReport) -> &[f64]) -> Vec<Line> {
    let ways = report.ways.iter().enumerate();
    ways.map(|(style, way)| Line::of_values(&way.name, style, values(way))).collect()
}

fn cost_figure(report: &Report, conditions: &str) -> Figure {
    Figure {
        title: "Upper body: cost per iteration".to_owned(),
        subtitle: conditions.to_owned(),
        x: Axis::linear("iteration"),
        y: Axis::log("cost, % of the start"),
        lines: lines(report, |way| &way.median_percent),
    }
}

fn joint_figure(report: &Report, conditions: &str) -> Figure {
    Figure {
        title: "Upper body: joint error per iteration".to_owned(),
        subtitle: conditions.to_owned(),
        x: Axis::linear("iteration"),
        y: Axis::log("mean joint error, mm"),
        lines: lines(report, |way| &way.median_joint_error_mm),
    }
}
