//! Undo and redo by snapshots.
//!
//! A snapshot shares what did not change. All edits of one gesture (a drag, a run of the fit, a run of the
//! tracker) are one entry. So are runs that were removed; whatever else happens to runs is no entry.

use crate::Document;
use crate::edit::{Edit, EditError};
use crate::run::Run;
use crate::runs::{BROUGHT_BACK, RunChange, Runs};

/// Names a group of edits that are undone together. Each drag and each run has a number of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Gesture(pub u64);

/// What a file may hold: the same version means the same document and the same runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Version {
    document: u64,
    runs: u64,
}

impl Version {
    /// One that no window has.
    pub const NONE: Self = Self { document: u64::MAX, runs: 0 };
}

/// A document with its past and its undone future, and the runs of the fit.
#[derive(Debug, Clone)]
pub struct History {
    document: Document,
    runs: Runs,
    undo: Vec<UndoEntry>,
    redo: Vec<Snapshot>,
    /// Gesture of the newest entry, as long as it may grow.
    open: Option<Gesture>,
    revision: u64,
    next_revision: u64,
    /// Changes of the runs that a file keeps.
    runs_revision: u64,
    saved: Option<Version>,
}

/// A document that can be gone back to, and what led away from it.
#[derive(Debug, Clone)]
struct Snapshot {
    document: Document,
    revision: u64,
    what: String,
}

#[derive(Debug, Clone)]
enum UndoEntry {
    /// A change of the document.
    Document(Box<Snapshot>),
    /// Runs that were removed.
    Runs(Vec<Run>),
}

impl UndoEntry {
    fn snapshot(&self) -> Option<&Snapshot> {
        match self {
            Self::Document(snapshot) => Some(snapshot),
            Self::Runs(_) => None,
        }
    }
}

/// Most entries kept; the oldest are forgotten.
const MAX_ENTRIES: usize = 500;

impl History {
    /// Begins with a document that needs no saving.
    pub fn new(document: Document) -> Self {
        Self {
            document,
            runs: Runs::default(),
            undo: Vec::new(),
            redo: Vec::new(),
            open: None,
            revision: 0,
            next_revision: 1,
            runs_revision: 0,
            saved: Some(Version::default()),
        }
    }

    /// Begins with a document that is in no file.
    pub fn unsaved(document: Document) -> Self {
        Self { saved: None, ..Self::new(document) }
    }

    /// The same with these runs, which a file holds.
    pub fn with_runs(self, runs: Vec<Run>) -> Self {
        Self { runs: Runs::of(runs), ..self }
    }

    /// The same document, as one that needs no saving, with its runs and without its past.
    pub fn without_past(&self) -> Self {
        Self { runs: self.runs.clone(), ..Self::new(self.document.clone()) }
    }

    /// The document as it is now.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The runs of the fit.
    pub fn runs(&self) -> &Runs {
        &self.runs
    }

    /// Changes with every edit, undo and redo; the same number means the same document.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// What a file would hold now.
    pub fn version(&self) -> Version {
        Version { document: self.revision, runs: self.runs_revision }
    }

    /// Makes a change that can be undone. With the gesture of the change before, both are one entry.
    pub fn apply(&mut self, edit: Edit, gesture: Option<Gesture>) -> Result<(), EditError> {
        let before = self.document.clone();
        let what = edit.text();
        self.document.apply(edit)?;
        if self.document == before {
            return Ok(());
        }
        let grows = gesture.is_some() && gesture == self.open && self.newest_edit().is_some();
        if !grows {
            let snapshot = Snapshot { document: before, revision: self.revision, what };
            self.remember(UndoEntry::Document(Box::new(snapshot)));
        }
        self.open = gesture;
        self.redo.clear();
        self.revision = self.next_revision;
        self.next_revision += 1;
        Ok(())
    }

    /// Changes the runs. Only their removal can be undone.
    pub fn change_runs(&mut self, change: RunChange) {
        if !matches!(change, RunChange::Show(..) | RunChange::ShowOnly(_)) {
            self.runs_revision += 1;
        }
        if change == RunChange::Restore {
            let newest = self.undo.iter().rposition(|entry| entry.snapshot().is_none());
            if let Some(UndoEntry::Runs(removed)) = newest.map(|index| self.undo.remove(index)) {
                self.runs.bring_back(removed);
            }
            return;
        }
        let removed = self.runs.apply(change);
        if !removed.is_empty() {
            self.remember(UndoEntry::Runs(removed));
        }
    }

    /// Goes back to before the newest entry. Says what was undone, in a sentence.
    pub fn undo(&mut self) -> Option<String> {
        Some(match self.undo.pop()? {
            UndoEntry::Document(snapshot) => {
                let left = self.go(*snapshot);
                let said = format!("Undone: {}.", left.what);
                self.redo.push(left);
                said
            }
            UndoEntry::Runs(removed) => {
                self.runs_revision += 1;
                self.runs.bring_back(removed);
                BROUGHT_BACK.to_owned()
            }
        })
    }

    /// Takes back the last undo of a change of the document. Says what was done again, in a sentence.
    pub fn redo(&mut self) -> Option<String> {
        let snapshot = self.redo.pop()?;
        let left = self.go(snapshot);
        let said = format!("Redone: {}.", left.what);
        self.undo.push(UndoEntry::Document(Box::new(left)));
        Some(said)
    }

    /// Whether there is something to [`undo`](Self::undo).
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Whether [`undo`](Self::undo) would bring runs back and leave the document as it is.
    pub fn undo_brings_runs_back(&self) -> bool {
        matches!(self.undo.last(), Some(UndoEntry::Runs(_)))
    }

    /// Whether runs were removed that can be brought back.
    pub fn has_removed_runs(&self) -> bool {
        self.undo.iter().any(|entry| entry.snapshot().is_none())
    }

    /// The newest change of the document that can be undone.
    pub fn undo_text(&self) -> Option<&str> {
        let newest = self.undo[self.newest_edit()?].snapshot()?;
        Some(&newest.what)
    }

    /// What [`redo`](Self::redo) would do again.
    pub fn redo_text(&self) -> Option<&str> {
        self.redo.last().map(|snapshot| snapshot.what.as_str())
    }

    /// Undoes everything of a gesture that is still open, and forgets it: Esc in a drag. Whether there was anything.
    pub fn cancel(&mut self, gesture: Gesture) -> bool {
        let is_open = self.open.take() == Some(gesture);
        let Some(newest) = self.newest_edit().filter(|_| is_open) else { return false };
        if let UndoEntry::Document(snapshot) = self.undo.remove(newest) {
            self.go(*snapshot);
        }
        true
    }

    /// Says that this version is in its file.
    pub fn mark_saved(&mut self, version: Version) {
        self.saved = Some(version);
        self.open = None;
    }

    /// Whether there is work that is in no file.
    pub fn is_dirty(&self) -> bool {
        self.saved != Some(self.version())
    }

    /// Puts a snapshot in the place of the document, which is returned as one.
    fn go(&mut self, to: Snapshot) -> Snapshot {
        self.open = None;
        let document = std::mem::replace(&mut self.document, to.document);
        let revision = std::mem::replace(&mut self.revision, to.revision);
        Snapshot { document, revision, what: to.what }
    }

    fn newest_edit(&self) -> Option<usize> {
        self.undo.iter().rposition(|entry| entry.snapshot().is_some())
    }

    fn remember(&mut self, entry: UndoEntry) {
        self.undo.push(entry);
        if self.undo.len() > MAX_ENTRIES {
            self.undo.remove(0);
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use glam::DVec3;

    use super::*;
    use crate::run::RunEnding;

    fn empty() -> History {
        History::new(Document::new(builtin::single_limb()))
    }

    fn go_to(history: &mut History, x: f64, gesture: Option<u64>) {
        let mut pose = history.document().pose_at(0).clone();
        pose.root = DVec3::new(x, 0.0, 0.0);
        let edit = Edit::SetPose { frame: 0, pose, what: "Move body".to_owned() };
        history.apply(edit, gesture.map(Gesture)).unwrap();
    }

    fn root_x(history: &History) -> f64 {
        history.document().pose_at(0).root.x
    }

    #[test]
    fn a_drag_is_one_entry() {
        let mut history = empty();
        for step in 1..=5 {
            go_to(&mut history, f64::from(step), Some(7));
        }
        go_to(&mut history, 9.0, Some(8));
        assert_eq!(history.undo(), Some("Undone: Move body.".to_owned()));
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
        let mut history = empty();
        assert!(!history.is_dirty());
        go_to(&mut history, 1.0, None);
        assert!(history.is_dirty());
        history.mark_saved(history.version());
        history.undo();
        assert!(history.is_dirty());
        history.redo();
        assert!(!history.is_dirty());
        history.change_runs(RunChange::Begin(Box::new(Run { number: 1, ..Run::default() })));
        assert!(history.is_dirty(), "a file keeps runs too");
        history.mark_saved(history.version());
        history.change_runs(RunChange::Show(1, true));
        assert!(!history.is_dirty(), "which curves are drawn is no work");
    }

    #[test]
    fn a_drag_that_is_cancelled_leaves_nothing() {
        let mut history = empty();
        go_to(&mut history, 1.0, Some(1));
        assert!(history.cancel(Gesture(1)) && !history.cancel(Gesture(1)));
        assert_eq!((root_x(&history), history.undo_text(), history.is_dirty()), (0.0, None, false));
    }

    #[test]
    fn what_changes_nothing_is_no_entry() {
        let mut history = empty();
        history.apply(Edit::Pin { limb: 0, pinned: false }, None).unwrap();
        assert_eq!(history.undo_text(), None);
        assert!(history.apply(Edit::Pin { limb: 5, pinned: true }, None).is_err());
        assert_eq!(history.undo_text(), None);
    }

    fn with_runs(numbers: std::ops::RangeInclusive<usize>) -> History {
        let mut history = empty();
        for number in numbers {
            assert_eq!(history.runs().next_number(), number);
            let run = Run { number, is_shown: true, ..Run::default() };
            history.change_runs(RunChange::Begin(Box::new(run)));
        }
        history
    }

    fn numbers(history: &History) -> Vec<usize> {
        history.runs().all().iter().map(|run| run.number).collect()
    }

    #[test]
    fn removed_runs_come_back_in_their_turn_and_are_no_change_of_the_document() {
        let mut history = with_runs(1..=3);
        assert!(!history.can_undo(), "to begin a run is no entry");
        go_to(&mut history, 1.0, Some(7));
        let revision = history.revision();
        history.change_runs(RunChange::Remove(2));
        assert_eq!((history.revision(), history.undo_text()), (revision, Some("Move body")));
        go_to(&mut history, 2.0, Some(7));
        history.change_runs(RunChange::Clear);
        assert_eq!(numbers(&history), [0; 0]);
        assert_eq!((history.undo(), numbers(&history)), (Some(BROUGHT_BACK.to_owned()), vec![1, 3]));
        assert_eq!((history.undo(), numbers(&history)), (Some(BROUGHT_BACK.to_owned()), vec![1, 2, 3]));
        assert_eq!((history.redo_text(), root_x(&history)), (None, 2.0));
        history.undo();
        assert_eq!((root_x(&history), history.can_undo()), (0.0, false), "both moves are one gesture");
    }

    #[test]
    fn the_newest_removal_comes_back_past_later_edits_and_beside_later_runs() {
        let mut history = with_runs(1..=2);
        history.change_runs(RunChange::Clear);
        go_to(&mut history, 1.0, None);
        let run = Run { number: history.runs().next_number(), ..Run::default() };
        history.change_runs(RunChange::Begin(Box::new(run)));
        assert!(history.has_removed_runs() && !history.undo_brings_runs_back());
        history.change_runs(RunChange::Restore);
        assert_eq!((numbers(&history), root_x(&history)), (vec![1, 2, 3], 1.0));
        let stopped = |number| history.runs().get(number).unwrap().ending == Some(RunEnding::Stopped);
        assert!(stopped(1) && !stopped(3) && !history.has_removed_runs());
    }
}
