//! Undo and redo by snapshots.
//!
//! A snapshot shares what did not change. All edits of one gesture (a drag, a run of the fit, a run of the
//! tracker) are one entry.

use crate::document::Document;
use crate::document::edit::{Edit, EditError};

/// Names a group of edits that are undone together. Each drag and each run has a number of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Gesture(pub u64);

/// A document with its past and its undone future.
#[derive(Debug, Clone)]
pub struct History {
    document: Document,
    undo: Vec<Entry>,
    redo: Vec<Entry>,
    /// Gesture of the newest entry, as long as it may grow.
    open: Option<Gesture>,
    revision: u64,
    next_revision: u64,
    saved: Option<u64>,
}

/// A state that can be gone back to, and what led away from it.
#[derive(Debug, Clone)]
struct Entry {
    document: Document,
    revision: u64,
    what: String,
}

/// Most entries kept; the oldest are forgotten.
const MAX_ENTRIES: usize = 500;

impl History {
    /// Begins with a document that needs no saving.
    #[must_use]
    pub fn new(document: Document) -> Self {
        Self {
            document,
            undo: Vec::new(),
            redo: Vec::new(),
            open: None,
            revision: 0,
            next_revision: 1,
            saved: Some(0),
        }
    }

    /// Begins with a document that is in no file.
    #[must_use]
    pub fn unsaved(document: Document) -> Self {
        Self { saved: None, ..Self::new(document) }
    }

    /// The document as it is now.
    #[must_use]
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Changes with every edit, undo and redo; the same number means the same document.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Makes a change that can be undone. With the gesture of the change before, both are one entry.
    ///
    /// # Errors
    /// See [`Document::apply`]; nothing has changed then.
    pub fn apply(&mut self, edit: Edit, gesture: Option<Gesture>) -> Result<(), EditError> {
        let before = self.document.clone();
        let what = edit.text();
        self.document.apply(edit)?;
        if self.document == before {
            return Ok(());
        }
        let grows = gesture.is_some() && gesture == self.open && !self.undo.is_empty();
        if !grows {
            self.undo.push(Entry { document: before, revision: self.revision, what });
            if self.undo.len() > MAX_ENTRIES {
                self.undo.remove(0);
            }
        }
        self.open = gesture;
        self.redo.clear();
        self.revision = self.next_revision;
        self.next_revision += 1;
        Ok(())
    }

    /// Goes back to before the newest entry and says what was undone.
    pub fn undo(&mut self) -> Option<String> {
        let entry = self.undo.pop()?;
        Some(self.go(entry, |this| &mut this.redo))
    }

    /// Takes back the last undo and says what was done again.
    pub fn redo(&mut self) -> Option<String> {
        let entry = self.redo.pop()?;
        Some(self.go(entry, |this| &mut this.undo))
    }

    /// What [`undo`](Self::undo) would undo.
    #[must_use]
    pub fn undo_text(&self) -> Option<&str> {
        self.undo.last().map(|entry| entry.what.as_str())
    }

    /// What [`redo`](Self::redo) would do again.
    #[must_use]
    pub fn redo_text(&self) -> Option<&str> {
        self.redo.last().map(|entry| entry.what.as_str())
    }

    /// Undoes everything of a gesture that is still open, and forgets it: Esc in a drag. Whether there was anything.
    pub fn cancel(&mut self, gesture: Gesture) -> bool {
        let is_open = self.open.take() == Some(gesture);
        let Some(entry) = self.undo.pop_if(|_| is_open) else { return false };
        self.document = entry.document;
        self.revision = entry.revision;
        true
    }

    /// Says that the document of this revision is in its file.
    pub fn mark_saved(&mut self, revision: u64) {
        self.saved = Some(revision);
        self.open = None;
    }

    /// Whether there is work that is in no file.
    #[must_use]
    pub fn is_dirty(&self) -> bool {
        self.saved != Some(self.revision)
    }

    /// Makes a change that is not the user's and cannot be undone, in the past too: the take that was opened
    /// tells its cameras.
    pub fn amend(&mut self, change: impl Fn(&mut Document)) {
        change(&mut self.document);
        for entry in self.undo.iter_mut().chain(&mut self.redo) {
            change(&mut entry.document);
        }
    }

    fn go(&mut self, entry: Entry, side: impl FnOnce(&mut Self) -> &mut Vec<Entry>) -> String {
        let document = std::mem::replace(&mut self.document, entry.document);
        let revision = std::mem::replace(&mut self.revision, entry.revision);
        self.open = None;
        side(self).push(Entry { document, revision, what: entry.what.clone() });
        entry.what
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use glam::DVec3;

    use super::*;

    fn moved(document: &Document, x: f64) -> Edit {
        let mut pose = document.pose_at(0).clone();
        pose.root = DVec3::new(x, 0.0, 0.0);
        Edit::SetPose { frame: 0, pose, what: "Move body".to_owned() }
    }

    fn root_x(history: &History) -> f64 {
        history.document().pose_at(0).root.x
    }

    #[test]
    fn a_drag_is_one_entry() {
        let mut history = History::new(Document::new(builtin::single_limb()));
        for step in 1..=5 {
            let edit = moved(history.document(), f64::from(step));
            history.apply(edit, Some(Gesture(7))).unwrap();
        }
        let edit = moved(history.document(), 9.0);
        history.apply(edit, Some(Gesture(8))).unwrap();
        assert_eq!(history.undo().as_deref(), Some("Move body"));
        assert_eq!(root_x(&history), 5.0);
        history.undo();
        assert_eq!(root_x(&history), 0.0);
        assert_eq!(history.undo(), None);
        history.redo();
        history.redo();
        assert_eq!(root_x(&history), 9.0);
        assert_eq!(history.redo(), None);
    }

    #[test]
    fn the_saved_mark_follows_undo_and_redo() {
        let mut history = History::new(Document::new(builtin::single_limb()));
        assert!(!history.is_dirty());
        let edit = moved(history.document(), 1.0);
        history.apply(edit, None).unwrap();
        assert!(history.is_dirty());
        history.mark_saved(history.revision());
        history.undo();
        assert!(history.is_dirty());
        history.redo();
        assert!(!history.is_dirty());
    }

    #[test]
    fn a_drag_that_is_cancelled_leaves_nothing() {
        let mut history = History::new(Document::new(builtin::single_limb()));
        let edit = moved(history.document(), 1.0);
        history.apply(edit, Some(Gesture(1))).unwrap();
        assert!(history.cancel(Gesture(1)) && !history.cancel(Gesture(1)));
        assert_eq!((root_x(&history), history.undo_text(), history.is_dirty()), (0.0, None, false));
    }

    #[test]
    fn what_changes_nothing_is_no_entry() {
        let mut history = History::new(Document::new(builtin::single_limb()));
        history.apply(Edit::Pin { limb: 0, pinned: false }, None).unwrap();
        assert_eq!(history.undo_text(), None);
        assert!(history.apply(Edit::Pin { limb: 5, pinned: true }, None).is_err());
        assert_eq!(history.undo_text(), None);
    }
}
