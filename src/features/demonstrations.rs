//! The demonstration that is open: its fits in the laboratory, its sentences, and what to try next.

mod explanation;
mod next;

use backlit_formats::Footage;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use egui::Ui;

use crate::context::command::{BeginningCommand, Command, FitCommand, TrackingCommand, Variants};
use crate::context::feature::Feature;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::unavailable::Why;
use crate::context::unavailable::because;
use crate::context::{Context, DesktopRequest, FeatureRequest, PaneEvent, Requests, ShellRequest};

/// The feature.
#[derive(Debug, Default, Clone)]
pub(crate) struct Demonstrations {
    /// Which one is explained, until that is closed.
    explained: Option<Demonstration>,
}

impl Feature for Demonstrations {
    fn run(&mut self, command: Command, _: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Demonstration(which) = command else { return false };
        requests.request(DesktopRequest::Open(TakeSource::Demonstration(which)));
        true
    }

    fn unavailable(&self, command: Command, _: &Context<'_>) -> Why {
        let Command::Demonstration(which) = command else { return None };
        let missing = "BACKLIT_DATA does not name a folder that has the real footage";
        because(!which.is_available(), missing)
    }

    fn reset(&mut self, _: &Footage) {
        self.explained = None;
    }

    fn at_rest(&self) -> Self {
        self.clone()
    }
}

impl Demonstrations {
    /// Arranges the window for a demonstration that has just been opened.
    pub(crate) fn begin(&mut self, which: Demonstration, requests: &mut Requests) {
        requests.request(ShellRequest::CloseNotices);
        self.explained = Some(which);
        match opening(which) {
            Opening::Laboratory(over, camera) => {
                requests.request(ShellRequest::Layout(Layout::Demonstrate));
                requests.request(FeatureRequest::RunLaboratory { over, camera: Some(camera) });
            }
            Opening::Tiles(pane, command) => {
                requests.request(ShellRequest::Layout(Layout::Pose));
                if let Some(pane) = pane {
                    requests.request(ShellRequest::Pane(pane, PaneEvent::Open));
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
