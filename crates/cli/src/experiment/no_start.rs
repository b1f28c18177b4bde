//! `backlit experiment no-start`: single frames of a take without a start, by all sets of cameras.

use std::path::PathBuf;

use backlit_lab::experiment::no_start::{self, Group, Options, Report};
use backlit_plot::Figure;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::statistics::Statistics;
use clap::Args;

use super::arguments::OutputArguments;
use super::files;
use super::waiting::Waiting;
use crate::table::Table;
use crate::take_options::{self, PartArguments};

/// What `backlit experiment no-start` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Take: its folder or its take.toml. It needs reference keypoints
    take: PathBuf,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Numbers of cameras; all sets of so many are tried
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [2, 4])]
    sets_of: Vec<usize>,
    /// The person counts as found if the mean joint error is at most so much above that of a fit from the keypoints,
    /// millimetres
    #[arg(long, value_name = "MM", default_value_t = 25.0)]
    within_mm: f64,
    #[command(flatten)]
    part: PartArguments,
    #[command(flatten)]
    output: OutputArguments,
}

/// Its table says all.
const NO_PLOTS: [(String, Figure); 0] = [];

/// Runs the experiment, writes and prints.
///
/// # Errors
/// A take that cannot be read or has no keypoints, numbers of cameras that it does not have, files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let footage = take_options::open_with_model(&arguments.take, arguments.model.as_deref())?;
    anyhow::ensure!(arguments.part.cameras.is_none(), "--cameras: all sets are tried; ask for --sets-of");
    let options = Options {
        cameras: arguments.sets_of.clone(),
        frames: arguments.part.frames(footage.take())?,
        within_mm: arguments.within_mm,
    };
    let report = no_start::run(&footage, &options, &CancelToken::new(), Waiting::new().listener())?;
    files::finish(&arguments.output, "no-start", &options, &report, &NO_PLOTS, &table(&report))
}

fn table(report: &Report) -> String {
    let mut table =
        Table::new(["cameras", "found", "error, mm: median", "from keypoints", "s: mean", "longest"]);
    for group in &report.groups {
        let [mean, longest] = group.seconds;
        table.row([
            group.cameras.to_string(),
            format!("{} of {}", group.found, group.trials.len()),
            median(group.trials.iter().filter_map(|trial| trial.error_mm)),
            median(group.trials.iter().map(|trial| trial.from_keypoints_mm)),
            format!("{mean:.2}"),
            format!("{longest:.2}"),
        ]);
    }
    table.to_text() + &report.groups.iter().map(missed).collect::<String>()
}

/// The trials that did not find the person, one a line.
fn missed(group: &Group) -> String {
    let lines = group.trials.iter().filter(|trial| !trial.found).map(|trial| {
        let error = trial.error_mm.map_or_else(|| trial.doubts.join("; "), |mm| format!("{mm:.0} mm"));
        format!("\nmissed: frame {}, {}: {error}", trial.frame, trial.cameras.join(", "))
    });
    lines.collect()
}

fn median(values: impl Iterator<Item = f64>) -> String {
    let values: Vec<f64> = values.collect();
    Statistics::of(&values).map_or_else(|| "–".to_owned(), |all| format!("{:.1}", all.median))
}
