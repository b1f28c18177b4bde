//! The command line: the commands of `backlit-cli`, and those that show the window.
//!
//! Exit codes: 0 done, 1 an error (on standard error, in one line), 2 a command that cannot be understood, 130
//! stopped by Ctrl+C.

pub(crate) mod screenshot;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::anyhow;
use backlit_cli::interrupt::{self, Interrupted};
use backlit_cli::output;
use backlit_formats::{images, memory};
use backlit_take::source::TakeSource;
use backlit_tracking::processor;
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use image::DynamicImage;

use crate::app::window::open_window;
use crate::app::{Opening, PictureOptions, Place, headless_picture};
use screenshot::ScreenshotArguments;

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
struct Cli {
    /// What to open in the window: a take's folder, its take.toml, or a .backlit file [default: the built-in take]
    take: Option<PathBuf>,
    /// Debugging aid: JSON file that the window writes its state to, after each frame in which it changed [default:
    /// what the environment variable `BACKLIT_STATE` says, or none]
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Gigabytes of memory that a take's pictures may need [0.1 to 10000] [default: what the environment variable
    /// `BACKLIT_MEMORY` says, or 4]
    #[arg(long, value_name = "GB", global = true, display_order = 1000, value_parser = gigabytes)]
    memory: Option<f64>,
    /// What to do; without it the window opens.
    #[command(subcommand)]
    command: Option<Command>,
}

/// One thing to do.
#[derive(Debug, Subcommand)]
enum Command {
    /// Open the window at a frame, a camera and a joint
    Open(OpenArguments),
    /// Draw the window without a display and write its picture
    Screenshot(ScreenshotArguments),
    #[command(flatten)]
    Work(Box<backlit_cli::Command>),
}

/// What `backlit open` is told.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  backlit open my.backlit --frame 42 --joint \"left elbow\"")]
struct OpenArguments {
    /// What to open: a take's folder, its take.toml, or a .backlit file [default: the built-in take]
    take: Option<PathBuf>,
    /// Frame, counted from 0
    #[arg(long, value_name = "K", default_value_t = 0, allow_negative_numbers = true)]
    frame: usize,
    /// Camera: its name, or its number from 1 as on its badge
    #[arg(long, value_name = "CAMERA")]
    camera: Option<String>,
    /// Joint, as "left elbow", or the limb that ends there
    #[arg(long, value_name = "JOINT")]
    joint: Option<String>,
}

/// The complaint about a word that is neither a command nor something to open. A path with a folder or an ending
/// is no word, even where there is nothing.
fn no_such_command(word: &Path) -> Option<clap::Error> {
    if word.exists() || word.extension().is_some() || word.components().count() != 1 {
        return None;
    }
    let command = Cli::command();
    let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let message = format!(
        "\"{}\" is neither a command ({}) nor a take; see backlit --help\n",
        output::told(&word.to_string_lossy()),
        names.join(", ")
    );
    Some(clap::Error::raw(ErrorKind::InvalidSubcommand, message))
}

/// Set to 256, fits use vectors of at most 256 bits: results are then the same on all x86 processors.
const NARROW_VECTORS: &str = "BACKLIT_VECTORS";

/// Parses the program's arguments, does what they say, and reports errors.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&stray_word().unwrap_or_else(|| as_told(error))),
    };
    if std::env::var_os(NARROW_VECTORS).is_some_and(|value| value == "256") {
        processor::use_narrow_vectors();
    }
    let memory = match cli.memory.map_or_else(memory_variable, |memory| Ok(Some(memory))) {
        Ok(memory) => memory,
        Err(expected) => {
            output::complain(&format!("error: {MEMORY_VARIABLE}: {expected}"));
            return ExitCode::from(2);
        }
    };
    memory.into_iter().for_each(memory::set_budget_gb);
    let result = match cli.command {
        None => open(cli.take.as_deref(), None, cli.state),
        Some(Command::Open(OpenArguments { take, frame, camera, joint })) => {
            open(take.as_deref(), Some(Place { frame, camera, joint }), None)
        }
        Some(Command::Screenshot(arguments)) => screenshot::run(&arguments),
        Some(Command::Work(command)) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => match error.downcast_ref::<clap::Error>() {
            Some(error) => usage(error),
            None => {
                output::complain(&format!("error: {error:#}"));
                let is_interrupted = error.downcast_ref::<Interrupted>().is_some();
                if is_interrupted { ExitCode::from(interrupt::EXIT_CODE) } else { ExitCode::FAILURE }
            }
        },
    }
}

/// Says how many gigabytes a take's pictures may need, where no option does.
const MEMORY_VARIABLE: &str = "BACKLIT_MEMORY";

fn memory_variable() -> Result<Option<f64>, &'static str> {
    let text = std::env::var_os(MEMORY_VARIABLE).filter(|text| !text.is_empty());
    text.map(|text| gigabytes(&text.to_string_lossy())).transpose()
}

fn gigabytes(text: &str) -> Result<f64, &'static str> {
    let number = text.trim().parse().ok().filter(|number| (0.1..=10_000.0).contains(number));
    number.ok_or("expected gigabytes, 0.1 to 10000")
}

/// The complaint about a first argument that is no option, no command and no file, whatever follows it.
fn stray_word() -> Option<clap::Error> {
    let first = std::env::args_os().nth(1)?;
    let is_known =
        first.to_string_lossy().starts_with('-') || Cli::command().find_subcommand(&first).is_some();
    if is_known { None } else { no_such_command(first.as_ref()) }
}

/// The same complaint about arguments that can be shown: it repeats them, whatever their letters and length.
fn as_told(error: clap::Error) -> clap::Error {
    let told = std::env::args_os().map(|argument| output::told(&argument.to_string_lossy()));
    Cli::try_parse_from(told).err().unwrap_or(error)
}

/// Help goes to standard output, an error in the command to standard error.
fn usage(error: &clap::Error) -> ExitCode {
    // Nobody is left to hear that the terminal is gone.
    let _ = error.print();
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}

/// The picture of the window, in the working folder.
const PICTURE: &str = "backlit-window.png";

/// Names the file that the window writes its state to, where no option does.
const STATE_VARIABLE: &str = "BACKLIT_STATE";

/// Opens the window, or tracks the take and writes the window's picture if there is none. The window writes its state
/// to `state_file`. Errors: what is not there or cannot be opened, or a picture that cannot be written.
fn open(path: Option<&Path>, place: Option<Place>, state_file: Option<PathBuf>) -> anyhow::Result<()> {
    if let Some(path) = path.filter(|path| !path.exists()) {
        return Err(match no_such_command(path) {
            Some(error) => error.into(),
            None => anyhow!("{}: there is no such file or folder", path.display()),
        });
    }
    let opening = || path.map_or(Opening::Take(TakeSource::BuiltIn), Opening::of);
    let state_file = state_file
        .or_else(|| std::env::var_os(STATE_VARIABLE).filter(|path| !path.is_empty()).map(PathBuf::from));
    let Err(no_window) = open_window(Some(opening()), place.clone(), state_file) else { return Ok(()) };
    output::complain(&format!("No window: {no_window:#}. Going on without one."));
    backlit_cli::print_robust_track(path)?;
    let Place { frame, joint, .. } = place.unwrap_or_default();
    let options = PictureOptions { track: true, frame, joint, ..PictureOptions::default() };
    let (picture, _) = headless_picture(opening(), &options)?;
    let file = PathBuf::from(PICTURE);
    images::write_png(&file, &DynamicImage::ImageRgba8(picture))?;
    output::print(&format!("\nPicture of the window: {}\n", std::path::absolute(&file)?.display()))
}
