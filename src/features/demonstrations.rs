//! The demonstration that is open: its fits in the laboratory, its sentences, and what to try next.

mod explanation;
mod next;

use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use egui::Ui;

use crate::context::command::{BeginningCommand, Command, FitCommand, TrackingCommand, Variants};
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{Context, PaneEvent, Request, Requests};

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
            Opening::Tiles(pane, command) => {
                requests.request(Request::Layout(Layout::Pose));
                if let Some(pane) = pane {
                    requests.request(Request::Pane(pane, PaneEvent::Open));
                }
                requests.run(command);
            }
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
    /// The pose layout with this pane too, and a command.
    Tiles(Option<Pane>, Command),
}

const fn opening(which: Demonstration) -> Opening {
    match which {
        Demonstration::SingleLimb | Demonstration::TwoCameras => Opening::Laboratory(Variants::Renderers, 0),
        Demonstration::OneCamera => Opening::Laboratory(Variants::Renderers, 1),
        Demonstration::Sequence | Demonstration::TinySequence | Demonstration::RealFootage => {
            Opening::Laboratory(Variants::Presets, 0)
        }
        Demonstration::Bias => Opening::Laboratory(Variants::Ramps, 1),
        Demonstration::Begin => Opening::Tiles(None, Command::Beginning(BeginningCommand::RunAll)),
        Demonstration::Motions => {
            Opening::Tiles(Some(Pane::Motions), Command::Tracking(TrackingCommand::Forward))
        }
        Demonstration::Spheres => Opening::Tiles(None, Command::Fit(FitCommand::MakeSpheres)),
        Demonstration::Cues => Opening::Tiles(None, Command::Tracking(TrackingCommand::Forward)),
    }
}
