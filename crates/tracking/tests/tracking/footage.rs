//! Real footage: in the folder that `BACKLIT_DATA` names, else in `../shared/data` beside the workspace.

use std::path::{Path, PathBuf};

/// The folder of the balancing trial. Where it is not there, says that the test is skipped.
pub(crate) fn footage() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let data = std::env::var_os("BACKLIT_DATA").map_or_else(beside, PathBuf::from);
    let footage = data.join("balancing");
    if !footage.is_dir() {
        println!("skipped: no footage (set BACKLIT_DATA)");
        return None;
    }
    Some(footage)
}
