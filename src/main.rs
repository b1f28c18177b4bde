//! The `backlit` program.

use std::process::ExitCode;

/// Threads that decode and segment leave holes in glibc's heaps: with it a tracked project of four videos takes a third more memory.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    backlit::cli::run()
}
