//! The `backlit` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    backlit::cli::run()
}
