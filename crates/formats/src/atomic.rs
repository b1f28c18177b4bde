//! Writing a file so that it is whole or not there: a temporary file beside it, then a rename.

use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tempfile::TempPath;

use super::{FileError, FileProblem, Result};

/// Writes a file by a closure. On any failure the file is as it was before.
pub fn write_with(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let file = NewFile::create(path)?;
    file.fill(write)?;
    file.finish()
}

/// Writes these bytes as [`write_with`] does.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    write_with(path, |out| out.write_all(bytes))
}

/// Writes what a file holds.
pub type Fill<'a> = Box<dyn FnOnce(&mut dyn Write) -> io::Result<()> + 'a>;

/// Writes files into a folder, by name: each is whole before the first takes its place. If one cannot be written, all are as
/// they were before.
pub fn write_all(folder: &Path, files: Vec<(&str, Fill<'_>)>) -> Result<()> {
    let mut written = Vec::with_capacity(files.len());
    for (name, fill) in files {
        let file = NewFile::create(&folder.join(name))?;
        file.fill(fill)?;
        written.push(file);
    }
    written.into_iter().try_for_each(NewFile::finish)
}

/// A file that is written little by little, beside the one whose place it is going to take. If it is dropped before it is
/// finished, the old file is as it was before.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    /// What the path points to, if it is a link: that is replaced.
    target: PathBuf,
    file: Arc<File>,
    /// A device or a pipe has none: it is written to, since a file is not to take its place.
    temporary: Option<TempPath>,
}

impl NewFile {
    /// Begins a file.
    pub fn create(path: &Path) -> Result<Self> {
        Self::begin(path).map_err(|error| FileError::new(path, FileProblem::Write { error }))
    }

    fn begin(path: &Path) -> io::Result<Self> {
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let path = path.to_owned();
        match std::fs::metadata(&target) {
            Ok(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(old) if !old.is_file() => {
                let file = Arc::new(File::options().write(true).open(&target)?);
                return Ok(Self { path, target, file, temporary: None });
            }
            _ => {}
        }
        let folder =
            target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        builder.prefix(".backlit-").suffix(".part");
        // Temporary files are private by custom; this one is going to be an ordinary file.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // Of its error, only the kind: the rest names the temporary file, which says nothing to anybody.
        let file = builder.tempfile_in(folder).map_err(|error| io::Error::from(error.kind()))?;
        let (file, temporary) = file.into_parts();
        Ok(Self { path, target, file: Arc::new(file), temporary: Some(temporary) })
    }

    /// Where its bytes go. A buffered writer must be flushed before the file is finished.
    #[must_use]
    pub fn writer(&self) -> Arc<File> {
        self.file.clone()
    }

    fn fill(&self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
        let mut out = BufWriter::new(self.writer());
        let written = write(&mut out).and_then(|()| out.flush());
        written.map_err(|error| self.error(error))
    }

    /// What went wrong while it was written, with its name.
    #[must_use]
    pub fn error(&self, error: io::Error) -> FileError {
        FileError::new(&self.path, FileProblem::Write { error })
    }

    /// It is whole: it takes its place.
    pub fn finish(mut self) -> Result<()> {
        let Some(temporary) = self.temporary.take() else { return Ok(()) };
        self.replace(temporary).map_err(|error| self.error(error))
    }

    fn replace(&self, temporary: TempPath) -> io::Result<()> {
        if let Ok(old) = std::fs::metadata(&self.target) {
            self.file.set_permissions(old.permissions())?;
        }
        self.file.sync_all()?;
        temporary.persist(&self.target).map_err(|error| error.error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pose.json");
        write(&path, b"old").unwrap();
        let result = write_with(&path, |out| {
            out.write_all(b"half of the new")?;
            Err(io::Error::other("disk full"))
        });
        let message = result.unwrap_err().to_string();
        assert!(message.contains("pose.json") && message.contains("disk full"), "{message}");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        write(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn of_several_files_none_is_new_where_one_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let files = |last: io::Result<()>| -> Vec<(&str, Fill<'_>)> {
            vec![("a", Box::new(|out| out.write_all(b"new"))), ("b", Box::new(|_| last))]
        };
        write(&folder.path().join("a"), b"old").unwrap();
        let full = Err(io::Error::other("disk full"));
        let message = write_all(folder.path(), files(full)).unwrap_err().to_string();
        assert!(message.contains("b: cannot be written: disk full"), "{message}");
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        write_all(folder.path(), files(Ok(()))).unwrap();
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"new");
    }

    #[test]
    fn a_missing_folder_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let message = write(&folder.path().join("no/pose.json"), b"x").unwrap_err().to_string();
        assert!(message.contains("no/pose.json") && message.contains("cannot be written"), "{message}");
    }

    #[test]
    fn a_folder_is_not_replaced_and_what_stands_in_the_way_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        write(&file, b"old").unwrap();
        for (path, expected) in [
            (folder.path().to_owned(), "there is a folder of that name"),
            (file.join("inside"), "what should be its folder is a file"),
        ] {
            let message = write(&path, b"x").unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        assert_eq!(std::fs::read(&file).unwrap(), b"old");
    }

    #[test]
    fn a_device_is_written_to_and_a_full_one_says_so() {
        let full = Path::new("/dev/full");
        if !full.exists() {
            println!("skipped: there is no /dev/full");
            return;
        }
        let message = write(full, b"x").unwrap_err().to_string();
        assert_eq!(message, "/dev/full: cannot be written: the disk is full");
        assert!(!full.metadata().unwrap().is_file(), "it is what it was");
        write(Path::new("/dev/null"), b"x").unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a"), folder.path().join("b"));
        write(&path, b"1").unwrap();
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o400, 0o400);
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write(&link, b"2").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"2");
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o640);
    }
}
