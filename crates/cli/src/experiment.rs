//! `backlit experiment`: the report's experiments again. The numbers are the core's; here are words, files and plots.
//!
//! | file | holds |
//! |---|---|
//! | [`arguments`] | options that all experiments share |
//! | [`files`] | the files of an experiment, and the table on the screen |
//! | [`waiting`] | the bar while one runs |
//! | [`fig51`] | `backlit experiment fig5.1` |
//! | [`fig52`] | `backlit experiment fig5.2` and `fig5.3` |
//! | [`sequence`] | options of those that run on a sequence: a take, or the simulated one |
//! | [`fig54`] | `backlit experiment fig5.4` |
//! | [`fig55`] | `backlit experiment fig5.5` and `fig5.6` |
//! | [`inverse`] | `backlit experiment inverse` |
//! | [`bias`] | `backlit experiment bias` |
//! | [`shadow`] | `backlit experiment shadow` |
//! | [`sizes`] | `backlit experiment sizes` |
//! | [`track`] | `backlit experiment track` |
//! | [`robustness`] | `backlit experiment robustness` |
//! | [`acquire`] | `backlit experiment acquire` |
//! | [`begin`] | `backlit experiment begin` |
//! | [`basin`] | `backlit experiment basin` |
//! | [`frame_basin`] | `backlit experiment basin --take`, with and without `--map` |
//! | [`footage`] | `backlit experiment footage` |
//! | [`sync`] | `backlit experiment sync` |
//! | [`no_start`] | `backlit experiment no-start` |

pub(crate) mod acquire;
pub(crate) mod arguments;
pub(crate) mod basin;
pub(crate) mod begin;
pub(crate) mod bias;
pub(crate) mod fig51;
pub(crate) mod fig52;
pub(crate) mod fig54;
pub(crate) mod fig55;
pub(crate) mod files;
pub(crate) mod footage;
pub(crate) mod frame_basin;
pub(crate) mod inverse;
pub(crate) mod no_start;
pub(crate) mod robustness;
pub(crate) mod sequence;
pub(crate) mod shadow;
pub(crate) mod sizes;
pub(crate) mod sync;
pub(crate) mod track;
pub(crate) mod waiting;

use clap::{Args, Subcommand};

const AFTER_HELP: &str = "\
Every experiment prints a table, and writes its numbers (NAME.json) and its plots (NAME.png) to --out. The \
same options give the same numbers. docs/report.md has the report's figures beside ours.";

/// What `backlit experiment` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct ExperimentArguments {
    #[command(subcommand)]
    experiment: Experiment,
}

#[derive(Debug, Subcommand)]
enum Experiment {
    /// One limb seen from the side: the cylinder never moves along its axis, capsule and sphere tree do
    #[command(name = "fig5.1")]
    Fig51(fig51::Arguments),
    /// The upper body before one camera, from many starts: cost and joint error per iteration
    #[command(name = "fig5.2")]
    Fig52(fig52::Arguments),
    /// The same from the same starts before two cameras
    #[command(name = "fig5.3")]
    Fig53(fig52::Arguments),
    /// One frame of a take, or of the simulated upper body, iteration by iteration: D and Λ of two cameras
    #[command(name = "fig5.4")]
    Fig54(fig54::Arguments),
    /// A take, or the simulated upper body, followed in 192 × 144 pixels: joint error and overlap per frame
    #[command(name = "fig5.5")]
    Fig55(fig55::Arguments),
    /// The same with 48 × 36 pixels
    #[command(name = "fig5.6")]
    Fig56(fig55::Arguments),
    /// The step (4.10) as written, and the pseudo-inverse and dampings that can stand for it
    Inverse(inverse::Arguments),
    /// Where a fit that begins at the truth ends: the bias of each ramp on hard masks, by number of cameras
    Bias(bias::Arguments),
    /// Simulated rooms with shadows: what each shadow test makes of subject, shadow and joints; what noise makes of β
    Shadow(shadow::Arguments),
    /// Lengths and radii of people of several builds, from silhouettes and an average adult's body
    Sizes(sizes::Arguments),
    /// The upper body followed at one to four times its speed through noisy masks, by kind of motion
    Track(track::Arguments),
    /// The full body with one thing wrong at a time: noise, holes, cameras, sizes, calibration
    Robustness(robustness::Arguments),
    /// How far off a start may be: share of starts that end at the truth, by distance and number of cameras
    Basin(Box<basin::Arguments>),
    /// First bodies of people of several builds, grown with nothing known, beside fitted ones; or of a take's person
    Acquire(acquire::Arguments),
    /// Ways to begin, side by side: downhill, particles, templates, the search; what they find, evaluations of Λ, time
    Begin(Box<begin::Arguments>),
    /// A take with keypoints, tracked from many starts: how many stay near the keypoints everywhere
    Footage(Box<footage::Arguments>),
    /// A take with keypoints, single frames without a start, by all sets of cameras: how many find the person
    #[command(name = "no-start")]
    NoStart(no_start::Arguments),
    /// Cameras whose clocks are off by known times, found from the motion of the silhouettes
    Sync(sync::Arguments),
}

/// Runs the experiment.
///
/// # Errors
/// Options that make no sense, or files that cannot be written.
pub(crate) fn run(arguments: &ExperimentArguments) -> anyhow::Result<()> {
    match &arguments.experiment {
        Experiment::Fig51(arguments) => fig51::run(arguments),
        Experiment::Fig52(arguments) => fig52::run(arguments, "fig5.2", 1),
        Experiment::Fig53(arguments) => fig52::run(arguments, "fig5.3", 2),
        Experiment::Fig54(arguments) => fig54::run(arguments),
        Experiment::Fig55(arguments) => fig55::run(arguments, "fig5.5", [192, 144]),
        Experiment::Fig56(arguments) => fig55::run(arguments, "fig5.6", [48, 36]),
        Experiment::Inverse(arguments) => inverse::run(arguments),
        Experiment::Bias(arguments) => bias::run(arguments),
        Experiment::Shadow(arguments) => shadow::run(arguments),
        Experiment::Sizes(arguments) => sizes::run(arguments),
        Experiment::Track(arguments) => track::run(arguments),
        Experiment::Robustness(arguments) => robustness::run(arguments),
        Experiment::Basin(arguments) => basin::run(arguments),
        Experiment::Acquire(arguments) => acquire::run(arguments),
        Experiment::Begin(arguments) => begin::run(arguments),
        Experiment::Footage(arguments) => footage::run(arguments),
        Experiment::NoStart(arguments) => no_start::run(arguments),
        Experiment::Sync(arguments) => sync::run(arguments),
    }
}
