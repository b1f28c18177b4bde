//! Whole files that runs begin from: `corpus` has a folder a target, of files that our own writers made or somebody wrote by hand.

use std::path::{Path, PathBuf};

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus")
}

/// The kept files of a target that must be read, and those that were once a fault, which only must be answered.
pub(crate) fn kept(target: &str, is_found: bool) -> Vec<Vec<u8>> {
    let Ok(entries) = std::fs::read_dir(corpus().join(target)) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let name_begins = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().starts_with("found-");
    paths.retain(|path| name_begins(path) == is_found);
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// One file of the corpus.
pub(crate) fn file(path: &str) -> Vec<u8> {
    std::fs::read(corpus().join(path)).unwrap()
}
