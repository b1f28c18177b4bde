//! `backlit experiment`: the report's experiments again. The numbers are the core's; here are words, files and plots.
//!
//! | file | holds |
//! |---|---|
//! | [`arguments`] | options that all experiments share |
//! | [`files`] | the files of an experiment, and the table on the screen |
//! | [`fig51`] | `backlit experiment fig5.1` |

pub mod arguments;
pub mod fig51;
pub mod files;

use clap::{Args, Subcommand};

const NOTES: &str = "\
Every experiment prints a table, and writes its numbers (NAME.json) and its plots (NAME.png) to --out. The same
options give the same numbers. docs/report.md has the report's figures beside ours.";

/// What `backlit experiment` is told.
#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub struct ExperimentArguments {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Debug, Subcommand)]
enum Experiment {
    /// One limb seen from the side: the cylinder never moves along its axis, capsule and sphere tree do
    #[command(name = "fig5.1")]
    Fig51(fig51::Arguments),
}

/// Runs the experiment.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub fn run(arguments: &ExperimentArguments) -> anyhow::Result<()> {
    match &arguments.experiment {
        Experiment::Fig51(arguments) => fig51::run(arguments),
    }
}
