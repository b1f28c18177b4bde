//! The command line: the inspector's twin. What a command computes is the core's; here are words and files.
//!
//! | file | holds |
//! |---|---|
//! | `command` | the commands and their help |
//! | `fit_options` | options that choose renderer, ramp and solver |
//! | `render` | `backlit render` |
//! | `fit` | `backlit fit` |
//! | `fit_body`, `fit_body_report` | `backlit fit-body` |
//! | `evidence` | silhouettes and grey levels from a folder |
//! | `import` | `backlit import` |
//! | `track` | `backlit track` |
//! | `track_report`, `track_files` | what a track is worth, and the files with it |
//! | `export` | `backlit export` |
//! | `observability` | `backlit observability` |
//! | `silhouettes` | `backlit silhouettes` |
//! | `sync` | `backlit sync` |
//! | `sphere_tree` | `backlit sphere-tree` |
//! | `prior` | `backlit prior` |
//! | `cameras` | `backlit cameras` |
//! | `recognise` | `backlit recognise` |
//! | `experiment` | `backlit experiment`: one file an experiment |
//! | `take_options` | options that choose frames, cameras and start |
//! | `reference_options` | options that name keypoints to compare with |
//! | `own_body` | a start and sizes where the take has none |
//! | `inspector` | `backlit [TAKE]`: the window, or what it would have shown |
//! | `screenshot` | `backlit screenshot` |
//! | `interrupt` | Ctrl+C |
//! | `table` | tables for people |
//! | `output` | standard output and folders |
//!
//! Exit codes: 0 done, 1 an error (on standard error, in one line), 2 a command that makes no sense, 130
//! stopped by Ctrl+C.

pub(crate) mod background;
pub(crate) mod cameras;
pub(crate) mod command;
pub(crate) mod each_frame;
pub(crate) mod evidence;
pub(crate) mod experiment;
pub(crate) mod export;
pub(crate) mod fit;
pub(crate) mod fit_body;
pub(crate) mod fit_body_report;
pub(crate) mod fit_options;
pub(crate) mod import;
pub(crate) mod inspector;
pub(crate) mod interrupt;
pub(crate) mod observability;
pub(crate) mod output;
pub(crate) mod own_body;
pub(crate) mod prior;
pub(crate) mod recognise;
pub(crate) mod reference_options;
pub(crate) mod render;
pub(crate) mod resume;
pub(crate) mod screenshot;
pub(crate) mod silhouettes;
pub(crate) mod sphere_tree;
pub(crate) mod sync;
pub(crate) mod table;
pub(crate) mod take_options;
pub(crate) mod track;
pub(crate) mod track_files;
pub(crate) mod track_report;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use backlit_tracking::processor;
use command::{Cli, Command, no_such_command};
use interrupt::Interrupted;

/// Set to 256, fits use vectors of at most so many bits: results are then the same on all x86 processors.
const NARROW_VECTORS: &str = "BACKLIT_VECTORS";

/// Parses the program's arguments, does what they say, and reports errors.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&stray_word().unwrap_or(error)),
    };
    if std::env::var_os(NARROW_VECTORS).is_some_and(|value| value == "256") {
        processor::use_narrow_vectors();
    }
    let result = match cli.command {
        None => inspector::run(cli.take.as_deref(), cli.state),
        Some(Command::Render(arguments)) => render::run(&arguments),
        Some(Command::Fit(arguments)) => fit::run(&arguments),
        Some(Command::FitBody(arguments)) => fit_body::run(&arguments),
        Some(Command::Track(arguments)) => track::run(&arguments),
        Some(Command::Import(arguments)) => import::run(&arguments),
        Some(Command::Export(arguments)) => export::run(&arguments),
        Some(Command::Screenshot(arguments)) => screenshot::run(&arguments),
        Some(Command::Observability(arguments)) => observability::run(&arguments),
        Some(Command::Silhouettes(arguments)) => silhouettes::run(&arguments),
        Some(Command::Background(arguments)) => background::run(&arguments),
        Some(Command::Sync(arguments)) => sync::run(&arguments),
        Some(Command::Prior(arguments)) => prior::run(&arguments),
        Some(Command::Cameras(arguments)) => cameras::run(&arguments),
        Some(Command::SphereTree(arguments)) => sphere_tree::run(&arguments),
        Some(Command::Recognise(arguments)) => recognise::run(&arguments),
        Some(Command::Experiment(arguments)) => experiment::run(&arguments),
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

/// The complaint about a first argument that is no option, no command and no file, whatever follows it.
fn stray_word() -> Option<clap::Error> {
    let first = std::env::args_os().nth(1)?;
    let is_known =
        first.to_string_lossy().starts_with('-') || Cli::command().find_subcommand(&first).is_some();
    if is_known { None } else { no_such_command(first.as_ref()) }
}

/// Help goes to standard output, a command that makes no sense to standard error.
fn usage(error: &clap::Error) -> ExitCode {
    // Nobody is left to hear that the terminal is gone.
    let _ = error.print();
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}
