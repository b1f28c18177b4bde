//! Copies of unsaved work, for the next start.
//!
//! Every window writes a copy of its own, `unsaved.backlit`, `unsaved-2.backlit` and so on, and holds a lock on the
//! file beside it for as long as it lives. The system lets go of the lock however the program ends: a copy whose
//! lock is free was left by a window that is gone. A copy is never written over by another window or about another
//! take; what the user leaves is put aside under another name.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use backlit_tracking::io::atomic;
use serde::{Deserialize, Serialize};

use crate::document::{Document, TakeSource};
use crate::project::{ProjectError, read_project};

/// Beginning of a copy's name.
const NAME: &str = "unsaved";
/// Beginning of the name of a copy that was put aside.
const ASIDE: &str = "left";
/// Ending of a copy's name.
const ENDING: &str = "backlit";
/// So many windows can be open at once, or have left something.
const MOST: usize = 200;
/// Copies that were put aside are kept, the newest so many.
const MOST_ASIDE: usize = 20;

/// What a copy's project does not say.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct About {
    /// The frame on the screen.
    pub frame: usize,
    /// The project file that the work belongs to.
    pub project: Option<PathBuf>,
}

impl About {
    /// Writes it beside a copy.
    ///
    /// # Errors
    /// The file system says no.
    pub fn write(&self, copy: &Path) -> Result<(), ProjectError> {
        let path = about_path(copy);
        let json =
            serde_json::to_vec(self).map_err(|source| ProjectError::Json { path: path.clone(), source })?;
        Ok(atomic::write(&path, &json)?)
    }

    /// What was written beside a copy; nothing is known if that cannot be read.
    #[must_use]
    pub fn read(copy: &Path) -> Self {
        let text = std::fs::read(about_path(copy)).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }
}

fn about_path(copy: &Path) -> PathBuf {
    copy.with_extension("about.json")
}

fn lock_path(copy: &Path) -> PathBuf {
    copy.with_extension("lock")
}

/// Work that a window has left.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// The copy.
    pub path: PathBuf,
    /// When it was written last.
    pub saved: Option<SystemTime>,
    /// Where the user was.
    pub about: About,
    /// What it is about: "the built-in take, 3 poses".
    pub what: String,
}

impl Left {
    /// What is offered, in a sentence without its full stop. There is no calendar here: the time is how long ago.
    #[must_use]
    pub fn text(&self, now: SystemTime) -> String {
        let ago = self.saved.and_then(|saved| now.duration_since(saved).ok()).map(|ago| ago.as_secs());
        let when = match ago {
            None => "some time ago".to_owned(),
            Some(0..=89) => "a minute ago".to_owned(),
            Some(seconds @ 90..=5399) => format!("{} minutes ago", (seconds + 30) / 60),
            Some(seconds @ 5400..=129_599) => format!("{} hours ago", (seconds + 1800) / 3600),
            Some(seconds) => format!("{} days ago", (seconds + 43_200) / 86_400),
        };
        format!("Work from {when}, frame {}: {}", self.about.frame, self.what)
    }
}

/// The copies in a folder, and the one that this window writes.
#[derive(Debug)]
pub struct Copies {
    folder: PathBuf,
    own: Option<Own>,
}

#[derive(Debug)]
struct Own {
    path: PathBuf,
    /// Held as long as this window lives.
    _lock: File,
}

impl Copies {
    /// The copies in a folder, which is made when the first is written.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, own: None }
    }

    /// This window's copy: the first name that is free.
    ///
    /// # Errors
    /// The folder cannot be made or written.
    pub fn own(&mut self) -> io::Result<&Path> {
        if self.own.is_none() {
            std::fs::create_dir_all(&self.folder)?;
            self.own = Some(self.claim_free()?);
        }
        match &self.own {
            Some(own) => Ok(&own.path),
            None => Err(io::ErrorKind::NotFound.into()),
        }
    }

    fn claim_free(&self) -> io::Result<Own> {
        for number in 1..=MOST {
            let name = if number == 1 { NAME.to_owned() } else { format!("{NAME}-{number}") };
            let path = self.folder.join(name).with_extension(ENDING);
            // First the lock: between a look and a lock another window could have come.
            if let Some(lock) = lock(&path)?
                && !path.exists()
            {
                return Ok(Own { path, _lock: lock });
            }
        }
        Err(io::Error::other(format!("there are {MOST} copies already")))
    }

    /// Whether a path is this window's copy.
    #[must_use]
    pub fn is_own(&self, path: &Path) -> bool {
        self.own.as_ref().is_some_and(|own| own.path == path)
    }

    /// Goes on with a copy that was left: this window writes it from now on. Not if another window was quicker.
    ///
    /// # Errors
    /// The lock cannot be made.
    pub fn adopt(&mut self, path: &Path) -> io::Result<bool> {
        let Some(lock) = lock(path)? else { return Ok(false) };
        self.own = Some(Own { path: path.to_owned(), _lock: lock });
        Ok(true)
    }

    /// Leaves this window's copy as it is: what comes next is about something else and has a copy of its own.
    pub fn leave(&mut self) {
        self.own = None;
    }

    /// Removes this window's copy: everything in it is saved.
    pub fn forget(&mut self) {
        if let Some(own) = self.own.take() {
            for path in [own.path.clone(), about_path(&own.path), lock_path(&own.path)] {
                // There may be none.
                let _ = std::fs::remove_file(path);
            }
        }
    }

    /// What windows that are gone have left, the newest first, and what cannot be read.
    #[must_use]
    pub fn left(&self) -> (Vec<Left>, Vec<ProjectError>) {
        let (mut found, mut wrong) = (Vec::new(), Vec::new());
        for path in self.files(NAME) {
            if self.is_own(&path) || !matches!(lock(&path), Ok(Some(_))) {
                continue;
            }
            match read_project(&path) {
                Ok(document) => found.push(Left {
                    saved: std::fs::metadata(&path).and_then(|data| data.modified()).ok(),
                    about: About::read(&path),
                    what: what_of(&document),
                    path,
                }),
                Err(error) => wrong.push(error),
            }
        }
        found.sort_by_key(|left| std::cmp::Reverse(left.saved));
        (found, wrong)
    }

    /// Puts a copy aside: it is offered no more, and can still be opened as a project. Says where it is.
    ///
    /// # Errors
    /// It cannot be renamed.
    pub fn put_aside(&self, copy: &Path) -> io::Result<PathBuf> {
        let free = (1..)
            .map(|number| self.folder.join(format!("{ASIDE}-{number}")).with_extension(ENDING))
            .find(|path| !path.exists())
            .unwrap_or_else(|| self.folder.join(ASIDE));
        std::fs::rename(copy, &free)?;
        for path in [about_path(copy), lock_path(copy)] {
            let _ = std::fs::remove_file(path);
        }
        let mut aside = self.files(ASIDE);
        aside.sort_by_key(|path| std::fs::metadata(path).and_then(|data| data.modified()).ok());
        for old in aside.iter().rev().skip(MOST_ASIDE) {
            let _ = std::fs::remove_file(old);
        }
        Ok(free)
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

/// The lock of a copy; `None` if another window holds it.
fn lock(copy: &Path) -> io::Result<Option<File>> {
    let file = File::options().create(true).write(true).truncate(false).open(lock_path(copy))?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Ok(None),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

fn what_of(document: &Document) -> String {
    let place = match &document.take {
        Some(TakeSource::Path(path)) => {
            path.file_name().map_or_else(|| "a take".into(), |name| name.to_string_lossy().into_owned())
        }
        Some(TakeSource::Demonstration(which)) => format!("the demonstration \"{}\"", which.name()),
        _ => "the built-in take".to_owned(),
    };
    let mut frames: Vec<usize> = document.estimates.keys().chain(document.keys.keys()).copied().collect();
    frames.sort_unstable();
    frames.dedup();
    let plural = if frames.len() == 1 { "" } else { "s" };
    format!("{place}, {} frame{plural} with a pose", frames.len())
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use backlit_tracking::body::builtin;

    use super::*;
    use crate::project::write_project;

    fn write(path: &Path) {
        let mut document = Document::new(builtin::single_limb());
        document.take = Some(TakeSource::BuiltIn);
        write_project(path, &document).unwrap();
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
        About { frame: 30, project: Some("a.backlit".into()) }.write(&path).unwrap();
        drop(gone);
        let (mut one, mut other) = (Copies::new(folder.path().into()), Copies::new(folder.path().into()));
        let left = one.left().0.remove(0);
        assert_eq!(left.about, About { frame: 30, project: Some("a.backlit".into()) });
        let text = left.text(left.saved.unwrap() + Duration::from_secs(720));
        assert_eq!(text, "Work from 12 minutes ago, frame 30: the built-in take, 0 frames with a pose");
        assert!(one.adopt(&path).unwrap() && !other.adopt(&path).unwrap());
        one.forget();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
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
        let aside = copies.put_aside(&path).unwrap();
        assert!(read_project(&aside).is_ok());
        assert!(copies.left().0.is_empty());
        assert!(
            folder.path().join("unsaved.backlit").exists(),
            "a broken copy may still be of use to somebody"
        );
    }
}
