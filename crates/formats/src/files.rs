//! Where files come from: the disk, or a set held in memory (the built-in take).

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Component, Path, PathBuf};

use super::{FileError, FileProblem, Result};

/// Largest text file that is read, bytes. A minute of keypoints at 60 fps is 4 MB.
pub const MAX_TEXT_BYTES: u64 = 64 << 20;

/// A set of files that a take reads from.
pub trait TakeFiles: Debug + Send + Sync {
    /// All bytes of a file.
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>>;

    /// Whether there is a file (not a folder) at `path`.
    fn exists(&self, path: &Path) -> bool;

    /// Where a file or folder really lies, behind links; `None` where there is none, or no links.
    fn behind_links(&self, _path: &Path) -> Option<PathBuf> {
        None
    }

    /// A file to be read in parts, as videos are. Files that lie on the disk should not be read as a whole for it.
    fn parts(&self, path: &Path) -> Result<FileParts> {
        Ok(FileParts::in_memory(self.read(path, MAX_BYTES_IN_MEMORY)?))
    }
}

/// Largest file that is held in memory to be read in parts, bytes.
const MAX_BYTES_IN_MEMORY: u64 = 2 << 30;

/// A file that is read in parts.
#[derive(Debug)]
pub struct FileParts {
    source: FileBytes,
    length: u64,
}

#[derive(Debug)]
enum FileBytes {
    Disk(File),
    Memory(Vec<u8>),
}

impl FileParts {
    /// Bytes held in memory.
    #[must_use]
    pub fn in_memory(bytes: Vec<u8>) -> Self {
        Self { length: bytes.len() as u64, source: FileBytes::Memory(bytes) }
    }

    /// Length in bytes, as it was at opening.
    #[must_use]
    pub fn length(&self) -> u64 {
        self.length
    }

    /// The bytes, if they are in memory and not on the disk.
    #[must_use]
    pub fn memory(&self) -> Option<&[u8]> {
        match &self.source {
            FileBytes::Disk(_) => None,
            FileBytes::Memory(bytes) => Some(bytes),
        }
    }

    /// At most `count` bytes from `offset` on; fewer where the file ends. Memory is taken for what is there only.
    pub fn read_up_to(&mut self, offset: u64, count: usize) -> std::io::Result<Vec<u8>> {
        let there = self.length.saturating_sub(offset).min(count as u64) as usize;
        let mut bytes = Vec::with_capacity(there);
        match &mut self.source {
            FileBytes::Disk(file) => {
                file.seek(SeekFrom::Start(offset))?;
                file.take(there as u64).read_to_end(&mut bytes)?;
            }
            FileBytes::Memory(all) => {
                let from = usize::try_from(offset).unwrap_or(usize::MAX);
                bytes.extend_from_slice(
                    all.get(from..).and_then(|rest| rest.get(..there)).unwrap_or_default(),
                );
            }
        }
        Ok(bytes)
    }
}

/// The files of the disk.
#[derive(Debug, Clone, Copy, Default)]
pub struct DiskFiles;

/// Opens a file of the disk.
fn open(path: &Path) -> Result<File> {
    // A pipe would block at opening, so look first.
    if !std::fs::metadata(path).map_err(|error| failed(path, error))?.is_file() {
        return Err(FileError::new(path, FileProblem::NotAFile));
    }
    File::open(path).map_err(|error| failed(path, error))
}

fn failed(path: &Path, error: std::io::Error) -> FileError {
    FileError::new(
        path,
        match error.kind() {
            std::io::ErrorKind::NotFound => FileProblem::Missing,
            _ => FileProblem::Read { error },
        },
    )
}

impl TakeFiles for DiskFiles {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let file = open(path)?;
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes).map_err(|error| failed(path, error))?;
        within_limit(path, bytes.len(), limit)?;
        Ok(bytes)
    }

    fn parts(&self, path: &Path) -> Result<FileParts> {
        let file = open(path)?;
        let length = file.metadata().map_err(|error| failed(path, error))?.len();
        Ok(FileParts { source: FileBytes::Disk(file), length })
    }

    fn exists(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn behind_links(&self, path: &Path) -> Option<PathBuf> {
        path.canonicalize().ok()
    }
}

/// Files held in memory, by path.
#[derive(Debug, Clone, Default)]
pub struct MemoryFiles {
    files: BTreeMap<PathBuf, Cow<'static, [u8]>>,
}

impl MemoryFiles {
    /// From paths and contents; embedded contents are not copied.
    pub fn new<P: Into<PathBuf>, C: Into<Cow<'static, [u8]>>>(
        files: impl IntoIterator<Item = (P, C)>,
    ) -> Self {
        let files = files.into_iter().map(|(path, content)| (plain(&path.into()), content.into()));
        Self { files: files.collect() }
    }
}

impl TakeFiles for MemoryFiles {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>> {
        let content =
            self.files.get(&plain(path)).ok_or_else(|| FileError::new(path, FileProblem::Missing))?;
        within_limit(path, content.len(), limit)?;
        Ok(content.to_vec())
    }

    fn exists(&self, path: &Path) -> bool {
        self.files.contains_key(&plain(path))
    }
}

fn within_limit(path: &Path, bytes: usize, limit: u64) -> Result<()> {
    if bytes as u64 > limit {
        return Err(FileError::new(path, FileProblem::TooLarge { limit }));
    }
    Ok(())
}

/// The path without `.` and `..`.
pub(crate) fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_in_memory_are_found_by_any_spelling() {
        let files = MemoryFiles::new([("take/a.txt", &b"abc"[..])]);
        assert_eq!(files.read(Path::new("take/./b/../a.txt"), 3).unwrap(), b"abc");
        assert!(files.exists(Path::new("take/a.txt")) && !files.exists(Path::new("take")));
        let message = files.read(Path::new("take/a.txt"), 2).unwrap_err().to_string();
        assert!(message.contains("take/a.txt") && message.contains("more than 2 bytes"), "{message}");
    }

    #[test]
    fn the_disk_says_what_is_missing_or_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let missing = DiskFiles.read(&folder.path().join("none.toml"), 10).unwrap_err();
        assert!(missing.is_missing() && missing.to_string().contains("none.toml"), "{missing}");
        let message = DiskFiles.read(folder.path(), 10).unwrap_err().to_string();
        assert!(message.contains("expected a file"), "{message}");
        let path = folder.path().join("long");
        std::fs::write(&path, [0; 11]).unwrap();
        assert!(DiskFiles.read(&path, 10).unwrap_err().to_string().contains("more than 10 bytes"));
        assert_eq!(DiskFiles.read(&path, 11).unwrap().len(), 11);
    }
}
