//! The demonstration that is open: its fits in the laboratory, its sentences, and what to try next.

mod explanation;
mod next;

use egui::Ui;

use crate::context::command::Variants;
use crate::context::preferences::Layout;
use crate::context::{Request, Requests};
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
        let Some(over) = compared(which) else {
            requests.request(Request::Layout(Layout::Pose));
            return requests.request(Request::TryBeginnings);
        };
        requests.request(Request::Layout(Layout::Demonstrate));
        requests.request(Request::RunLaboratory { over, camera: Some(shown_camera(which)) });
    }

    /// What the demonstration shows and what to try, above the cameras' views or the laboratory, until it is closed.
    pub(crate) fn ui(&mut self, ui: &mut Ui, requests: &mut Requests) {
        if self.explained.is_some_and(|which| explanation::ui(ui, which, requests)) {
            self.explained = None;
        }
    }
}

/// What the fits of a demonstration differ in, side by side in the laboratory; `None` where ways to begin are compared.
const fn compared(which: Demonstration) -> Option<Variants> {
    Some(match which {
        Demonstration::SingleLimb | Demonstration::OneCamera | Demonstration::TwoCameras => {
            Variants::Renderers
        }
        Demonstration::Sequence | Demonstration::TinySequence | Demonstration::RealFootage => {
            Variants::Presets
        }
        Demonstration::Bias => Variants::Ramps,
        Demonstration::Begin => return None,
    })
}

/// The camera whose pictures are shown: where one camera counts that cannot see depth, the other.
const fn shown_camera(which: Demonstration) -> usize {
    match which {
        Demonstration::OneCamera | Demonstration::Bias => 1,
        _ => 0,
    }
}
