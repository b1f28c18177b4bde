//! The commands and their help.

use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use super::{
    background, cameras, experiment, export, fit, fit_body, import, observability, prior, recognise, render,
    screenshot, silhouettes, sphere_tree, sync, track,
};

const ABOUT: &str =
    "Fits an articulated body to its silhouettes and shows how. Without a command it opens the window.";

const EXAMPLES: &str = "\
Examples:
  backlit                     the window, on the built-in take
  backlit TAKE                the window, on a take of yours or a .backlit project
  backlit import my_project --out TAKE
  backlit track TAKE --out results
  backlit export results --to bvh,glb --out motion
  backlit fit TAKE --frame 12
  backlit experiment fig5.1 --out experiments
  backlit render --model full_body --cameras cameras.json --pose pose.json --out pictures
  backlit fit --model full_body --cameras cameras.json --start pose.json --masks masks --out fitted.json

Lengths are metres and angles radians unless a unit is given. Quaternions are w x y z. Frames count from 0.";

/// The program's arguments.
#[derive(Debug, Parser)]
#[command(name = "backlit", version, about = ABOUT, after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub(crate) struct Cli {
    /// What to open in the window: a take's folder, its take.toml, or a .backlit file [default: the built-in take]
    pub(crate) take: Option<PathBuf>,
    /// Debugging aid: JSON file that the window writes its state to, after each frame in which it changed [default:
    /// what the environment variable `BACKLIT_STATE` says, or none]
    #[arg(long, value_name = "FILE")]
    pub(crate) state: Option<PathBuf>,
    /// What to do; without it the window opens.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// One thing to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Make a take from footage and a calibration, or from a project of another tool
    Import(import::ImportArguments),
    /// Draw the silhouettes that a pose predicts, one picture a camera
    Render(render::RenderArguments),
    /// Fit a pose to the silhouettes of one moment
    Fit(fit::FitArguments),
    /// Find a person's own lengths and radii from several frames of a take
    FitBody(fit_body::FitBodyArguments),
    /// Fit frame after frame of a take; report joint errors, overlap and times
    Track(track::TrackArguments),
    /// Write a track as motion files for other programs: BVH, TRC, MOT, C3D, glTF, NumPy, CSV
    Export(export::ExportArguments),
    /// Learn the background of a take again, without the tracked body
    Background(background::BackgroundArguments),
    /// Draw the window without a display and write its picture
    Screenshot(screenshot::ScreenshotArguments),
    /// Show what the cameras see of a frame's pose and what they do not, and compare sets of cameras
    Observability(observability::ObservabilityArguments),
    /// Write the silhouettes of a take as pictures
    Silhouettes(silhouettes::SilhouetteArguments),
    /// Find how far apart in time the cameras of a take were started, from the motion of the silhouettes
    Sync(sync::SyncArguments),
    /// Learn from motion files how people move, for track --prior
    Prior(prior::PriorArguments),
    /// Show the cameras of a calibration of another tool, and write them in other formats
    Cameras(cameras::CameraArguments),
    /// Build nested spheres of a closed triangle mesh
    SphereTree(sphere_tree::SphereTreeArguments),
    /// Name motions: walking, running, boxing …; learn names from named motions, and test them
    Recognise(recognise::RecogniseArguments),
    /// Run an experiment of the report again: numbers, a table and plots
    Experiment(experiment::ExperimentArguments),
}

/// The complaint about a word that is neither a command nor something to open. A path with a folder or an ending
/// is no word, even where there is nothing.
pub(crate) fn no_such_command(word: &Path) -> Option<clap::Error> {
    if word.exists() || word.extension().is_some() || word.components().count() != 1 {
        return None;
    }
    let command = Cli::command();
    let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let message = format!(
        "\"{}\" is neither a command ({}) nor a take; see backlit --help\n",
        word.display(),
        names.join(", ")
    );
    Some(clap::Error::raw(ErrorKind::InvalidSubcommand, message))
}
