//! The copy of unsaved work, and what earlier windows have left.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::app::App;
use crate::app::state::Opening;
use crate::context::Recovery;
use crate::context::command::{Command, FileCommand, RecoveryCommand};
use crate::document::project::write_project;
use crate::features::recovery::panel::Offer;
use crate::features::recovery::{About, Copies, Left, Picture};
use crate::take::source::TakeSource;
use crate::worker::Lane;

/// The copy is written this often while there is something new: with the time of writing, less than a second of work
/// can be lost.
const EVERY: Duration = Duration::from_millis(500);
/// After a failure it is tried again this late.
const AGAIN: Duration = Duration::from_secs(2);

/// What is said of a copy that is not written.
const COPY: &str = "The copy of unsaved work was not written";

/// The revision of a copy that was left: none of this window's.
const OLDER: u64 = u64::MAX;

/// The copies of unsaved work.
#[derive(Debug, Default)]
pub(crate) struct Unsaved {
    /// `None` without a folder for them.
    copies: Option<Copies>,
    /// What earlier windows have left and the user has not decided about.
    pub(crate) offered: Vec<Left>,
    /// The revision that is in the copy.
    written: Option<u64>,
    /// Whether the picture beside the copy is of an older pose.
    is_picture_old: bool,
    /// When the copy was begun to be written last, and whether that failed.
    begun: Option<Instant>,
    failed: bool,
    /// Whether the window was told not to close, since its work could not be kept.
    has_stayed_open: bool,
    /// The copy that is being opened.
    adopted: Option<Left>,
    /// The copies that were discarded last: where they are now.
    discarded: Vec<PathBuf>,
}

impl Unsaved {
    pub(crate) fn new(folder: Option<PathBuf>) -> Self {
        Self { copies: folder.map(Copies::new), ..Self::default() }
    }

    /// Writing broke down: it is tried again later, not at once.
    pub(crate) const fn copy_broke(&mut self) {
        self.failed = true;
    }
}

impl App {
    /// Looks for what earlier windows have left.
    pub(crate) fn look_for_unsaved_work(&mut self) {
        let Some(copies) = &self.features.recovery.copies else { return };
        let (left, wrong) = copies.left();
        self.features.recovery.offered = left;
        for error in wrong {
            self.state
                .notices
                .error(format!("A copy of unsaved work cannot be read, and is left where it is: {error}."));
        }
    }

    fn about(&self) -> About {
        let take = self.state.session.take.as_ref();
        About {
            frame: self.state.selection.frame,
            frames: take.map(|take| take.frame_count()),
            take: take.map(|take| take.name.clone()),
            project: self.state.project.clone(),
        }
    }

    /// What the active camera shows, once it shows the frame.
    fn picture(&self) -> Option<Picture> {
        let predicted = self.state.session.predicted.clone()?;
        let is_of_frame = predicted.scene.frame.as_ref()?.frame == self.state.selection.frame;
        is_of_frame.then_some(Picture { predicted, camera: self.state.selection.camera })
    }

    /// Writes the copy of unsaved work soon after every change; removes it when there is nothing unsaved.
    pub(crate) fn autosave(&mut self) {
        let revision = self.state.history.revision();
        let (dirty, has_take) = (self.state.history.is_dirty(), self.document().take.is_some());
        let beside = (self.about(), self.picture());
        let is_stale = self.state.session.is_stale;
        let unsaved = &mut self.features.recovery;
        let Some(copies) = &mut unsaved.copies else { return };
        if self.worker.is_busy(Lane::Save) || self.files.open.is_busy() {
            return;
        }
        if !dirty {
            // A document that was just opened, or one that is in its file as it is.
            if unsaved.written.take().is_some() {
                copies.forget();
            }
            return;
        }
        let has_picture_to_come = unsaved.is_picture_old && !is_stale;
        if !has_take || (unsaved.written == Some(revision) && !has_picture_to_come) {
            return;
        }
        let every = if unsaved.failed { AGAIN } else { EVERY };
        let wait = unsaved.begun.map_or(Duration::ZERO, |begun| every.saturating_sub(begun.elapsed()));
        if !wait.is_zero() {
            self.state.egui.request_repaint_after(wait);
            return;
        }
        unsaved.begun = Some(Instant::now());
        unsaved.is_picture_old = is_stale;
        match copies.own().map(Path::to_owned).map_err(|error| copies.said(&error)) {
            Ok(path) => {
                let job = self.save_job(path, beside);
                self.worker.request(Lane::Save, job);
            }
            Err(error) => self.copy_failed(&error),
        }
    }

    pub(crate) fn copy_saved(&mut self, revision: u64) {
        self.features.recovery.written = Some(revision);
        self.features.recovery.has_stayed_open = false;
        if std::mem::take(&mut self.features.recovery.failed) {
            self.state.notices.close_about(COPY);
            self.state.notices.info(self.state.now, "The copy of unsaved work is written again.", None);
        }
    }

    /// Says so once, until it works again.
    pub(crate) fn copy_failed(&mut self, why: &str) {
        if !std::mem::replace(&mut self.features.recovery.failed, true) {
            let text = format!(
                "{COPY}: {why}. It is tried again every {} seconds; save the project to be sure.",
                AGAIN.as_secs()
            );
            self.state.notices.error_with(text, Command::File(FileCommand::SaveAs));
        }
        // Should its folder be gone, the next try makes another.
        if let Some(copies) = &mut self.features.recovery.copies {
            copies.leave_if_gone();
        }
    }

    /// Writes the copy at once, when the window closes or something else is opened. Says why that is impossible.
    pub(crate) fn keep_unsaved_work(&mut self) -> Result<(), String> {
        if !self.state.history.is_dirty() || self.document().take.is_none() {
            if let Some(copies) =
                self.features.recovery.copies.as_mut().filter(|_| self.features.recovery.written.is_some())
            {
                copies.forget();
            }
            return Ok(());
        }
        let (about, picture) = (self.about(), self.picture());
        let Some(copies) = &mut self.features.recovery.copies else { return Ok(()) };
        let path = copies.own().map(Path::to_owned).map_err(|error| copies.said(&error));
        let written = path.and_then(|path| {
            let written =
                write_project(&path, self.state.history.document()).and_then(|()| about.write(&path));
            // The work is safe without it.
            let _ = picture.map(|picture| picture.write(&path));
            written.map_err(|error| error.to_string())
        });
        written.inspect_err(|why| self.copy_failed(why))
    }

    /// A window whose work is neither saved nor can be kept for the next start does not close at the first try.
    pub(crate) fn guard_close(&mut self, ctx: &egui::Context) {
        if ctx.input(|input| input.viewport().close_requested()) && !self.may_leave("Not closed", "close") {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
        }
    }

    /// Keeps the work, since the window closes or something else is opened. If it can be kept nowhere, that is not done
    /// at the first try, and the reason is said.
    pub(crate) fn may_leave(&mut self, not_done: &str, verb: &str) -> bool {
        let Err(why) = self.keep_unsaved_work() else { return true };
        if std::mem::replace(&mut self.features.recovery.has_stayed_open, true) {
            return true;
        }
        let text = format!(
            "{not_done}: your work is not saved, and cannot be kept for the next start: {why}. Save it to another \
             place, or {verb} once more and lose it."
        );
        self.state.notices.error_with(text, Command::File(FileCommand::SaveAs));
        false
    }

    /// What is offered.
    pub(crate) fn offer(&self) -> Offer<'_> {
        let waiting = self.files.postponed.as_ref().map(|opening| match opening {
            Opening::Take(TakeSource::Path(path))
            | Opening::Project(path)
            | Opening::Moved { project: path, .. } => {
                path.file_name().map_or_else(|| "the take".into(), |name| name.to_string_lossy().into_owned())
            }
            Opening::Take(TakeSource::Demonstration(_)) => "the demonstration".to_owned(),
            Opening::Take(TakeSource::BuiltIn) => "the built-in take".to_owned(),
            Opening::Ready(take) => take.name().to_owned(),
        });
        Offer { left: &self.features.recovery.offered, clock: &self.clock, waiting }
    }

    /// What the user has decided about work that was left.
    pub(crate) fn recover(&mut self, decision: Recovery) {
        match decision {
            Recovery::Restore(index) => {
                // It stays on offer until it is open: its take may not be there.
                if let Some(left) = self.features.recovery.offered.get(index).cloned() {
                    self.features.recovery.adopted = Some(left.clone());
                    self.open(Opening::Project(left.path));
                }
                return;
            }
            Recovery::Discard(index) if index < self.features.recovery.offered.len() => {
                let left = self.features.recovery.offered.remove(index);
                self.discard(vec![left]);
            }
            Recovery::Discard(_) => {}
            Recovery::DiscardAll => {
                let all = std::mem::take(&mut self.features.recovery.offered);
                self.discard(all);
            }
            Recovery::Later => self.features.recovery.offered.clear(),
        }
        if self.features.recovery.offered.is_empty()
            && let Some(opening) = self.files.postponed.take()
        {
            self.open(opening);
        }
    }

    /// Puts copies aside, so that they are offered no more.
    fn discard(&mut self, all: Vec<Left>) {
        let Some(copies) = &self.features.recovery.copies else { return };
        self.features.recovery.discarded.clear();
        for left in all {
            match copies.put_aside(&left.path) {
                Ok(path) => self.features.recovery.discarded.push(path),
                Err(error) => {
                    let path = left.path.display();
                    self.state.notices.error(format!("{path}: it cannot be put aside: {error}."));
                }
            }
        }
        let text = match self.features.recovery.discarded.as_slice() {
            [] => return,
            [one] => format!("Discarded. {} can still be opened as a project.", one.display()),
            all => format!("Discarded {} copies. They can still be opened as projects.", all.len()),
        };
        self.state.notices.info(self.state.now, text, Some(Command::Recovery(RecoveryCommand::UndoDiscard)));
    }

    /// Whether something was discarded that can be brought back.
    pub(crate) fn has_discarded(&self) -> bool {
        !self.features.recovery.discarded.is_empty()
    }

    /// Offers again what was discarded last.
    pub(crate) fn undo_discard(&mut self) {
        let Some(copies) = &self.features.recovery.copies else { return };
        for path in std::mem::take(&mut self.features.recovery.discarded) {
            if let Err(error) = copies.bring_back(&path) {
                self.state.notices.error(format!("{}: it cannot be brought back: {error}.", path.display()));
            }
        }
        self.look_for_unsaved_work();
        if self.state.session.take.is_some() {
            let text = "Brought back. It is offered again at the next start.";
            self.state.notices.info(self.state.now, text, None);
        }
    }

    /// Something was opened: the copy of what was there before stays as it is. Says whether it is work that was
    /// left, and what is known about that.
    pub(crate) fn begin_copy(&mut self, opened: Option<&Path>) -> Option<About> {
        self.features.recovery.written = None;
        self.features.recovery.begun = None;
        self.features.recovery.failed = false;
        self.features.recovery.is_picture_old = false;
        self.features.recovery.has_stayed_open = false;
        // The rest is offered again at the next start.
        self.features.recovery.offered.clear();
        let copies = self.features.recovery.copies.as_mut()?;
        copies.leave();
        let left =
            self.features.recovery.adopted.take().filter(|left| Some(left.path.as_path()) == opened)?;
        // If another window was quicker, this one writes a copy of its own.
        if copies.adopt(&left.path).unwrap_or(false) {
            self.features.recovery.written = Some(OLDER);
        }
        Some(left.about)
    }
}
