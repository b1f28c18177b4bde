//! The files of the copies.
//!
//! Every window writes a copy of its own, `unsaved.backlit`, `unsaved-2.backlit` and so on, and holds a lock on the
//! file beside it for as long as it lives. The system lets go of the lock however the program ends: a copy whose
//! lock is free was left by a window that is gone. A copy is never written over by another window or about another
//! take; what the user discards is put aside under another name.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use backlit_document::project::{ProjectError, read_project};
use backlit_formats::reason;

use super::{CopyNote, Thumbnail, UnsavedCopy};

/// Beginning of a copy's name.
const NAME: &str = "unsaved";
/// Beginning of the name of a copy that was put aside.
const ASIDE: &str = "left";
/// Ending of a copy's name.
const ENDING: &str = "backlit";
/// This many windows can be open at once, or have left something.
const MOST: usize = 200;
/// How many of the copies that were put aside are kept, the newest first.
const MOST_ASIDE: usize = 20;

fn lock_path(copy: &Path) -> PathBuf {
    copy.with_extension("lock")
}

/// The copies in a folder, and the one that this window writes.
#[derive(Debug)]
pub struct Copies {
    folder: PathBuf,
    /// Its lock is held as long as this window lives.
    own: Option<(PathBuf, Lock)>,
}

/// The lock of a copy, free again as soon as this is dropped.
///
/// To close the file is not enough. A process that is just being started has this process's open files until it runs
/// its own program, and the system keeps a lock for as long as anybody has its file open.
#[derive(Debug)]
struct Lock(File);

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

impl Copies {
    /// The copies in a folder, which is made when the first is written.
    pub fn new(folder: PathBuf) -> Self {
        // What is opened is known by its whole path.
        let folder = std::path::absolute(&folder).unwrap_or(folder);
        Self { folder, own: None }
    }

    /// This window's copy: the first name that is free. Errors: the folder cannot be made or written.
    pub(crate) fn own(&mut self) -> io::Result<&Path> {
        let own = match self.own.take() {
            Some(own) => own,
            None => {
                std::fs::create_dir_all(&self.folder)?;
                self.claim_free()?
            }
        };
        Ok(&self.own.insert(own).0)
    }

    /// What the system says about the folder, with its name.
    pub(crate) fn said(&self, error: &io::Error) -> String {
        format!("{}: {}", self.folder.display(), reason(error))
    }

    /// Leaves this window's copy if its folder was taken away, together with the lock: the next copy has a folder and
    /// a lock of its own.
    pub(crate) fn leave_if_gone(&mut self) {
        self.own.take_if(|(path, _)| !lock_path(path).exists());
    }

    fn claim_free(&self) -> io::Result<(PathBuf, Lock)> {
        for number in 1..=MOST {
            let name = if number == 1 { NAME.to_owned() } else { format!("{NAME}-{number}") };
            let path = self.folder.join(name).with_extension(ENDING);
            // First the lock: between a look and a lock another window could have come.
            if let Some(lock) = lock(&path)?
                && !path.exists()
            {
                return Ok((path, lock));
            }
        }
        Err(io::Error::other(format!("there are {MOST} copies already")))
    }

    /// Goes on with a copy that was left: this window writes it from now on. Not if another window was quicker.
    /// Errors: the lock cannot be made.
    pub(crate) fn adopt(&mut self, path: &Path) -> io::Result<bool> {
        let Some(lock) = lock(path)? else { return Ok(false) };
        self.own = Some((path.to_owned(), lock));
        Ok(true)
    }

    /// Leaves this window's copy as it is: what comes next is about something else and has a copy of its own.
    pub(crate) fn leave(&mut self) {
        self.own = None;
    }

    /// Removes this window's copy: everything in it is saved.
    pub(crate) fn forget(&mut self) {
        if let Some((path, _)) = self.own.take() {
            remove(&path);
        }
    }

    /// What windows that are gone have left, the newest first, and what cannot be read.
    pub fn left(&self) -> (Vec<UnsavedCopy>, Vec<ProjectError>) {
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for path in self.files(NAME) {
            let is_own = self.own.as_ref().is_some_and(|(own, _)| *own == path);
            if is_own || !matches!(lock(&path), Ok(Some(_))) {
                continue;
            }
            match read_project(&path) {
                Ok(project) => {
                    let saved = std::fs::metadata(&path).and_then(|data| data.modified()).ok();
                    let (about, picture) = (CopyNote::read(&path), Thumbnail::read(&path));
                    found.push(UnsavedCopy::new(path, &project.document, about, saved, picture));
                }
                Err(error) => wrong.push(error),
            }
        }
        found.sort_by_key(|left| std::cmp::Reverse(left.saved));
        (found, wrong)
    }

    /// Puts a copy aside: it is offered no more, and can still be opened as a project. Says where it is. Errors: it
    /// cannot be renamed.
    pub(crate) fn put_aside(&self, copy: &Path) -> io::Result<PathBuf> {
        let aside = self.free(ASIDE, 1)?;
        rename(copy, &aside)?;
        let mut files = self.files(ASIDE);
        files.sort_by_key(|path| std::fs::metadata(path).and_then(|data| data.modified()).ok());
        for old in files.iter().rev().skip(MOST_ASIDE) {
            remove(old);
        }
        Ok(aside)
    }

    /// Offers again what was put aside. Errors: it cannot be renamed.
    pub(crate) fn bring_back(&self, aside: &Path) -> io::Result<()> {
        // The first numbers are left to windows that write.
        rename(aside, &self.free(NAME, 2)?)
    }

    /// A name that begins so and is not in use.
    fn free(&self, beginning: &str, from: usize) -> io::Result<PathBuf> {
        (from..from + 10 * MOST)
            .map(|number| self.folder.join(format!("{beginning}-{number}")).with_extension(ENDING))
            .find(|path| !path.exists() && !lock_path(path).exists())
            .ok_or_else(|| io::Error::other("there are too many copies already"))
    }

    /// The copies whose name begins so, in the order of their names.
    fn files(&self, beginning: &str) -> Vec<PathBuf> {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return Vec::new() };
        let is_copy = |path: &PathBuf| {
            let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            let rest = stem.strip_prefix(beginning);
            path.extension().is_some_and(|ending| ending == ENDING)
                && rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
        };
        let mut files: Vec<PathBuf> =
            entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_copy).collect();
        files.sort();
        files
    }
}

/// What stands beside a copy, and is moved with it.
fn beside(copy: &Path) -> [PathBuf; 2] {
    [CopyNote::path_of(copy), Thumbnail::path_of(copy)]
}

/// Removes a copy with all that belongs to it. There may be none.
fn remove(copy: &Path) {
    for path in [copy.to_owned(), lock_path(copy)].iter().chain(&beside(copy)) {
        let _ = std::fs::remove_file(path);
    }
}

/// Renames a copy with what stands beside it. Its lock, which nobody holds, is removed.
fn rename(from: &Path, to: &Path) -> io::Result<()> {
    std::fs::rename(from, to)?;
    for (from, to) in beside(from).iter().zip(beside(to)) {
        let _ = std::fs::rename(from, to);
    }
    let _ = std::fs::remove_file(lock_path(from));
    Ok(())
}

/// The lock of a copy; `None` if another window holds it.
fn lock(copy: &Path) -> io::Result<Option<Lock>> {
    let path = lock_path(copy);
    // A pipe or a device would block, or be written to.
    if path.exists() && !path.is_file() {
        return Err(io::Error::other(format!("{} is not a file", path.display())));
    }
    let file = File::options().create(true).write(true).truncate(false).open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(Lock(file))),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;
    use backlit_document::Document;
    use backlit_document::project::write_project;
    use backlit_take::source::TakeSource;

    fn write(path: &Path) {
        let mut document = Document::new(builtin::single_limb());
        document.take = Some(TakeSource::BuiltIn);
        write_project(path, &document, &[]).unwrap();
    }

    #[test]
    fn windows_do_not_touch_each_others_copies() {
        let folder = tempfile::tempdir().unwrap();
        let (mut one, mut other) = (Copies::new(folder.path().into()), Copies::new(folder.path().into()));
        let first = one.own().unwrap().to_owned();
        write(&first);
        assert_eq!(first.file_name().unwrap(), "unsaved.backlit");
        assert!(other.left().0.is_empty(), "its window is alive");
        let second = other.own().unwrap().to_owned();
        assert_eq!(second.file_name().unwrap(), "unsaved-2.backlit");
        write(&second);
        drop(one);
        let left = other.left().0;
        assert_eq!(left.iter().map(|left| &left.path).collect::<Vec<_>>(), [&first]);
        other.leave();
        assert_eq!(other.left().0.len(), 2);
        assert_eq!(other.own().unwrap().file_name().unwrap(), "unsaved-3.backlit", "neither is written over");
    }

    #[test]
    fn a_copy_is_adopted_once_and_forgotten_when_all_is_saved() {
        let folder = tempfile::tempdir().unwrap();
        let mut gone = Copies::new(folder.path().into());
        let path = gone.own().unwrap().to_owned();
        write(&path);
        let about = CopyNote { frame: 30, project: Some("a.backlit".into()), ..CopyNote::default() };
        about.write(&path).unwrap();
        drop(gone);
        let (mut one, mut other) = (Copies::new(folder.path().into()), Copies::new(folder.path().into()));
        let left = one.left().0.remove(0);
        assert_eq!(left.about, about);
        assert!(left.saved.is_some() && left.picture.is_none());
        assert!(one.adopt(&path).unwrap() && !other.adopt(&path).unwrap());
        one.forget();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_process_that_is_being_started_keeps_no_lock() {
        let folder = tempfile::tempdir().unwrap();
        let copy = folder.path().join("unsaved.backlit");
        let held = lock(&copy).unwrap().unwrap();
        // Both have the same open file, as this process and one that it has just forked.
        let forked = held.0.try_clone().unwrap();
        drop(held);
        assert!(lock(&copy).unwrap().is_some());
        drop(forked);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_in_the_place_of_copies_and_locks_are_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let mut copies = Copies::new(folder.path().into());
        let [copy, locked] = ["unsaved-4.backlit", "unsaved-7.backlit"].map(|name| folder.path().join(name));
        write(&locked);
        for pipe in [copy, lock_path(&locked), lock_path(&folder.path().join("unsaved.backlit"))] {
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        }
        let (left, wrong) = copies.left();
        assert!(left.is_empty(), "nobody knows whether its window is alive");
        assert_eq!(wrong.len(), 1);
        assert!(wrong[0].to_string().contains("unsaved-4.backlit: "), "{}", wrong[0]);
        // The first free copy cannot be locked: that is an error, or another one is taken.
        if let Ok(own) = copies.own() {
            assert_ne!(own.file_name().unwrap(), "unsaved.backlit");
        }
    }

    #[test]
    fn what_is_left_is_put_aside_and_what_is_broken_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let copies = Copies::new(folder.path().into());
        let path = folder.path().join("unsaved-7.backlit");
        write(&path);
        std::fs::write(folder.path().join("unsaved.backlit"), "{").unwrap();
        let (left, wrong) = copies.left();
        assert_eq!((left.len(), wrong.len()), (1, 1));
        let about = CopyNote { frame: 7, ..CopyNote::default() };
        about.write(&path).unwrap();
        let aside = copies.put_aside(&path).unwrap();
        assert!(read_project(&aside).is_ok());
        assert!(copies.left().0.is_empty());
        copies.bring_back(&aside).unwrap();
        assert_eq!(copies.left().0[0].about, about, "it is offered as it was");
        assert!(!aside.exists());
        assert!(
            folder.path().join("unsaved.backlit").exists(),
            "a broken copy may still be of use to somebody"
        );
    }
}
