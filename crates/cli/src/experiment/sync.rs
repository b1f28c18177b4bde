//! `backlit experiment sync`: clocks of cameras that are off, found from the motion of the silhouettes.

use std::path::PathBuf;

use backlit_lab::experiment::sync::{self, Options};
use backlit_plot::Figure;
use backlit_tracking::cancel::CancelToken;
use clap::Args;
use serde_json::json;

use super::arguments::OutputArguments;
use super::files;
use super::waiting::Waiting;
use crate::take_options;

/// What `backlit experiment sync` is told.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// A take whose cameras are synchronous, to be shifted by whole frames [default: simulated people]
    take: Option<PathBuf>,
    /// Frames that every other camera of a take is shifted by
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [0, 1, 7, -12, 20], allow_hyphen_values = true)]
    shifts: Vec<i64>,
    /// Draws of the clocks of simulated cameras
    #[arg(long, value_name = "N", default_value_t = 6)]
    trials: usize,
    /// Seed of clocks and noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    output: OutputArguments,
}

/// Its table says all.
const NO_PLOTS: [(String, Figure); 0] = [];

/// Runs the experiment, writes and prints.
///
/// # Errors
/// A take that cannot be read, files that cannot be written.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (cancel, waiting) = (CancelToken::new(), Waiting::new());
    let Some(take) = &arguments.take else {
        let options = Options { trials: arguments.trials, seed: arguments.seed, ..Options::default() };
        let report = sync::run(&options, &cancel, waiting.listener())?;
        return files::finish(&arguments.output, "sync", &options, &report, &NO_PLOTS, &sync::table(&report));
    };
    let footage = take_options::open(take)?;
    let report = sync::run_take(&footage, &arguments.shifts, &cancel, waiting.listener())?;
    let options = json!({"take": take, "shifts": arguments.shifts});
    files::finish(&arguments.output, "sync", &options, &report, &NO_PLOTS, &sync::table(&report))
}
