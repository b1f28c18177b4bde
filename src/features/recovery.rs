//! Copies of unsaved work, for the next start.

mod copies;
mod left;
mod panel;
mod update;

pub use copies::Copies;
pub(crate) use left::{CopyNote, Thumbnail, UnsavedCopy};

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use backlit_document::history::Version;
use backlit_document::project::ProjectError;
use backlit_jobs::Task;

use crate::context::priority;

#[derive(Debug, Default)]
pub(crate) struct Recovery {
    /// `None` without a folder for them.
    copies: Option<Copies>,
    /// What earlier windows have left and the user has not decided about.
    pub(crate) offered: Vec<UnsavedCopy>,
    /// Whether the user wants to decide later.
    is_put_off: bool,
    /// The copies that a notice has told of.
    told: BTreeSet<PathBuf>,
    /// Writes a version to the copy.
    task: Task<Version, Result<(), ProjectError>, { priority::SAVE }>,
    /// Held while the copy is being written.
    writing: Arc<Mutex<()>>,
    /// The version that is in the copy.
    written: Option<Version>,
    /// Whether the picture beside the copy is of an older pose.
    is_picture_old: bool,
    /// When the copy was begun to be written last, and whether that failed.
    begun: Option<Instant>,
    failed: bool,
    /// Whether the window was told not to close, since its work could not be kept.
    has_stayed_open: bool,
    /// The copy that is being opened.
    adopted: Option<UnsavedCopy>,
    /// The copies that were discarded last: where they are now.
    discarded: Vec<PathBuf>,
}

impl Recovery {
    /// Copies in a folder; without one nothing is kept.
    pub(crate) fn new(folder: Option<PathBuf>) -> Self {
        Self { copies: folder.map(Copies::new), ..Self::default() }
    }

    /// Whether there is any that the user has not put off.
    pub(crate) const fn is_offered(&self) -> bool {
        !self.offered.is_empty() && !self.is_put_off
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::testing::{Breaks, open};
    use crate::context::preferences::Layout;

    #[test]
    fn a_copy_that_breaks_down_is_said_once() {
        let mut app = open(Layout::Pose);
        app.break_down(|all, pool| all.features.recovery.task.begin(pool, Version::NONE, |_| Breaks));
        assert_eq!(app.errors(), ["Writing a file broke down: thirteen. Your work is unharmed."]);
    }
}
