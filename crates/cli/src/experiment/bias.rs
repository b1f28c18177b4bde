//! `backlit experiment bias`: where fits go that begin at the truth.

use backlit_lab::experiment::bias::{self, Options, Report};
use backlit_plot::{Axis, Figure, Line};
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::{OutputArguments, PictureSize};
use super::files;
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment bias` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Numbers of cameras, at most 4
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4])]
    cameras: Vec<usize>,
    /// Size of the pictures, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "192x144")]
    size: PictureSize,
    /// Seed of the true poses
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// How many true poses, each a start of its own
    #[arg(long, value_name = "N", default_value_t = 10)]
    starts: usize,
    #[command(flatten)]
    output: OutputArguments,
}

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let options = Options {
        cameras: arguments.cameras.clone(),
        size_px: arguments.size.0,
        poses: arguments.starts,
        seed: arguments.seed,
        ..Options::default()
    };
    let report = bias::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    let figures = [("bias".to_owned(), figure(&report, &options))];
    files::finish(&arguments.output, "bias", &options, &report, &figures, &table(&report))
}

fn table(report: &Report) -> String {
    let mut table = Table::new(["ramp, data: cameras", "mean joint error, mm", "median", "max"]);
    for look in &report.looks {
        for bias in &look.biases {
            table.row([
                format!("{}: {}", look.name, bias.cameras),
                format!("{:.2}", bias.mean_mm),
                format!("{:.2}", bias.median_mm),
                format!("{:.2}", bias.max_mm),
            ]);
        }
    }
    table.to_text()
}

fn figure(report: &Report, options: &Options) -> Figure {
    let [width, height] = options.size_px;
    let lines = report.looks.iter().enumerate();
    Figure {
        title: "Bias of a ramp: where a fit ends that began at the truth".to_owned(),
        subtitle: format!("upper body, {width} × {height} pixels, mean of {} poses", options.poses),
        x: Axis::linear("cameras"),
        y: Axis::log("mean joint error, mm"),
        lines: lines
            .map(|(style, look)| Line {
                name: look.name.clone(),
                points: look.biases.iter().map(|bias| [bias.cameras as f64, bias.mean_mm]).collect(),
                style,
                ..Line::default()
            })
            .collect(),
    }
}
