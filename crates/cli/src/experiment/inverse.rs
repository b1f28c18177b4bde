//! `backlit experiment inverse`: (4.10) as written, the pseudo-inverse, and dampings.

use backlit_lab::experiment::fig52::GOOD_MM;
use backlit_lab::experiment::inverse::{self, Options, Report};
use backlit_plot::Figure;
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::{DataWord, OutputArguments, StartArguments};
use super::files;
use super::waiting::Waiting;
use crate::table::Table;

/// What `backlit experiment inverse` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    start: StartArguments,
    #[arg(long, value_name = "N", default_value_t = 2)]
    cameras: usize,
    /// What the cameras see
    #[arg(long, value_enum, default_value_t = DataWord::Prediction)]
    data: DataWord,
    #[command(flatten)]
    output: OutputArguments,
}

/// Its table says all.
const NO_PLOTS: [(String, Figure); 0] = [];

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut options = Options {
        cameras: arguments.cameras,
        seed: arguments.start.seed,
        simulation: arguments.data.into(),
        ..Options::default()
    };
    (options.starts, options.angle_rad, options.distance_m) =
        arguments.start.or(options.starts, options.angle_rad, options.distance_m);
    let report = inverse::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    files::finish(&arguments.output, "inverse", &options, &report, &NO_PLOTS, &table(&report, &options))
}

fn table(report: &Report, options: &Options) -> String {
    let good = format!("ends below {GOOD_MM} mm");
    let titles =
        ["step", "first step's length", "steps that raise the cost", "broken off", "median end, mm", &good];
    let mut table = Table::new(titles);
    for row in &report.rows {
        let [raised, steps] = row.raised;
        table.row([
            row.inverse.name(),
            format!("{:.2e}", row.first_step),
            format!("{:.1} %", 100.0 * raised as f64 / steps.max(1) as f64),
            format!("{} of {}", row.broken, options.starts),
            format!("{:.2}", row.median_mm),
            format!("{} of {}", row.good, options.starts),
        ]);
    }
    table.to_text()
}
