//! The command line: the commands of `backlit-cli`, and those that show the window.
//!
//! | file | holds |
//! |---|---|
//! | `command` | the program's arguments and their help |
//! | `inspector` | `backlit [TAKE]`: the window, or what it would have shown |
//! | `screenshot` | `backlit screenshot` |
//!
//! Exit codes: 0 done, 1 an error (on standard error, in one line), 2 a command that cannot be understood, 130
//! stopped by Ctrl+C.

pub(crate) mod command;
pub(crate) mod inspector;
pub(crate) mod screenshot;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use backlit_cli::interrupt::{self, Interrupted};
use backlit_cli::output;
use backlit_tracking::processor;
use command::{Cli, Command, no_such_command};

/// Set to 256, fits use vectors of at most 256 bits: results are then the same on all x86 processors.
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
    let result = match &cli.command {
        None => inspector::run(cli.take.as_deref(), cli.state),
        Some(Command::Screenshot(arguments)) => screenshot::run(arguments),
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

/// The complaint about a first argument that is no option, no command and no file, whatever follows it.
fn stray_word() -> Option<clap::Error> {
    let first = std::env::args_os().nth(1)?;
    let is_known =
        first.to_string_lossy().starts_with('-') || Cli::command().find_subcommand(&first).is_some();
    if is_known { None } else { no_such_command(first.as_ref()) }
}

/// Help goes to standard output, an error in the command to standard error.
fn usage(error: &clap::Error) -> ExitCode {
    // Nobody is left to hear that the terminal is gone.
    let _ = error.print();
    ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
}
