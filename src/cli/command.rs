//! The commands and their help.

use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};

use super::screenshot::ScreenshotArguments;

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
    /// Draw the window without a display and write its picture
    Screenshot(ScreenshotArguments),
    #[command(flatten)]
    Work(Box<backlit_cli::Command>),
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
