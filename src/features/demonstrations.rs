//! The demonstration that is open: its fits in the laboratory, its sentences, and what to try next.

mod explanation;
mod next;

use egui::Ui;

use crate::context::command::{Command, FitCommand, TrackingCommand, Variants, WindowCommand};
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{Context, PaneEvent, Request, Requests};
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
        match opening(which) {
            Opening::Laboratory(over, camera) => {
                requests.request(Request::Layout(Layout::Demonstrate));
                requests.request(Request::RunLaboratory { over, camera: Some(camera) });
            }
            Opening::Commands(commands) => commands.iter().for_each(|command| requests.run(*command)),
        }
        if which == Demonstration::Motions {
            requests.request(Request::Pane(Pane::Motions, PaneEvent::Open));
        }
    }

    /// What the demonstration shows and what to try, above the cameras' views or the laboratory, until it is closed.
    pub(crate) fn ui(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        if self.explained.is_some_and(|which| explanation::ui(ui, which, context, requests)) {
            self.explained = None;
        }
    }
}

/// What a demonstration opens with.
#[derive(Debug, Clone, Copy)]
enum Opening {
    /// Fits side by side that differ in this, in the pictures of a camera: where one camera counts that cannot see depth, of
    /// the other.
    Laboratory(Variants, usize),
    /// Done one after the other.
    Commands(&'static [Command]),
}

const fn opening(which: Demonstration) -> Opening {
    match which {
        Demonstration::SingleLimb | Demonstration::TwoCameras => Opening::Laboratory(Variants::Renderers, 0),
        Demonstration::OneCamera => Opening::Laboratory(Variants::Renderers, 1),
        Demonstration::Sequence | Demonstration::TinySequence | Demonstration::RealFootage => {
            Opening::Laboratory(Variants::Presets, 0)
        }
        Demonstration::Bias => Opening::Laboratory(Variants::Ramps, 1),
        Demonstration::Spheres => Opening::Commands(&[
            Command::Window(WindowCommand::Layout(Layout::Pose)),
            Command::Fit(FitCommand::MakeSpheres),
        ]),
        Demonstration::Cues | Demonstration::Motions => Opening::Commands(&[
            Command::Window(WindowCommand::Layout(Layout::Pose)),
            Command::Tracking(TrackingCommand::Forward),
        ]),
    }
}
