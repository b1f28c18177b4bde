//! What to try next in a demonstration: a button each.

use backlit_tracking::fit::Preset;

use crate::context::command::{
    BeginningCommand, Command, FitCommand, TimelineCommand, TrackingCommand, Variants, WindowCommand,
};
use crate::context::preferences::Layout;
use crate::context::{Request, Requests};
use crate::document::edit::Edit;
use crate::take::demonstration::Demonstration;

/// One thing to try.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Try {
    /// On the button.
    pub(super) text: &'static str,
    /// One sentence without its full stop.
    pub(super) tooltip: &'static str,
    act: Act,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Act {
    /// Done one after the other.
    Commands(&'static [Command]),
    /// The laboratory fits these side by side.
    Compare(Variants),
    /// A camera counts from now on, and the laboratory fits again.
    UseCamera(usize),
}

const POSE: Command = Command::Window(WindowCommand::Layout(Layout::Pose));
const FIRST: Command = Command::Timeline(TimelineCommand::FirstFrame);
const TRACK: Command = Command::Tracking(TrackingCommand::Forward);
const REPORT: Command = Command::Fit(FitCommand::Preset(Preset::Report));
const ROBUST: Command = Command::Fit(FitCommand::Preset(Preset::Robust));

const RENDERERS: Try = Try {
    text: "Compare renderers",
    tooltip: "Cylinder, capsule and sphere tree from the same start",
    act: Act::Compare(Variants::Renderers),
};
const RAMPS: Try = Try {
    text: "Compare ramps",
    tooltip: "From the same start, a fit for each way to draw how far a pixel is from the body",
    act: Act::Compare(Variants::Ramps),
};
const PRESETS: Try = Try {
    text: "Compare presets",
    tooltip: "The report’s fit beside the robust one, from the same start",
    act: Act::Compare(Variants::Presets),
};
const WITH_CAMERA_2: Try = Try {
    text: "Fit with camera 2 too",
    tooltip: "Let camera 2 count, and fit again",
    act: Act::UseCamera(1),
};
const TRACK_REPORT: Try = Try {
    text: "Track as in 2004",
    tooltip: "All frames by the report’s preset, each from the last one’s pose, in the Pose layout",
    act: Act::Commands(&[POSE, REPORT, FIRST, TRACK]),
};
const TRACK_ROBUST: Try = Try {
    text: "Track with Robust",
    tooltip: "All frames with all that is better, in the Pose layout",
    act: Act::Commands(&[POSE, ROBUST, FIRST, TRACK]),
};
const WAYS: Try = Try {
    text: "Try all again",
    tooltip: "All ways from the pose of this frame, one after the other",
    act: Act::Commands(&[POSE, Command::Beginning(BeginningCommand::RunAll)]),
};
const ACQUIRE: Try = Try {
    text: "Acquire a body",
    tooltip: "Neither pose nor size is known: a body is found, and grown limb by limb",
    act: Act::Commands(&[POSE, Command::Beginning(BeginningCommand::AcquireBody)]),
};
const WORST: Try = Try {
    text: "Worst frame",
    tooltip: "The tracked frame that fits worst",
    act: Act::Commands(&[POSE, Command::Timeline(TimelineCommand::WorstFrame)]),
};

/// What there is to try.
pub(super) const fn of(which: Demonstration) -> &'static [Try] {
    match which {
        Demonstration::SingleLimb => &[RENDERERS, RAMPS],
        Demonstration::OneCamera => &[WITH_CAMERA_2, RENDERERS, RAMPS],
        Demonstration::TwoCameras => &[PRESETS, RENDERERS, RAMPS],
        Demonstration::Sequence | Demonstration::TinySequence | Demonstration::RealFootage => {
            &[TRACK_REPORT, TRACK_ROBUST, WORST, RENDERERS]
        }
        Demonstration::Bias => &[WITH_CAMERA_2, RAMPS, RENDERERS],
        Demonstration::Begin => &[WAYS, ACQUIRE, PRESETS],
    }
}

impl Try {
    pub(super) fn request(&self, which: Demonstration, requests: &mut Requests) {
        let compare = |over| Request::RunLaboratory { over, camera: None };
        match self.act {
            Act::Commands(commands) => commands.iter().for_each(|command| requests.run(*command)),
            Act::Compare(over) => {
                requests.request(Request::Layout(Layout::Demonstrate));
                requests.request(compare(over));
            }
            Act::UseCamera(camera) => {
                requests.edit(Edit::UseCamera { camera, used: true });
                requests.request(Request::Layout(Layout::Demonstrate));
                super::compared(which).into_iter().for_each(|over| requests.request(compare(over)));
            }
        }
    }
}
