//! The demonstration that is open: its arrangement, its sentences, and its runs one after the other.

mod explanation;
mod next;

use std::collections::VecDeque;

use backlit_ui::drawing::ViewMode;
use egui::Ui;

use crate::context::command_button::next_gesture;
use crate::context::preferences::Layout;
use crate::context::{Context, Request, Requests};
use crate::document::edit::Edit;
use crate::document::history::Gesture;
use crate::take::demonstration::{Demonstration, PreparedRun};
use crate::take::source::TakeSource;

/// Runs that begin by themselves.
#[derive(Debug)]
struct Prepared {
    runs: VecDeque<PreparedRun>,
    gesture: Gesture,
}

/// The feature.
#[derive(Debug, Default)]
pub(crate) struct Demonstrations {
    /// Runs that are still to begin.
    prepared: Option<Prepared>,
    /// Which one is explained, until that is closed.
    explained: Option<Demonstration>,
}

impl Demonstrations {
    /// The same without any run to come, for a picture of it.
    pub(crate) fn at_rest(&self) -> Self {
        Self { prepared: None, explained: self.explained }
    }

    /// Does a command.
    pub(crate) fn run(which: Demonstration, requests: &mut Requests) {
        requests.request(Request::Open(TakeSource::Demonstration(which)));
    }

    /// Whether runs begin by themselves.
    pub(crate) fn is_running(&self) -> bool {
        self.prepared.is_some()
    }

    /// Arranges the window for a demonstration that has just been opened.
    pub(crate) fn begin(&mut self, which: Demonstration, context: &Context<'_>, requests: &mut Requests) {
        requests.request(Request::CloseNotices);
        self.explained = Some(which);
        if which == Demonstration::SingleLimb {
            requests.request(Request::Layout(Layout::Demonstrate));
            requests.request(Request::RunLaboratory);
            return;
        }
        let runs = which.runs();
        requests.request(Request::Layout(if runs.is_empty() { Layout::Pose } else { Layout::Debug }));
        requests.request(Request::ShowMode(Layout::Debug, ViewMode::Residual));
        self.prepared = Some(Prepared { runs: runs.into(), gesture: next_gesture(context.egui) });
    }

    /// Begins the next run once the one before has ended and the frame is there.
    pub(crate) fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if context.busy.load_broke {
            // Without its frame it cannot go on.
            self.prepared = None;
        }
        let frame = context.session.frames.get(context.selection.frame);
        if context.busy.fitting || !frame.is_some_and(|frame| frame.has_mask()) {
            return;
        }
        let Some(prepared) = &mut self.prepared else { return };
        let gesture = prepared.gesture;
        let Some(run) = prepared.runs.pop_front() else {
            self.prepared = None;
            // What has run by itself is nobody's work: there is nothing to undo and nothing to save.
            return requests.request(Request::ForgetPast);
        };
        let what = "Demonstrate".to_owned();
        requests.drag(Edit::SetFit { options: Box::new(run.fit), what }, gesture);
        // From the start again: without key pose and without what the run before has found.
        requests.drag(Edit::ClearEstimates, gesture);
        requests.request(Request::BeginRun { name: run.name, gesture });
    }

    /// The user has something else in mind: no further run begins by itself.
    pub(crate) fn stop(&mut self) {
        if let Some(prepared) = &mut self.prepared {
            prepared.runs.clear();
        }
    }

    /// What the demonstration shows and what to try, above the cameras' views, until it is closed.
    pub(crate) fn ui(&mut self, ui: &mut Ui, requests: &mut Requests) {
        if self.explained.is_some_and(|which| explanation::ui(ui, which, requests)) {
            self.explained = None;
        }
    }
}
