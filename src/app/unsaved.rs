//! The copy of unsaved work, and what earlier windows have left.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::App;
use super::state::Opening;
use crate::project::write_project;
use crate::recovery::{About, Copies, Left};
use crate::worker::Lane;

/// The copy is written this often while there is something new: with the time of writing, less than a second of work
/// can be lost.
const EVERY: Duration = Duration::from_millis(500);
/// After a failure it is tried again this late.
const AGAIN: Duration = Duration::from_secs(10);

/// The revision of a copy that was left: none of this window's.
const OLDER: u64 = u64::MAX;

/// The copies of unsaved work.
#[derive(Debug, Default)]
pub(super) struct Unsaved {
    /// `None` without a folder for them.
    copies: Option<Copies>,
    /// What earlier windows have left and the user has not decided about.
    pub(super) offered: Vec<Left>,
    /// The revision that is in the copy.
    written: Option<u64>,
    /// When the copy was begun to be written last, and whether that failed.
    begun: Option<Instant>,
    failed: bool,
    /// The copy that is being opened.
    adopted: Option<Left>,
}

impl Unsaved {
    pub(super) fn new(folder: Option<PathBuf>) -> Self {
        Self { copies: folder.map(Copies::new), ..Self::default() }
    }
}

impl App {
    /// Looks for what earlier windows have left.
    pub(super) fn look_for_unsaved_work(&mut self) {
        let Some(copies) = &self.unsaved.copies else { return };
        let (left, wrong) = copies.left();
        self.unsaved.offered = left;
        for error in wrong {
            self.notices
                .error(format!("A copy of unsaved work cannot be read, and is left where it is: {error}."));
        }
    }

    fn about(&self) -> About {
        About { frame: self.selection.frame, project: self.project.clone() }
    }

    /// Writes the copy of unsaved work soon after every change; removes it when there is nothing unsaved.
    pub(super) fn autosave(&mut self) {
        let revision = self.history.revision();
        let (dirty, has_take) = (self.history.is_dirty(), self.document().take.is_some());
        let about = self.about();
        let unsaved = &mut self.unsaved;
        let Some(copies) = &mut unsaved.copies else { return };
        if self.worker.is_busy(Lane::Save) || self.worker.is_busy(Lane::Open) {
            return;
        }
        if !dirty {
            // A document that was just opened, or one that is in its file as it is.
            if unsaved.written.take().is_some() {
                copies.forget();
            }
            return;
        }
        if !has_take || unsaved.written == Some(revision) {
            return;
        }
        let every = if unsaved.failed { AGAIN } else { EVERY };
        let wait = unsaved.begun.map_or(Duration::ZERO, |begun| every.saturating_sub(begun.elapsed()));
        if !wait.is_zero() {
            self.context.request_repaint_after(wait);
            return;
        }
        unsaved.begun = Some(Instant::now());
        match copies.own().map(std::path::Path::to_owned) {
            Ok(path) => {
                let job = self.save_job(path, Some(about));
                self.worker.request(Lane::Save, job);
            }
            Err(error) => self.copy_failed(&error.to_string()),
        }
    }

    pub(super) fn copy_saved(&mut self, revision: u64) {
        self.unsaved.written = Some(revision);
        self.unsaved.failed = false;
    }

    pub(super) fn copy_failed(&mut self, why: &str) {
        self.unsaved.failed = true;
        self.notices
            .error(format!("The copy of unsaved work was not written: {why}. Save the project soon."));
    }

    /// Writes the copy at once, when the window closes or something else is opened.
    pub(super) fn keep_unsaved_work(&mut self) {
        if !self.history.is_dirty() || self.document().take.is_none() {
            if let Some(copies) = self.unsaved.copies.as_mut().filter(|_| self.unsaved.written.is_some()) {
                copies.forget();
            }
            return;
        }
        let about = self.about();
        let Some(copies) = &mut self.unsaved.copies else { return };
        let path = copies.own().map(std::path::Path::to_owned);
        let written = path.map_err(|error| error.to_string()).and_then(|path| {
            let written = write_project(&path, self.history.document()).and_then(|()| about.write(&path));
            written.map_err(|error| error.to_string())
        });
        if let Err(why) = written {
            self.copy_failed(&why);
        }
    }

    /// Goes on with work that was left, or puts all of it aside and opens what was to be opened.
    pub(super) fn recover(&mut self, which: Option<usize>) {
        let Some(index) = which else {
            let offered = std::mem::take(&mut self.unsaved.offered);
            for left in offered {
                let aside = self.unsaved.copies.as_ref().map(|copies| copies.put_aside(&left.path));
                match aside {
                    Some(Ok(path)) => {
                        let text = format!("Put aside: {} can be opened as a project.", path.display());
                        self.notices.info(self.now, text, None);
                    }
                    Some(Err(error)) => self.notices.error(format!("It cannot be put aside: {error}.")),
                    None => {}
                }
            }
            if let Some(opening) = self.postponed.take() {
                self.open(opening);
            }
            return;
        };
        if let Some(left) = self.unsaved.offered.get(index).cloned() {
            self.unsaved.offered.clear();
            self.unsaved.adopted = Some(left.clone());
            self.open(Opening::Project(left.path));
        }
    }

    /// Something was opened: the copy of what was there before stays as it is. Says whether it is work that was
    /// left, and what is known about that.
    pub(super) fn begin_copy(&mut self, opened: Option<&std::path::Path>) -> Option<About> {
        self.unsaved.written = None;
        self.unsaved.begun = None;
        self.unsaved.failed = false;
        let copies = self.unsaved.copies.as_mut()?;
        copies.leave();
        let left = self.unsaved.adopted.take().filter(|left| Some(left.path.as_path()) == opened)?;
        // If another window was quicker, this one writes a copy of its own.
        if copies.adopt(&left.path).unwrap_or(false) {
            self.unsaved.written = Some(OLDER);
        }
        Some(left.about)
    }
}
