//! Real footage: in the folder that `BACKLIT_DATA` names, else in `../shared/data` beside the workspace.
//!
//! Shared by the tests of all crates. Where it is not there a test says so past the test runner, which would keep it to
//! itself; with `BACKLIT_REQUIRE_DATA=1` it fails.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The folder of the balancing trial; without it the test is to be skipped.
pub(crate) fn footage() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().find(|at| at.join("Cargo.lock").is_file());
    let beside = || root.unwrap_or(Path::new(".")).join("../shared/data");
    let data = std::env::var_os("BACKLIT_DATA").map_or_else(beside, PathBuf::from);
    let footage = data.join("balancing");
    if footage.is_dir() {
        return Some(footage);
    }
    let is_required = std::env::var_os("BACKLIT_REQUIRE_DATA").is_some_and(|required| required == "1");
    assert!(!is_required, "BACKLIT_REQUIRE_DATA=1, and there is no footage in {}", footage.display());
    let test = std::thread::current();
    let name = test.name().unwrap_or("a test");
    // Not by a macro: what those print of a test that passes is not shown.
    let mut screen = std::io::stderr();
    writeln!(screen, "SKIPPED {name}: no footage in {}", footage.display()).unwrap();
    None
}
