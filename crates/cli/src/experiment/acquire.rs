//! `backlit experiment acquire`: first bodies grown from nothing known, beside fitted ones.

use std::path::PathBuf;

use backlit_formats::Take;
use backlit_lab::experiment::acquire::{self, Options, Report, footage};
use backlit_plot::Figure;
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use super::arguments::OutputArguments;
use super::files;
use super::waiting::listener;
use crate::table::Table;
use crate::take_options;

/// First bodies of people of several builds, grown with nothing known, beside fitted ones; or of a take's person
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// How many of the six builds
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=6))]
    people: u32,
    /// Moments of the built-in movement (its frames, 0 to 59); in the first, nothing is known of the person
    #[arg(long, value_name = "K,…", value_delimiter = ',')]
    moments: Option<Vec<f64>>,
    /// Frames that are tracked with every body
    #[arg(long, value_name = "N", default_value_t = 30)]
    tracked: u32,
    /// Seed of the poses that fits of sizes begin with
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Take whose person is acquired and tracked instead of simulated ones; sizes are compared with those of its own body
    #[arg(long, value_name = "TAKE", conflicts_with_all = ["people", "moments", "tracked", "seed"])]
    take: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArguments,
}

/// Its table says all.
const NO_PLOTS: [(String, Figure); 0] = [];

/// Runs the experiment, writes and prints.
///
/// # Errors
/// Returns an error if an option is out of range, or if a file cannot be read or written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (cancel, listener) = (CancelToken::new(), listener());
    if let Some(take) = &arguments.take {
        let by_hand = Take::open(take)?;
        let footage = take_options::open_with_model(take, Some("full_body"))?;
        let options = footage::Options::default();
        let report = footage::run(&footage, by_hand.model(), &options, &cancel, listener)?;
        return files::finish(&arguments.output, "acquire", &options, &report, &NO_PLOTS, &table(&report));
    }
    let defaults = Options::default();
    let options = Options {
        people: arguments.people as usize,
        moments: arguments.moments.clone().unwrap_or(defaults.moments),
        tracked: arguments.tracked as usize,
        seed: arguments.seed,
    };
    let report = acquire::run(&options, &cancel, listener)?;
    files::finish(&arguments.output, "acquire", &options, &report, &NO_PLOTS, &table(&report))
}

fn table(report: &Report) -> String {
    let mut table =
        Table::new(["person: way", "s", "lengths, mm", "radii, mm", "IoU", "joints, mm", "tracked, mm"]);
    let mut failures = String::new();
    for row in &report.rows {
        if let Some(failure) = &row.failure {
            failures += &format!("\n{}, {}: {failure}", row.person, row.method.label());
        }
        table.row([
            format!("{}: {}", row.person, row.method.label()),
            format!("{:.2}", row.seconds),
            format!("{:.1}", row.length_mm),
            format!("{:.1}", row.radius_mm),
            format!("{:.3}", row.iou),
            format!("{:.1}", row.joints_mm),
            row.track_mm.map_or_else(|| "–".to_owned(), |mm| format!("{mm:.1}")),
        ]);
    }
    table.to_text() + &failures
}
