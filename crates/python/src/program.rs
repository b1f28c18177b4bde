//! The command line that comes with the package: all commands without a window.

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::bail;
use backlit_cli::Command;
use backlit_cli::program::{self, MemoryArguments, Program};
use clap::{Parser, Subcommand};
use pyo3::prelude::*;

const ABOUT: &str = "Fits an articulated body to its silhouettes. These are the commands without a window.";
const NO_WINDOW: &str =
    "the window is in the program backlit, not in the Python package; backlit --help lists its commands";

/// The arguments of the package's program.
#[derive(Debug, Parser)]
#[command(name = "backlit", version, about = ABOUT, args_conflicts_with_subcommands = true)]
struct Arguments {
    /// What the program with a window would open
    #[arg(hide = true)]
    take: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryArguments,
    /// What to do.
    #[command(subcommand)]
    command: Option<PackageCommand>,
}

/// One thing to do.
#[derive(Debug, Subcommand)]
enum PackageCommand {
    /// Is in the program with a window only
    #[command(hide = true, disable_help_flag = true)]
    Screenshot {
        /// Whatever it is told
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<OsString>,
    },
    #[command(flatten)]
    Work(Box<Command>),
}

impl Program for Arguments {
    fn memory(&self) -> MemoryArguments {
        self.memory
    }

    fn perform(self) -> anyhow::Result<()> {
        match self.command {
            Some(PackageCommand::Work(command)) => command.run(),
            Some(PackageCommand::Screenshot { .. }) => bail!(NO_WINDOW),
            None => match self.take {
                Some(path) if !path.exists() => match program::no_such_command::<Self>(&path) {
                    Some(error) => Err(error.into()),
                    None => bail!("{}: there is no such file or folder", path.display()),
                },
                _ => bail!(NO_WINDOW),
            },
        }
    }
}

/// Runs the command line with these arguments, the first of which is the program's name. Returns the exit code: 0 done, 1 an error, 2
/// a command that cannot be understood, 130 stopped by Ctrl+C.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| program::run::<Arguments>(&arguments))
}
