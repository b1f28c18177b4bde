//! Files that are dragged over the window and dropped on it.

use std::path::PathBuf;

use backlit_document::edit::Edit;
use backlit_jobs::{News, once};
use backlit_take::dropped::Dropped;

use super::{App, Inspector};
use crate::app::take_in_job::TakeInJob;
use crate::context::command::{Command, HistoryCommand};
use crate::shell::drop_overlay::{self, Hovering};

impl App {
    /// Looks what is dragged over the window, and takes what is dropped.
    pub(crate) fn take_dropped_files(&mut self, ctx: &egui::Context) {
        let (hovered, dropped): (Vec<PathBuf>, Vec<PathBuf>) = ctx.input(|input| {
            let hovered = input.raw.hovered_files.iter().filter_map(|file| file.path.clone());
            let dropped = input.raw.dropped_files.iter().map(|file| file.path().to_owned());
            (hovered.collect(), dropped.collect())
        });
        if hovered.is_empty() {
            self.inspector.shell.hovering = None;
        } else if self.inspector.shell.hovering.as_ref().is_none_or(|hovering| hovering.paths != hovered) {
            let dropped = Dropped::of(&hovered);
            self.inspector.shell.hovering = Some(Hovering { paths: hovered, dropped });
        }
        if !dropped.is_empty() {
            self.take_in(Dropped::of(&dropped));
        }
    }

    /// Does what dropped files are for.
    fn take_in(&mut self, dropped: Dropped) {
        // Whatever lay over the window was about something else.
        self.inspector.shell.overlay = None;
        match dropped {
            Dropped::Open(path) => self.open_path(&path),
            Dropped::New(paths) => self.new_take(paths),
            Dropped::Unknown(path, why) => {
                self.inspector.state.notices.error(format!("{}: {why}.", path.display()));
            }
            dropped => {
                let Some(footage) = self.inspector.state.session.take.clone() else {
                    let (_, name) = dropped.explanation(0);
                    return self.inspector.state.notices.error(format!("{name}: open a take first."));
                };
                let (model, frame) = (self.document().model.clone(), self.inspector.state.selection.frame);
                let job = TakeInJob { dropped, footage, model, frame };
                self.files.take_in.begin(&self.inspector.state.pool, (), |()| once(move |_| job.read()));
            }
        }
    }

    /// Takes in what was read of dropped files.
    pub(crate) fn take_in_dropped(&mut self) {
        for news in self.files.take_in.poll() {
            match news {
                News::Output(Ok((edit, said))) => self.taken_in(edit, said),
                News::Output(Err(error)) => self.inspector.state.notices.error(format!("{error:#}")),
                News::Ended => {}
                News::Failed(failure) => self.failed("Reading the dropped files", &failure),
            }
        }
    }

    /// What was dropped is read: it becomes a change that can be undone.
    fn taken_in(&mut self, edit: Edit, said: String) {
        self.interrupt_fit();
        let revision = self.inspector.state.history.revision();
        self.edit(edit, None);
        if self.inspector.state.history.revision() != revision {
            self.inspector.state.notices.info(
                self.inspector.state.now,
                said,
                Some(Command::History(HistoryCommand::Undo)),
            );
        } else if !self
            .inspector
            .state
            .notices
            .cards()
            .any(|notice| notice.text.starts_with("That cannot be done"))
        {
            self.inspector.state.notices.info(
                self.inspector.state.now,
                "Nothing changed: that is what is there already.",
                None,
            );
        }
    }
}

impl Inspector {
    /// Says what will happen, over everything.
    pub(crate) fn show_drop(&self, ui: &egui::Ui) {
        let Some(Hovering { dropped, .. }) = &self.shell.hovering else { return };
        let (what, name) = dropped.explanation(self.state.selection.frame);
        let lacks_take = dropped.needs_take() && self.state.session.take.is_none();
        let is_possible = !lacks_take && !matches!(dropped, Dropped::Unknown(..));
        let what = if lacks_take { "Open a take first".to_owned() } else { what };
        drop_overlay::ui(ui, &what, &name, is_possible);
    }
}
