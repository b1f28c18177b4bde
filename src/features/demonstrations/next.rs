//! What to try next in a demonstration: a button each.

use backlit_document::edit::Edit;
use backlit_document::likely_poses;
use backlit_document::tracking_choices::{CueChoice, TrackingChoices};
use backlit_take::demonstration::Demonstration;
use backlit_tracking::fit::Preset;
use backlit_tracking::render::RendererKind;

use super::Opening;
use crate::context::command::{
    BeginningCommand, Command, FitCommand, SceneCommand, TimelineCommand, TrackingCommand, Variants,
    WindowCommand,
};
use crate::context::preferences::Layout;
use crate::context::{Context, FeatureRequest, Requests, ShellRequest};

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
    /// All frames are tracked with these cues, and with likely poses of this weight.
    Track(CueChoice, f64),
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

const SPHERES: Try = Try {
    text: "As spheres",
    tooltip: "Draw and fit the body by the spheres of its trees",
    act: Act::Commands(&[Command::Fit(FitCommand::Renderer(RendererKind::SphereTree { spheres: None }))]),
};
const CAPSULES: Try = Try {
    text: "As capsules",
    tooltip: "Draw and fit the body as capsules: look at the overlap",
    act: Act::Commands(&[Command::Fit(FitCommand::Renderer(RendererKind::Capsule))]),
};
const SCENE: Try = Try {
    text: "Spheres in 3-D",
    tooltip: "The body of spheres in the scene, from its front",
    act: Act::Commands(&[Command::Scene(SceneCommand::Front)]),
};
const SILHOUETTES: Try = Try {
    text: "Silhouettes alone",
    tooltip: "Track all frames again without any cue",
    act: Act::Track(CueChoice::None, 0.0),
};
const LIKELY: Try = Try {
    text: "With likely poses",
    tooltip: "Track all frames again without cues, but prefer poses that recorded people took",
    act: Act::Track(CueChoice::None, 3.0),
};
const KEYPOINTS: Try = Try {
    text: "With keypoints",
    tooltip: "Track all frames again; keypoints of another tool pull at limbs that no silhouette shows",
    act: Act::Track(CueChoice::Keypoints, 0.0),
};
const PICTURES: Try = Try {
    text: "With the pictures",
    tooltip: "Track all frames again; optic flow and stereo points pull at limbs that no silhouette shows",
    act: Act::Track(CueChoice::Pictures, 0.0),
};
const ALL_CUES: Try = Try {
    text: "With all of them",
    tooltip: "Track all frames again with keypoints, optic flow and stereo points",
    act: Act::Track(CueChoice::All, 0.0),
};
const PLAY: Try = Try {
    text: "Play",
    tooltip: "Plays all frames with their names, from the first on",
    act: Act::Commands(&[POSE, FIRST, Command::Timeline(TimelineCommand::Play)]),
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
        Demonstration::Motions => &[PLAY, TRACK_REPORT, TRACK_ROBUST],
        Demonstration::Bias => &[WITH_CAMERA_2, RAMPS, RENDERERS],
        Demonstration::Spheres => &[SPHERES, CAPSULES, SCENE],
        Demonstration::Cues => &[SILHOUETTES, LIKELY, KEYPOINTS, PICTURES, ALL_CUES],
        Demonstration::Begin => &[WAYS, ACQUIRE, PRESETS],
    }
}

impl Try {
    pub(super) fn request(&self, which: Demonstration, context: &Context<'_>, requests: &mut Requests) {
        let mut compare = |over| {
            requests.request(ShellRequest::Layout(Layout::Demonstrate));
            requests.request(FeatureRequest::RunLaboratory { over, camera: None });
        };
        match self.act {
            Act::Commands(commands) => commands.iter().for_each(|command| requests.run(*command)),
            Act::Compare(over) => compare(over),
            Act::UseCamera(camera) => {
                if let Opening::Laboratory(over, _) = super::opening(which) {
                    compare(over);
                }
                requests.edit(Edit::UseCamera { camera, used: true });
            }
            Act::Track(cues, likely) => {
                let document = context.document();
                requests.edit(Edit::SetTracking(TrackingChoices { cues, ..document.tracking }));
                let mut options = (*document.fit).clone();
                likely_poses::set_weight(&mut options, likely);
                if options != *document.fit {
                    let what = "Change solver".to_owned();
                    requests.edit(Edit::SetFit { options: Box::new(options), what });
                }
                requests.commands.extend([Command::Tracking(TrackingCommand::Clear), FIRST, TRACK]);
            }
        }
    }
}
