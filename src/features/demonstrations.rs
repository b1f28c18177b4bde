//! The demonstration that is open: its fits in the laboratory, its sentences, and what to try next.

mod explanation;
mod next;

use egui::Ui;

use crate::context::command::{Command, TrackingCommand, Variants};
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{PaneEvent, Request, Requests};
use crate::take::demonstration::Demonstration;
use crate::take::source::TakeSource;

/// The feature.
#[derive(Debug, Default, Clone)]
pub(crate) struct Demonstrations {
    /// Which one is explained, until that is closed.
    explained: Option<Demonstration>,
}

impl Demonstrations {
    /// Does a command.
    pub(crate) fn run(which: Demonstration, requests: &mut Requests) {
        requests.request(Request::Open(TakeSource::Demonstration(which)));
    }

    /// Arranges the window for a demonstration that has just been opened.
    pub(crate) fn begin(&mut self, which: Demonstration, requests: &mut Requests) {
        requests.request(Request::CloseNotices);
        self.explained = Some(which);
        if which == Demonstration::Motions {
            requests.request(Request::Layout(Layout::Pose));
            requests.request(Request::Pane(Pane::Motions, PaneEvent::Open));
            requests.run(Command::Tracking(TrackingCommand::Forward));
            return;
        }
        requests.request(Request::Layout(Layout::Demonstrate));
        requests.request(Request::RunLaboratory { over: compared(which), camera: Some(shown_camera(which)) });
    }

    /// What the demonstration shows and what to try, above the cameras' views or the laboratory, until it is closed.
    pub(crate) fn ui(&mut self, ui: &mut Ui, requests: &mut Requests) {
        if self.explained.is_some_and(|which| explanation::ui(ui, which, requests)) {
            self.explained = None;
        }
    }
}

/// What the fits of a demonstration differ in, side by side.
const fn compared(which: Demonstration) -> Variants {
    match which {
        Demonstration::SingleLimb
        | Demonstration::OneCamera
        | Demonstration::TwoCameras
        | Demonstration::Motions => Variants::Renderers,
        Demonstration::Sequence | Demonstration::TinySequence | Demonstration::RealFootage => {
            Variants::Presets
        }
        Demonstration::Bias => Variants::Ramps,
    }
}

/// The camera whose pictures are shown: where one camera counts that cannot see depth, the other.
const fn shown_camera(which: Demonstration) -> usize {
    match which {
        Demonstration::OneCamera | Demonstration::Bias => 1,
        _ => 0,
    }
}
