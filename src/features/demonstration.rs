//! Showing a demonstration: its arrangement, its sentences, and its runs one after the other.

pub(crate) mod explanation;

use std::collections::VecDeque;

use crate::app::Inspector;
use crate::context::Request;
use crate::context::preferences::Layout;
use crate::document::edit::Edit;
use crate::document::history::{Gesture, History};
use crate::drawing::ViewMode;
use crate::take::demonstration::{Demonstration, PreparedRun};
use crate::worker::Lane;

/// Runs that begin by themselves.
#[derive(Debug)]
pub(crate) struct Prepared {
    runs: VecDeque<PreparedRun>,
    gesture: Gesture,
}

/// The demonstration that is open.
#[derive(Debug, Default)]
pub(crate) struct Demonstrating {
    /// Runs that are still to begin.
    pub(crate) prepared: Option<Prepared>,
    pub(crate) explanation: Option<&'static str>,
}

impl Inspector {
    /// Arranges the window for a demonstration that has just been opened.
    pub(crate) fn demonstrate(&mut self, which: Demonstration) {
        self.state.notices.close_all();
        if which == Demonstration::SingleLimb {
            self.features.demonstration.explanation = Some(which.explanation());
            self.state.preferences.layout = Layout::Demonstrate;
            self.features.laboratory.run_when_begun();
            return;
        }
        let runs = which.runs();
        self.state.preferences.layout = if runs.is_empty() { Layout::Pose } else { Layout::Debug };
        self.features.demonstration.explanation = Some(which.explanation());
        self.request(Request::ShowMode(Layout::Debug, ViewMode::Residual));
        self.features.demonstration.prepared =
            Some(Prepared { runs: runs.into(), gesture: self.new_gesture() });
    }

    /// Begins the next run of a demonstration once the one before has ended and the frame is there.
    pub(crate) fn go_on_demonstrating(&mut self) {
        let frame = self.state.selection.frame;
        let has_data = self.state.session.frames.get(frame).is_some_and(|frame| frame.has_mask());
        if !has_data || self.worker.is_busy(Lane::Fit) {
            return;
        }
        let Some(prepared) = &mut self.features.demonstration.prepared else { return };
        let gesture = prepared.gesture;
        let Some(run) = prepared.runs.pop_front() else {
            self.features.demonstration.prepared = None;
            // What has run by itself is nobody's work: there is nothing to undo and nothing to save.
            self.state.history = History::new(self.document().clone());
            return;
        };
        let what = "Demonstrate".to_owned();
        self.edit(Edit::SetFit { options: Box::new(run.fit), what }, Some(gesture));
        // From the start again: without key pose and without what the run before has found.
        self.edit(Edit::ClearEstimates, Some(gesture));
        self.features.fit.run_gesture = Some(gesture);
        self.begin(Some(run.name), None, None);
    }

    /// The user has something else in mind: no further run begins by itself.
    pub(crate) fn stop_demonstrating(&mut self) {
        if let Some(prepared) = &mut self.features.demonstration.prepared {
            prepared.runs.clear();
        }
    }
}
