//! A program with these commands, from its arguments to its exit code: the inspector's, and the Python package's.
//!
//! Exit codes: 0 done, 1 an error (on standard error, in one line), 2 a command that cannot be understood, 3 a track that is
//! doubtful (`--strict`), 101 a fault of the program, 130 stopped by Ctrl+C.

use std::ffi::OsString;
use std::path::Path;

use backlit_formats::memory;
use backlit_tracking::processor;
use clap::error::ErrorKind;
use clap::{Arg, Args, CommandFactory, Parser};

use crate::interrupt::{self, Interrupted};
use crate::output;

/// The exit code of what ended well.
const DONE: u8 = 0;
/// The exit code of an error.
const FAILED: u8 = 1;
/// The exit code of a track that is doubtful, where that was to be an error.
const DOUBTFUL: u8 = 3;
/// The exit code of a command that cannot be understood.
const NOT_UNDERSTOOD: u8 = 2;

/// Set to 256, fits use vectors of at most 256 bits: results are then the same on all x86 processors.
const NARROW_VECTORS: &str = "BACKLIT_VECTORS";
/// Says how many gigabytes a take's pictures may need, where no option does.
const MEMORY_VARIABLE: &str = "BACKLIT_MEMORY";

/// A track that was written and is not to be trusted, where `--strict` makes that an error.
#[derive(Debug, thiserror::Error)]
#[error("--strict: {0}")]
pub struct Doubtful(pub String);

/// The arguments of a program.
pub trait Program: Parser {
    /// How much memory it may use.
    fn memory(&self) -> MemoryArguments;

    /// Does what they say.
    ///
    /// # Errors
    /// What is said on standard error. One of clap's own is a command that cannot be understood.
    fn perform(self) -> anyhow::Result<()>;
}

/// How much memory a program may use.
#[derive(Debug, Clone, Copy, Args)]
pub struct MemoryArguments {
    /// Gigabytes of memory that a take's pictures may need [0.1 to 10000] [default: what the environment variable
    /// `BACKLIT_MEMORY` says, or 4]
    #[arg(long, value_name = "GB", global = true, display_order = 1000, value_parser = gigabytes)]
    memory: Option<f64>,
}

impl MemoryArguments {
    fn budget_gb(self) -> Result<Option<f64>, &'static str> {
        let text = || std::env::var_os(MEMORY_VARIABLE).filter(|text| !text.is_empty());
        match self.memory {
            None => text().map(|text| gigabytes(&text.to_string_lossy())).transpose(),
            given => Ok(given),
        }
    }
}

fn gigabytes(text: &str) -> Result<f64, &'static str> {
    let number = text.trim().parse().ok().filter(|number| (0.1..=10_000.0).contains(number));
    number.ok_or("expected gigabytes, 0.1 to 10000")
}

/// Parses a program's arguments, the first of which is its name, does what they say, and reports errors. Returns the exit code.
pub fn run<P: Program>(arguments: &[OsString]) -> u8 {
    let program = match parsed::<P>(arguments) {
        Ok(program) => program,
        Err(error) => {
            return usage(&stray_word::<P>(arguments).unwrap_or_else(|| as_told::<P>(arguments, error)));
        }
    };
    if let Err(error) = prepare(program.memory()) {
        output::complain(&format!("error: {error}"));
        return NOT_UNDERSTOOD;
    }
    let Err(error) = program.perform() else { return DONE };
    if let Some(error) = error.downcast_ref::<clap::Error>() {
        return usage(error);
    }
    output::complain(&format!("error: {error:#}"));
    if error.downcast_ref::<Interrupted>().is_some() {
        interrupt::EXIT_CODE
    } else if error.downcast_ref::<Doubtful>().is_some() {
        DOUBTFUL
    } else {
        FAILED
    }
}

fn parsed<P: Parser>(arguments: &[OsString]) -> Result<P, clap::Error> {
    let mut command = with_negative_numbers(P::command());
    let mut matches = command.try_get_matches_from_mut(arguments)?;
    P::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut command))
}

/// Takes a negative number after an option for its value, so that its range is told, not that `-1` is no option.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let number = |argument: Arg| {
        let has_value = !argument.is_positional() && argument.get_action().takes_values();
        if has_value { argument.allow_negative_numbers(true) } else { argument }
    };
    command.mut_args(number).mut_subcommands(with_negative_numbers)
}

/// Does what the environment says of vectors and memory: for who computes without a program's arguments.
///
/// # Errors
/// A variable that cannot be understood, in words.
pub fn obey_environment() -> Result<(), String> {
    prepare(MemoryArguments { memory: None })
}

fn prepare(arguments: MemoryArguments) -> Result<(), String> {
    if std::env::var_os(NARROW_VECTORS).is_some_and(|value| value == "256") {
        processor::use_narrow_vectors();
    }
    let budget = arguments.budget_gb().map_err(|expected| format!("{MEMORY_VARIABLE}: {expected}"))?;
    budget.into_iter().for_each(memory::set_budget_gb);
    Ok(())
}

/// The complaint about a word that is neither a command nor something to open. A path with a folder or an ending
/// is no word, even where there is nothing.
pub fn no_such_command<P: CommandFactory>(word: &Path) -> Option<clap::Error> {
    if word.exists() || word.extension().is_some() || word.components().count() != 1 {
        return None;
    }
    let command = P::command();
    let names: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
    let message = format!(
        "\"{}\" is neither a command ({}) nor a take; see backlit --help\n",
        output::printable(&word.to_string_lossy()),
        names.join(", ")
    );
    Some(clap::Error::raw(ErrorKind::InvalidSubcommand, message))
}

/// The complaint about a first argument that is no option, no command and no file, whatever follows it.
fn stray_word<P: CommandFactory>(arguments: &[OsString]) -> Option<clap::Error> {
    let first = arguments.get(1)?;
    let is_known = first.to_string_lossy().starts_with('-') || P::command().find_subcommand(first).is_some();
    if is_known { None } else { no_such_command::<P>(first.as_ref()) }
}

/// The same complaint about arguments that can be shown: it repeats them, whatever their letters and length.
fn as_told<P: Parser>(arguments: &[OsString], error: clap::Error) -> clap::Error {
    let told = arguments.iter().map(|argument| output::printable(&argument.to_string_lossy()).into());
    parsed::<P>(&told.collect::<Vec<_>>()).err().unwrap_or(error)
}

/// Help goes to standard output, an error in the command to standard error.
fn usage(error: &clap::Error) -> u8 {
    // Nobody is left to hear that the terminal is gone.
    let _ = error.print();
    u8::try_from(error.exit_code()).unwrap_or(NOT_UNDERSTOOD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::within;

    #[derive(Debug, Parser)]
    struct Counter {
        #[arg(long, value_parser = within(1..=9_usize))]
        count: usize,
        #[arg(long)]
        loud: bool,
    }

    #[test]
    fn a_negative_number_is_told_its_range() {
        let counter = |count: &str| {
            let arguments = ["counter", "--loud", "--count", count].map(OsString::from);
            parsed::<Counter>(&arguments).map(|counter| (counter.count, counter.loud))
        };
        assert_eq!(counter("3").unwrap(), (3, true));
        let error = counter("-1").unwrap_err().to_string();
        assert!(error.contains("from 1 to 9"), "{error}");
    }
}
