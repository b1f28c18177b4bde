//! The command line: the commands of `backlit-cli`, and those that show the window. [`backlit_cli::program`] runs them and says
//! what exit codes mean.

pub(crate) mod screenshot;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::anyhow;
use backlit_cli::output;
use backlit_cli::program::{self, MemoryArguments, Program};
use backlit_formats::images;
use backlit_take::source::TakeSource;
use clap::{Parser, Subcommand};
use image::DynamicImage;

use crate::app::window::open_window;
use crate::app::{Opening, PictureOptions, Place, headless_picture};
use screenshot::ScreenshotArguments;

const ABOUT: &str =
    "Fits an articulated body to its silhouettes and shows how. Without a command it opens the window.";

const EXAMPLES: &str = "\
Examples:
  backlit                     the window, on the built-in take
  backlit TAKE                the window, on a take of yours, a .backlit project or a motion's file
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
    /// What to open in the window: a take's folder, its take.toml, a .backlit file, or a motion (BVH, TRC, C3D, CSV, NumPy) [default: the built-in take]
    take: Option<PathBuf>,
    /// Debugging aid: JSON file that the window writes its state to, after each frame in which it changed [default:
    /// what the environment variable `BACKLIT_STATE` says, or none]
    #[arg(long, value_name = "FILE")]
    state: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryArguments,
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
    /// What to open: a take's folder, its take.toml, a .backlit file, or a motion (BVH, TRC, C3D, CSV, NumPy) [default: the built-in take]
    take: Option<PathBuf>,
    /// Frame, counted from 0
    #[arg(long, value_name = "K", default_value_t = 0)]
    frame: usize,
    /// Camera: its name, or its number from 1 as on its badge
    #[arg(long, value_name = "CAMERA")]
    camera: Option<String>,
    /// Joint, as "left elbow", or the limb that ends there
    #[arg(long, value_name = "JOINT")]
    joint: Option<String>,
}

impl Program for Cli {
    fn memory(&self) -> MemoryArguments {
        self.memory
    }

    fn perform(self) -> anyhow::Result<()> {
        match self.command {
            None => open(self.take.as_deref(), None, self.state),
            Some(Command::Open(OpenArguments { take, frame, camera, joint })) => {
                open(take.as_deref(), Some(Place { frame, camera, joint }), None)
            }
            Some(Command::Screenshot(arguments)) => screenshot::run(&arguments),
            Some(Command::Work(command)) => command.run(),
        }
    }
}

/// Parses the program's arguments, does what they say, and reports errors.
pub fn run() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    ExitCode::from(program::run::<Cli>(&arguments))
}

/// The picture of the window, in the working folder.
const PICTURE: &str = "backlit-window.png";

/// Names the file that the window writes its state to, where no option does.
const STATE_VARIABLE: &str = "BACKLIT_STATE";

/// Opens the window, or tracks the take and writes the window's picture if there is none. The window writes its state
/// to `state_file`. Errors: what is not there or cannot be opened, or a picture that cannot be written.
fn open(path: Option<&Path>, place: Option<Place>, state_file: Option<PathBuf>) -> anyhow::Result<()> {
    if let Some(path) = path.filter(|path| !path.exists()) {
        return Err(match program::no_such_command::<Cli>(path) {
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
