//! What to try next in a demonstration: a button each.

use backlit_tracking::fit::Preset;

use crate::context::Requests;
use crate::context::command::{Command, FitCommand, TimelineCommand, TrackingCommand, Variants};
use crate::document::edit::Edit;
use crate::take::demonstration::Demonstration;

/// One thing to try.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Try {
    /// On the button.
    pub(super) text: &'static str,
    /// One sentence without its full stop.
    pub(super) tooltip: &'static str,
    /// A camera that counts from now on.
    uses: Option<usize>,
    /// Done one after the other.
    commands: &'static [Command],
}

const fn act(text: &'static str, tooltip: &'static str, commands: &'static [Command]) -> Try {
    Try { text, tooltip, uses: None, commands }
}

const TRACK: Command = Command::Tracking(TrackingCommand::Forward);
const FIRST: Command = Command::Timeline(TimelineCommand::FirstFrame);
const WORST: Try =
    act("Worst frame", "The frame that fits worst", &[Command::Timeline(TimelineCommand::WorstFrame)]);
const RAMPS: Try = act(
    "Run with each ramp",
    "From the same start, a curve for each ramp",
    &[Command::Fit(FitCommand::RunAgain(Variants::Ramps))],
);

/// What there is to try.
pub(super) const fn of(which: Demonstration) -> &'static [Try] {
    match which {
        Demonstration::SingleLimb => &[],
        Demonstration::OneCamera => {
            const {
                &[
                    Try {
                        text: "Fit with camera 2 too",
                        tooltip: "Let camera 2 count, and go on from here",
                        uses: Some(1),
                        commands: &[Command::Fit(FitCommand::Run)],
                    },
                    RAMPS,
                ]
            }
        }
        Demonstration::TwoCameras => {
            const {
                &[
                    act(
                        "Run with each renderer",
                        "From the same start, a curve for each renderer",
                        &[Command::Fit(FitCommand::RunAgain(Variants::Renderers))],
                    ),
                    RAMPS,
                ]
            }
        }
        Demonstration::Sequence | Demonstration::TinySequence => {
            const {
                &[
                    act("Track", "All frames from the first on", &[FIRST, TRACK]),
                    act(
                        "Track as in 2004",
                        "The same by the report’s preset",
                        &[Command::Fit(FitCommand::Preset(Preset::Report)), FIRST, TRACK],
                    ),
                    WORST,
                ]
            }
        }
        Demonstration::RealFootage => {
            const {
                &[
                    act("Fit this frame", "25 iterations, as in Fig. 5.4", &[Command::Fit(FitCommand::Run)]),
                    act(
                        "Track as in 2004",
                        "Each frame from the last one’s pose, as in Fig. 5.5",
                        &[FIRST, TRACK],
                    ),
                    act(
                        "Track with Robust",
                        "The same with all that is better",
                        &[Command::Fit(FitCommand::Preset(Preset::Robust)), FIRST, TRACK],
                    ),
                    WORST,
                ]
            }
        }
        Demonstration::Bias => {
            const {
                &[act(
                    "Run with each renderer",
                    "From the true pose, a curve for each renderer",
                    &[Command::Fit(FitCommand::RunAgain(Variants::Renderers))],
                )]
            }
        }
    }
}

impl Try {
    pub(super) fn request(&self, requests: &mut Requests) {
        if let Some(camera) = self.uses {
            requests.edit(Edit::UseCamera { camera, used: true });
        }
        self.commands.iter().for_each(|command| requests.run(*command));
    }
}
