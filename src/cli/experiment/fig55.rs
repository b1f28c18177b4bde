//! `backlit experiment fig5.5` and `fig5.6`: the upper body followed through a simulated sequence.

use backlit_lab::experiment::fig55::{self, Options, Report, Spread, WayReport};
use backlit_tracking::cancel::CancelToken;
use backlit_ui::drawing::plot::{Axis, Figure, Line};
use clap::Args;

use super::arguments::{NoiseArguments, OutputArguments, StartArguments};
use super::files;
use super::waiting::Waiting;
use crate::cli::table::Table;

/// What `backlit experiment fig5.5` and `fig5.6` are told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    noise: NoiseArguments,
    /// Frames of the sequence
    #[arg(long, value_name = "N", default_value_t = 50)]
    frames: usize,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment on pictures of this size, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments, name: &str, size_px: [u64; 2]) -> anyhow::Result<()> {
    let mut options =
        Options { size_px, frames: arguments.frames, seed: arguments.start.seed, ..Options::default() };
    options.starts = arguments.start.starts.unwrap_or(options.starts);
    (options.angle_rad, options.distance_m) = arguments.noise.or(options.angle_rad, options.distance_m);
    let report = fig55::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    let conditions = format!(
        "{} × {} pixels, {} cameras, {} starts {:.0}° and {:.0} cm off, medians; 25 iterations a frame",
        size_px[0],
        size_px[1],
        options.cameras,
        options.starts,
        options.angle_rad.to_degrees(),
        100.0 * options.distance_m
    );
    let figures = [
        (format!("{name}-joints"), joint_figure(&report, &conditions)),
        (format!("{name}-overlap"), overlap_figure(&report, &conditions)),
    ];
    files::finish(&arguments.output, name, &options, &report, &figures, &table(&report))
}

fn table(report: &Report) -> String {
    let mut table =
        Table::new(["fit", "joint error, mm: mean", "median", "95 %", "max", "IoU", "lost frames"]);
    for way in &report.ways {
        let Spread { mean, median, p95, max } = way.joint_error_mm;
        let count = way.median_iou.len().max(1) as f64;
        table.row([
            way.name.clone(),
            format!("{mean:.1}"),
            format!("{median:.1}"),
            format!("{p95:.1}"),
            format!("{max:.1}"),
            format!("{:.3}", way.median_iou.iter().sum::<f64>() / count),
            way.lost.to_string(),
        ]);
    }
    table.to_text()
}

fn lines(report: &Report, values: impl Fn(&WayReport) -> &[f64]) -> Vec<Line> {
    let ways = report.ways.iter().enumerate();
    ways.map(|(style, way)| Line::of_values(&way.name, style, values(way))).collect()
}

fn joint_figure(report: &Report, conditions: &str) -> Figure {
    Figure {
        title: "Upper body followed: joint error per frame".to_owned(),
        subtitle: conditions.to_owned(),
        x: Axis::linear("frame"),
        y: Axis::log("mean joint error, mm"),
        lines: lines(report, |way| &way.median_joint_error_mm),
    }
}

fn overlap_figure(report: &Report, conditions: &str) -> Figure {
    Figure {
        title: "Upper body followed: overlap per frame".to_owned(),
        subtitle: conditions.to_owned(),
        x: Axis::linear("frame"),
        y: Axis::linear("intersection over union"),
        lines: lines(report, |way| &way.median_iou),
    }
}
