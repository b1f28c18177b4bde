//! `backlit experiment`: measurements on data of known truth, most of them figures of the report.
//!
//! An experiment is one file, listed in [`ExperimentCommand`]. Its options are a struct: the command line fills it in, and the file
//! with the numbers keeps it. [`Experiment::run`] measures; [`Experiment::table`] and [`Experiment::pictures`] show the report.
//! [`Experiment::perform`] does the rest: progress, Ctrl+C, files, the screen.

mod acquire;
mod arguments;
mod basin;
mod begin;
mod faults;
mod fig51;
mod fig52;
mod fig54;
mod fig55;
mod footage;
mod frame_basin;
mod keypoint_frame;
mod measures;
mod planned_cameras;
mod refinement;
mod sequence;
mod sizes;
mod sync;
mod track;
mod trust;

use anyhow::{Context, ensure};
use backlit_plot::{AsPicture, FigureOrSheet, png};
use backlit_tracking::cancel::CancelToken;
use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use self::arguments::OutputArguments;
use crate::interrupt::{self, Interrupted};

/// A measurement. Its fields are its options.
pub(crate) trait Experiment: Serialize {
    /// What it is called on the command line and in its files.
    const NAME: &'static str;
    /// What was measured.
    type Report: Serialize;

    /// Measures. Options that are known only now are filled in.
    ///
    /// # Errors
    /// An option is out of range, a file cannot be read, or Ctrl+C was pressed.
    fn run(&mut self, run: &Run) -> anyhow::Result<Self::Report>;

    /// The report in words and numbers.
    fn table(&self, report: &Self::Report) -> String;

    /// The report in pictures, each with the name of its file.
    fn pictures(&self, _report: &Self::Report) -> Vec<(String, FigureOrSheet)> {
        Vec::new()
    }

    /// What `--json` prints: the file with the numbers.
    ///
    /// # Errors
    /// The report cannot be written as JSON.
    fn printed(&self, _report: &Self::Report, numbers: &str) -> anyhow::Result<String> {
        Ok(numbers.to_owned())
    }

    /// Runs it, writes its numbers to `NAME.json` and its pictures to their files, and prints.
    ///
    /// # Errors
    /// It cannot run, or a file cannot be written.
    fn perform(&mut self, output: &OutputArguments) -> anyhow::Result<()>
    where
        Self: Sized,
    {
        let run = Run::listening()?;
        let report = self.run(&run)?;
        run.end()?;
        let document = Document { format: FORMAT, experiment: Self::NAME, options: self, report: &report };
        let numbers = serde_json::to_string_pretty(&document).context("the numbers")? + "\n";
        let mut files = vec![(format!("{}.json", Self::NAME), numbers.clone().into_bytes())];
        for (name, picture) in self.pictures(&report) {
            files.push((format!("{name}.png"), png(picture.picture(output.theme))?));
        }
        output.finish(files, &self.printed(&report, &numbers)?, &self.table(&report))
    }
}

/// Name and version of the files with the numbers.
const FORMAT: &str = "backlit-experiment 1";

/// An experiment's file.
#[derive(Debug, Serialize)]
struct Document<'a, O, R> {
    format: &'static str,
    experiment: &'a str,
    options: &'a O,
    report: &'a R,
}

/// A run of an experiment: how far it is, and whether it is to stop.
#[derive(Debug)]
pub(crate) struct Run {
    /// What fits listen to.
    pub(crate) cancel: CancelToken,
    bar: ProgressBar,
}

impl Run {
    /// A bar on the terminal that waits for the first number, and a token that Ctrl+C cancels.
    ///
    /// # Errors
    /// Ctrl+C cannot be listened to.
    pub(crate) fn listening() -> anyhow::Result<Self> {
        let bar = ProgressBar::new(1);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} fits, {eta} left") {
            bar.set_style(style);
        }
        Ok(Self { cancel: interrupt::listen()?, bar })
    }

    /// Takes the bar away.
    ///
    /// # Errors
    /// Ctrl+C was pressed.
    pub(crate) fn end(&self) -> Result<(), Interrupted> {
        self.bar.finish_and_clear();
        self.check()
    }

    /// Tells that this many of all are done.
    ///
    /// # Errors
    /// Ctrl+C was pressed.
    pub(crate) fn progress(&self, done: usize, total: usize) -> Result<(), Interrupted> {
        self.bar.set_length(total as u64);
        self.bar.set_position(done as u64);
        self.check()
    }

    /// # Errors
    /// Ctrl+C was pressed: what fits have found since is worth nothing.
    pub(crate) fn check(&self) -> Result<(), Interrupted> {
        if self.cancel.is_cancelled() { Err(Interrupted) } else { Ok(()) }
    }

    #[cfg(test)]
    pub(crate) fn hidden() -> Self {
        Self { cancel: CancelToken::new(), bar: ProgressBar::hidden() }
    }
}

/// Refuses an option that is too small.
///
/// # Errors
/// It is less than `least`.
pub(crate) fn check_least(option: &str, value: usize, least: usize) -> anyhow::Result<()> {
    ensure!(value >= least, "`{option}` is {value}; expected {least} or more");
    Ok(())
}

// An experiment's options, and where its files go. A doc comment would be the help of every experiment.
#[derive(Debug, Args)]
struct WithOutput<E: Args> {
    #[command(flatten)]
    experiment: E,
    #[command(flatten)]
    output: OutputArguments,
}

impl<E: Experiment + Args> WithOutput<E> {
    fn run(mut self) -> anyhow::Result<()> {
        self.experiment.perform(&self.output)
    }
}

/// All experiments, in the order of the help. The documentation of their arguments is their help.
#[derive(Debug, Subcommand)]
enum ExperimentCommand {
    #[command(name = fig51::SingleLimb::NAME)]
    SingleLimb(WithOutput<fig51::SingleLimb>),
    #[command(name = fig52::UpperBody::<1>::NAME)]
    BeforeOneCamera(WithOutput<fig52::UpperBody<1>>),
    #[command(name = fig52::UpperBody::<2>::NAME)]
    BeforeTwoCameras(WithOutput<fig52::UpperBody<2>>),
    #[command(name = fig54::OneFrame::NAME)]
    OneFrame(WithOutput<fig54::OneFrame>),
    #[command(name = fig55::Followed::<192, 144>::NAME)]
    Followed(WithOutput<fig55::Followed<192, 144>>),
    #[command(name = fig55::Followed::<48, 36>::NAME)]
    FollowedSmall(WithOutput<fig55::Followed<48, 36>>),
    Sizes(WithOutput<sizes::OwnSizes>),
    Track(WithOutput<track::Speeds>),
    Basin(Box<basin::Arguments>),
    Acquire(Box<acquire::Arguments>),
    #[command(name = faults::CalibrationFaults::NAME)]
    CalibrationFaults(WithOutput<faults::CalibrationFaults>),
    Begin(Box<begin::Arguments>),
    Footage(Box<footage::Arguments>),
    #[command(name = planned_cameras::PlannedCameras::NAME)]
    CameraPlan(WithOutput<planned_cameras::PlannedCameras>),
    #[command(name = refinement::RefinedRigs::NAME)]
    RefineCameras(WithOutput<refinement::RefinedRigs>),
    Sync(WithOutput<sync::ShiftedTake>),
    Trust(WithOutput<trust::Trust>),
}

const AFTER_HELP: &str = "\
Every experiment prints a table, and writes its numbers (NAME.json) and its plots (NAME.png) to --out. The \
same options give the same numbers. docs/report.md has the report's figures beside ours.";

/// What `backlit experiment` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    #[command(subcommand)]
    chosen: ExperimentCommand,
}

/// Runs the experiment.
///
/// # Errors
/// An option is out of range, a file cannot be read or written, or Ctrl+C was pressed.
pub(crate) fn run(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.chosen {
        ExperimentCommand::SingleLimb(chosen) => chosen.run(),
        ExperimentCommand::BeforeOneCamera(chosen) => chosen.run(),
        ExperimentCommand::BeforeTwoCameras(chosen) => chosen.run(),
        ExperimentCommand::OneFrame(chosen) => chosen.run(),
        ExperimentCommand::Followed(chosen) => chosen.run(),
        ExperimentCommand::FollowedSmall(chosen) => chosen.run(),
        ExperimentCommand::Sizes(chosen) => chosen.run(),
        ExperimentCommand::Track(chosen) => chosen.run(),
        ExperimentCommand::Basin(chosen) => chosen.run(),
        ExperimentCommand::Acquire(chosen) => chosen.run(),
        ExperimentCommand::CalibrationFaults(chosen) => chosen.run(),
        ExperimentCommand::Begin(chosen) => chosen.run(),
        ExperimentCommand::Footage(chosen) => chosen.run(),
        ExperimentCommand::CameraPlan(chosen) => chosen.run(),
        ExperimentCommand::RefineCameras(chosen) => chosen.run(),
        ExperimentCommand::Sync(chosen) => chosen.run(),
        ExperimentCommand::Trust(chosen) => chosen.run(),
    }
}
