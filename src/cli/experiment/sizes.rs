//! `backlit experiment sizes`: the sizes of people of several builds, from hard silhouettes.

use backlit_lab::experiment::sizes::{self, Options, PersonReport, Report};
use backlit_tracking::body::SizeKind;
use backlit_tracking::cancel::CancelToken;
use backlit_ui::drawing::plot::Figure;
use clap::Args;

use super::arguments::OutputArguments;
use super::files;
use super::waiting::Waiting;
use crate::cli::table::Table;

/// What `backlit experiment sizes` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Moments of the built-in movement (its frames, 0 to 59) to look at
    #[arg(long, value_name = "K,…", value_delimiter = ',')]
    moments: Option<Vec<f64>>,
    /// Seed of the poses that the fits begin with
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
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
    let defaults = Options::default();
    let moments = arguments.moments.clone().unwrap_or(defaults.moments);
    let options = Options { moments, seed: arguments.seed, ..Options::default() };
    let report = sizes::run(&options, &CancelToken::new(), Waiting::new().listener())?;
    files::finish(&arguments.output, "sizes", &options, &report, &NO_PLOTS, &table(&report))
}

fn table(report: &Report) -> String {
    let mut table = Table::new([
        "error, mm",
        "lengths: mean",
        "worst seen",
        "worst",
        "radii: mean",
        "worst seen",
        "worst",
        "joints",
        "IoU",
    ]);
    for person in &report.people {
        let worst = |kind, seen_only| {
            person
                .worst(kind, seen_only)
                .map_or_else(|| "–".to_owned(), |size| format!("{:.1} {}", size.error_mm().abs(), size.name))
        };
        let mean = |person: &PersonReport, kind| format!("{:.1}", person.mean_mm(kind));
        table.row([
            person.name.to_owned(),
            mean(person, SizeKind::Length),
            worst(SizeKind::Length, true),
            worst(SizeKind::Length, false),
            mean(person, SizeKind::Radius),
            worst(SizeKind::Radius, true),
            worst(SizeKind::Radius, false),
            format!("{:.1}", person.joint_error_mm),
            person.iou[1].map_or_else(|| "–".to_owned(), |iou| format!("{iou:.3}")),
        ]);
    }
    table.to_text() + "\nSeen: sizes that the fit does not mark as held by the proportions alone.\n"
}
