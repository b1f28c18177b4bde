//! Writing a file so that it is whole or not there: a temporary file beside it, then a rename.

use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;

use super::{FileError, FileProblem};

/// Writes a file by a closure. On any failure the file is as it was before.
///
/// # Errors
/// The folder is missing or not writable, or the closure failed. The error names the file.
pub fn write_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), FileError> {
    replace(path, write).map_err(|error| FileError::new(path, FileProblem::Write { error }))
}

/// Writes these bytes as [`write_with`] does.
///
/// # Errors
/// The folder is missing or not writable. The error names the file.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write_with(path, |out| out.write_all(bytes))
}

fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> std::io::Result<()> {
    // A link stays a link: the file it points to is replaced.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    match std::fs::metadata(&target) {
        Ok(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Ok(old) if !old.is_file() => return write_through(&target, write),
        _ => {}
    }
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".backlit-").suffix(".part");
    // Temporary files are private by custom; this one is going to be an ordinary file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // Of its error, only the kind: the rest names the temporary file, which says nothing to anybody.
    let file = builder.tempfile_in(folder).map_err(|error| std::io::Error::from(error.kind()))?;
    let mut out = BufWriter::new(file);
    write(&mut out)?;
    let file = out.into_inner().map_err(std::io::IntoInnerError::into_error)?;
    if let Ok(old) = std::fs::metadata(&target) {
        file.as_file().set_permissions(old.permissions())?;
    }
    file.as_file().sync_all()?;
    file.persist(&target).map_err(|error| error.error)?;
    Ok(())
}

/// A device or a pipe is written to: a file is not to take its place.
fn write_through(
    device: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::options().write(true).open(device)?);
    write(&mut out)?;
    out.flush()
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
            Err(std::io::Error::other("disk full"))
        });
        let message = result.unwrap_err().to_string();
        assert!(message.contains("pose.json") && message.contains("disk full"), "{message}");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        write(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
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
