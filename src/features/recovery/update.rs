//! The copy of unsaved work, and what earlier windows have left.

use anyhow::anyhow;
use backlit_document::Document;
use backlit_document::history::Version;
use backlit_document::project::{ProjectError, write_project};
use backlit_document::run::Run;
use egui::Ui;
use std::path::Path;
use std::sync::PoisonError;
use std::time::{Duration, Instant};

use backlit_jobs::once;

use super::{CopyNote, Recovery, Thumbnail, UnsavedCopy};
use crate::context::clock::Clock;
use crate::context::command::{Command, FileCommand, RecoveryCommand};
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because};
use crate::context::{
    Context, Decision, DesktopRequest, FeatureCard, FeatureRequest, Requests, ShellRequest,
};

/// The copy is written this often while there is something new: with the time of writing, less than a second of work
/// can be lost.
const EVERY: Duration = Duration::from_millis(500);
/// After a failure it is tried again this late.
const AGAIN: Duration = Duration::from_secs(2);

/// What is said of a copy that is not written.
const COPY: &str = "The copy of unsaved work was not written";

/// What is written for the next start.
struct UnsavedWork {
    document: Document,
    runs: Vec<Run>,
    about: CopyNote,
    picture: Option<Thumbnail>,
}

impl UnsavedWork {
    fn new(context: &Context<'_>) -> Self {
        let (session, selection) = (context.session, context.selection);
        let take = session.take.as_ref();
        let about = CopyNote {
            frame: selection.frame,
            frames: take.map(|take| take.frame_count()),
            take: take.map(|take| take.take().name().to_owned()),
            project: context.project.map(Path::to_owned),
        };
        // What the active camera shows, once it shows the frame.
        let picture = session.predicted.clone().filter(|predicted| {
            predicted.scene.frame.as_ref().is_some_and(|frame| frame.frame == selection.frame)
        });
        let picture = picture.map(|predicted| Thumbnail { predicted, camera: selection.camera });
        let runs = context.history.runs().all().to_vec();
        Self { document: context.document().clone(), runs, about, picture }
    }

    fn write(self, path: &Path) -> Result<(), ProjectError> {
        write_project(path, &self.document, &self.runs)?;
        self.about.write(path)?;
        // The work is safe without it.
        let _ = self.picture.map(|picture| picture.write(path));
        Ok(())
    }
}

impl Feature for Recovery {
    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Recovery(command) = command else { return false };
        match command {
            RecoveryCommand::Show => requests.request(ShellRequest::OpenCard(FeatureCard::UnsavedWork)),
            RecoveryCommand::UndoDiscard => self.undo_discard(context, requests),
        }
        true
    }

    fn unavailable(&self, command: Command, _: &Context<'_>) -> Why {
        let Command::Recovery(command) = command else { return None };
        match command {
            RecoveryCommand::Show => because(self.offered.is_empty(), "No window has left unsaved work"),
            RecoveryCommand::UndoDiscard => because(self.discarded.is_empty(), "Nothing was discarded"),
        }
    }

    fn answer(&mut self, request: &FeatureRequest, _: &Context<'_>, requests: &mut Requests) {
        let FeatureRequest::Recover(decision) = request else { return };
        match *decision {
            Decision::Restore(index) => {
                // It stays on offer until it is open: its take may not be there.
                if let Some(left) = self.offered.get(index).cloned() {
                    requests.request(DesktopRequest::OpenPath(left.path.clone()));
                    self.adopted = Some(left);
                }
            }
            Decision::Discard(index) if index < self.offered.len() => {
                let left = self.offered.remove(index);
                self.discard(vec![left], requests);
            }
            Decision::Discard(_) => {}
            Decision::DiscardAll => {
                let all = std::mem::take(&mut self.offered);
                self.discard(all, requests);
            }
            Decision::Later => self.is_put_off = true,
        }
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        self.show(ui, context, requests)
    }
}

impl Recovery {
    /// Looks for what earlier windows have left.
    pub(crate) fn check(&mut self, requests: &mut Requests) {
        let Some(copies) = &self.copies else { return };
        let (left, wrong) = copies.left();
        (self.offered, self.is_put_off) = (left, false);
        for error in wrong {
            requests.complain(format!(
                "A copy of unsaved work cannot be read, and is left where it is: {error}."
            ));
        }
    }

    /// Writes the copy of unsaved work soon after every change; removes it when there is nothing unsaved.
    pub(crate) fn keep_copy(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.take_in_written(requests);
        if self.task.is_busy() || context.busy.opening {
            return;
        }
        let Some(copies) = &mut self.copies else { return };
        let version = context.history.version();
        if !context.is_unsaved() {
            // A document that was just opened, or one that is in its file as it is.
            if self.written.take().is_some() {
                copies.forget();
            }
            return;
        }
        let is_stale = context.session.is_stale;
        let has_picture_to_come = self.is_picture_old && !is_stale;
        if self.written == Some(version) && !has_picture_to_come {
            return;
        }
        let every = if self.failed { AGAIN } else { EVERY };
        let wait = self.begun.map_or(Duration::ZERO, |begun| every.saturating_sub(begun.elapsed()));
        if !wait.is_zero() {
            context.egui.request_repaint_after(wait);
            return;
        }
        self.begun = Some(Instant::now());
        self.is_picture_old = is_stale;
        match copies.own().map(Path::to_owned).map_err(|error| copies.said(&error)) {
            Ok(path) => {
                let (work, writing) = (UnsavedWork::new(context), self.writing.clone());
                self.task.begin(context.pool, version, |_| {
                    once(move |cancel| {
                        let _writing = writing.lock().unwrap_or_else(PoisonError::into_inner);
                        // Something newer may have been written at once meanwhile.
                        if cancel.is_cancelled() { Ok(()) } else { work.write(&path) }
                    })
                });
            }
            Err(error) => self.copy_failed(&error, requests),
        }
    }

    fn take_in_written(&mut self, requests: &mut Requests) {
        for written in requests.outputs("Writing a file", &mut self.task) {
            match written {
                Ok(()) => {
                    let version = self.task.inputs().copied();
                    self.wrote(version.unwrap_or(Version::NONE), requests);
                }
                Err(error) => self.copy_failed(&error.to_string(), requests),
            }
        }
        // What broke down is tried again later, not at once.
        self.failed |= self.task.failure().is_some();
    }

    fn wrote(&mut self, version: Version, requests: &mut Requests) {
        self.written = Some(version);
        self.has_stayed_open = false;
        if std::mem::take(&mut self.failed) {
            requests.request(ShellRequest::CloseNoticesAbout(COPY));
            requests.inform("The copy of unsaved work is written again.", None);
        }
    }

    /// Says so once, until it works again.
    fn copy_failed(&mut self, why: &str, requests: &mut Requests) {
        if !std::mem::replace(&mut self.failed, true) {
            let text = format!(
                "{COPY}: {why}. It is tried again every {} seconds; save the project to be sure.",
                AGAIN.as_secs()
            );
            requests.request(ShellRequest::Complain(text, Some(Command::File(FileCommand::SaveAs))));
        }
        // Should its folder be gone, the next try makes another.
        if let Some(copies) = &mut self.copies {
            copies.leave_if_gone();
        }
    }

    /// Writes the copy at once, when the window closes or something else is opened. Says why that is impossible.
    pub(crate) fn keep(&mut self, context: &Context<'_>, requests: &mut Requests) -> anyhow::Result<()> {
        let Some(copies) = &mut self.copies else { return Ok(()) };
        // What is just being written is older: it must not come after this.
        self.task.forget();
        let writing = self.writing.clone();
        let _writing = writing.lock().unwrap_or_else(PoisonError::into_inner);
        if !context.is_unsaved() {
            if self.written.is_some() {
                copies.forget();
            }
            return Ok(());
        }
        let path = copies.own().map(Path::to_owned).map_err(|error| anyhow!(copies.said(&error)));
        let work = UnsavedWork::new(context);
        let written = path.and_then(|path| Ok(work.write(&path)?));
        match &written {
            Ok(()) => self.wrote(context.history.version(), requests),
            Err(why) => self.copy_failed(&why.to_string(), requests),
        }
        written
    }

    /// A window whose work is neither saved nor can be kept for the next start does not close at the first try.
    pub(crate) fn guard_close(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let closes = context.egui.input(|input| input.viewport().close_requested());
        if closes && !self.may_leave("Not closed", "close", context, requests) {
            context.egui.send_viewport_cmd(egui::ViewportCommand::CancelClose);
        }
    }

    /// Keeps the work, since the window closes or something else is opened. If it can be kept nowhere, that is not done
    /// at the first try, and the reason is said.
    pub(crate) fn may_leave(
        &mut self,
        not_done: &str,
        verb: &str,
        context: &Context<'_>,
        requests: &mut Requests,
    ) -> bool {
        let Err(why) = self.keep(context, requests) else { return true };
        if std::mem::replace(&mut self.has_stayed_open, true) {
            return true;
        }
        let text = format!(
            "{not_done}: your work is not saved, and cannot be kept for the next start: {why}. Save it to another \
             place, or {verb} once more and lose it."
        );
        requests.request(ShellRequest::Complain(text, Some(Command::File(FileCommand::SaveAs))));
        false
    }

    /// Puts copies aside, so that they are offered no more.
    fn discard(&mut self, all: Vec<UnsavedCopy>, requests: &mut Requests) {
        let Some(copies) = &self.copies else { return };
        self.discarded.clear();
        for left in all {
            match copies.put_aside(&left.path) {
                Ok(path) => self.discarded.push(path),
                Err(error) => {
                    requests.complain(format!("{}: it cannot be discarded: {error}.", left.path.display()));
                }
            }
        }
        let text = match self.discarded.as_slice() {
            [] => return,
            [one] => format!("Discarded. {} can still be opened as a project.", one.display()),
            all => format!("Discarded {} copies. They can still be opened as projects.", all.len()),
        };
        requests.inform(text, Some(Command::Recovery(RecoveryCommand::UndoDiscard)));
    }

    /// Offers again what was discarded last.
    fn undo_discard(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let Some(copies) = &self.copies else { return };
        for path in std::mem::take(&mut self.discarded) {
            if let Err(error) = copies.bring_back(&path) {
                requests.complain(format!("{}: it cannot be brought back: {error}.", path.display()));
            }
        }
        self.check(requests);
        if context.session.take.is_some() {
            requests.inform("Brought back.", Some(Command::Recovery(RecoveryCommand::Show)));
        }
    }

    /// Something was opened: the copy of what was there before stays as it is, and is offered. Says whether what was
    /// opened is work that was left, and what is known about that.
    pub(crate) fn begin(&mut self, opened: Option<&Path>) -> Option<CopyNote> {
        self.task.forget();
        self.written = None;
        self.begun = None;
        self.failed = false;
        self.is_picture_old = false;
        self.has_stayed_open = false;
        let copies = self.copies.as_mut()?;
        copies.leave();
        let adopted = self.adopted.take().filter(|left| Some(left.path.as_path()) == opened);
        // If another window was quicker, this one writes a copy of its own.
        if adopted.as_ref().is_some_and(|left| copies.adopt(&left.path).unwrap_or(false)) {
            self.written = Some(Version::NONE);
        }
        // What cannot be read was said at the start.
        self.offered = copies.left().0;
        adopted.map(|left| left.about)
    }

    /// What was left and was not mentioned before: by an earlier window, or by this one when it opened something
    /// else.
    pub(crate) fn notice(&mut self, clock: &Clock) -> Option<String> {
        let is_new = |left: &&UnsavedCopy| !self.told.contains(&left.path);
        let new: Vec<&UnsavedCopy> = self.offered.iter().filter(is_new).collect();
        let text = match new[..] {
            [] => return None,
            [one] => format!("Unsaved work is kept: {}, {}.", one.take, one.when(clock)),
            [newest, ..] => {
                let count = new.len();
                format!(
                    "Unsaved work of {count} windows is kept, the last {}, {}.",
                    newest.take,
                    newest.when(clock)
                )
            }
        };
        self.told.extend(self.offered.iter().map(|left| left.path.clone()));
        Some(text)
    }
}
