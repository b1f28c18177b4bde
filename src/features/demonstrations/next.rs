//! What to try next in a demonstration: a button each.

use backlit_document::edit::Edit;
use backlit_document::tracking_choices::{CueChoice, TrackingChoices};
use backlit_document::{Origin, fit_words, likely_poses};
use backlit_take::demonstration::Demonstration;
use backlit_tracking::fit::Preset;
use backlit_tracking::render::RendererKind;

use crate::context::command::{
    BeginningCommand, Command, FitCommand, SceneCommand, TimelineCommand, TrackingCommand, Variants,
    WindowCommand,
};
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{Context, FeatureRequest, Requests, ShellRequest};

/// What a demonstration opens with.
#[derive(Debug, Clone, Copy)]
pub(super) enum Opening {
    /// Fits side by side that differ in this, in the pictures of a camera: where one camera counts that cannot see depth, of
    /// the other.
    Laboratory(Variants, usize),
    /// The pose layout with this pane too, and a command.
    Tiles(Option<Pane>, Command),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Suggestion {
    pub(super) text: &'static str,
    /// One sentence without its full stop. `{renderers}` stands for all of them.
    tooltip: &'static str,
    action: SuggestedAction,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum SuggestedAction {
    /// Done one after the other.
    Commands(&'static [Command]),
    /// The laboratory fits these side by side.
    Compare(Variants),
    /// A camera counts from now on, and the laboratory fits again.
    UseCamera(usize),
    /// All frames are tracked with these cues, and with likely poses of this weight.
    Track(CueChoice, f64),
}

const fn suggest(text: &'static str, tooltip: &'static str, action: SuggestedAction) -> Suggestion {
    Suggestion { text, tooltip, action }
}

const POSE: Command = Command::Window(WindowCommand::Layout(Layout::Pose));
const FIRST: Command = Command::Timeline(TimelineCommand::FirstFrame);
const TRACK: Command = Command::Tracking(TrackingCommand::Forward);
const REPORT: Command = Command::Fit(FitCommand::Preset(Preset::Report));
const ROBUST: Command = Command::Fit(FitCommand::Preset(Preset::Robust));

const RENDERERS: Suggestion = suggest(
    "Compare renderers",
    "{renderers} from the same start",
    SuggestedAction::Compare(Variants::Renderers),
);
const RAMPS: Suggestion = suggest(
    "Compare ramps",
    "From the same start, a fit for each way to draw how far a pixel is from the body",
    SuggestedAction::Compare(Variants::Ramps),
);
const PRESETS: Suggestion = suggest(
    "Compare presets",
    "The report’s fit beside the robust one, from the same start",
    SuggestedAction::Compare(Variants::Presets),
);
const WITH_CAMERA_2: Suggestion =
    suggest("Fit with camera 2 too", "Let camera 2 count, and fit again", SuggestedAction::UseCamera(1));
const TRACK_REPORT: Suggestion = suggest(
    "Track as in 2004",
    "All frames by the report’s preset, each from the last one’s pose, in the Pose layout",
    SuggestedAction::Commands(&[POSE, REPORT, FIRST, TRACK]),
);
const TRACK_ROBUST: Suggestion = suggest(
    "Track with Robust",
    "All frames with all that is better, in the Pose layout",
    SuggestedAction::Commands(&[POSE, ROBUST, FIRST, TRACK]),
);
const WAYS: Suggestion = suggest(
    "Try all again",
    "All ways from the pose of this frame, one after the other",
    SuggestedAction::Commands(&[POSE, Command::Beginning(BeginningCommand::RunAll)]),
);
const ACQUIRE: Suggestion = suggest(
    "Acquire a body",
    "Neither pose nor size is known: a body is found, and grown limb by limb",
    SuggestedAction::Commands(&[POSE, Command::Beginning(BeginningCommand::AcquireBody)]),
);
const WORST: Suggestion = suggest(
    "Worst frame",
    "The tracked frame that fits worst",
    SuggestedAction::Commands(&[POSE, Command::Timeline(TimelineCommand::WorstFrame)]),
);
const SPHERES: Suggestion = suggest(
    "As spheres",
    "Draw and fit the body by the spheres of its trees",
    SuggestedAction::Commands(&[Command::Fit(FitCommand::Renderer(RendererKind::SphereTree {
        spheres: None,
    }))]),
);
const CAPSULES: Suggestion = suggest(
    "As capsules",
    "Draw and fit the body as capsules: look at the overlap",
    SuggestedAction::Commands(&[Command::Fit(FitCommand::Renderer(RendererKind::Capsule))]),
);
const SCENE: Suggestion = suggest(
    "Spheres in 3-D",
    "The body of spheres in the scene, from its front",
    SuggestedAction::Commands(&[Command::Scene(SceneCommand::Front)]),
);
const SILHOUETTES: Suggestion = suggest(
    "Silhouettes alone",
    "Track all frames again without any cue",
    SuggestedAction::Track(CueChoice::None, 0.0),
);
const LIKELY: Suggestion = suggest(
    "With likely poses",
    "Track all frames again without cues, but prefer poses that recorded people took",
    SuggestedAction::Track(CueChoice::None, 3.0),
);
const KEYPOINTS: Suggestion = suggest(
    "With keypoints",
    "Track all frames again; keypoints of another tool pull at limbs that no silhouette shows",
    SuggestedAction::Track(CueChoice::Keypoints, 0.0),
);
const PICTURES: Suggestion = suggest(
    "With the pictures",
    "Track all frames again; optic flow and stereo points pull at limbs that no silhouette shows",
    SuggestedAction::Track(CueChoice::Pictures, 0.0),
);
const ALL_CUES: Suggestion = suggest(
    "With all of them",
    "Track all frames again with keypoints, optic flow and stereo points",
    SuggestedAction::Track(CueChoice::All, 0.0),
);
const PLAY: Suggestion = suggest(
    "Play",
    "Plays all frames with their names, from the first on",
    SuggestedAction::Commands(&[POSE, FIRST, Command::Timeline(TimelineCommand::Play)]),
);

/// What a demonstration opens with, and what there is to try.
pub(super) const fn of(which: Demonstration) -> (Opening, &'static [Suggestion]) {
    const BEGIN: Command = Command::Beginning(BeginningCommand::RunAll);
    const MAKE_SPHERES: Command = Command::Fit(FitCommand::MakeSpheres);
    use Opening::{Laboratory, Tiles};
    match which {
        Demonstration::SingleLimb => (Laboratory(Variants::Renderers, 0), &[RENDERERS, RAMPS]),
        Demonstration::OneCamera => (Laboratory(Variants::Renderers, 1), &[WITH_CAMERA_2, RENDERERS, RAMPS]),
        Demonstration::TwoCameras => (Laboratory(Variants::Renderers, 0), &[PRESETS, RENDERERS, RAMPS]),
        Demonstration::Sequence | Demonstration::TinySequence | Demonstration::RealFootage => {
            (Laboratory(Variants::Presets, 0), &[TRACK_REPORT, TRACK_ROBUST, WORST, RENDERERS])
        }
        Demonstration::Motions => (Tiles(Some(Pane::Motions), TRACK), &[PLAY, TRACK_REPORT, TRACK_ROBUST]),
        Demonstration::Bias => (Laboratory(Variants::Ramps, 1), &[WITH_CAMERA_2, RAMPS, RENDERERS]),
        Demonstration::Spheres => (Tiles(None, MAKE_SPHERES), &[SPHERES, CAPSULES, SCENE]),
        Demonstration::Cues => (Tiles(None, TRACK), &[SILHOUETTES, LIKELY, KEYPOINTS, PICTURES, ALL_CUES]),
        Demonstration::Begin => (Tiles(None, BEGIN), &[WAYS, ACQUIRE, PRESETS]),
    }
}

impl Suggestion {
    pub(super) fn tooltip(&self) -> String {
        self.tooltip.replace("{renderers}", &fit_words::renderers())
    }

    /// Whether what it does is what is on the screen.
    pub(super) fn is_active(&self, context: &Context<'_>) -> bool {
        let document = context.document();
        match self.action {
            SuggestedAction::Track(cues, likely) => {
                let is_tracked = document.estimates.values().any(|found| found.origin == Origin::Track);
                let weight = likely_poses::weight(&document.fit).unwrap_or(0.0);
                is_tracked && document.tracking.cues == cues && weight == likely
            }
            SuggestedAction::Commands([Command::Fit(FitCommand::Renderer(renderer))]) => {
                document.fit.renderer == *renderer
            }
            _ => false,
        }
    }

    pub(super) fn request(&self, which: Demonstration, context: &Context<'_>, requests: &mut Requests) {
        let mut compare = |over| {
            requests.request(ShellRequest::Layout(Layout::Demonstrate));
            requests.request(FeatureRequest::RunLaboratory { over, camera: None });
        };
        match self.action {
            SuggestedAction::Commands(commands) => commands.iter().for_each(|command| requests.run(*command)),
            SuggestedAction::Compare(over) => compare(over),
            SuggestedAction::UseCamera(camera) => {
                if let Opening::Laboratory(over, _) = of(which).0 {
                    compare(over);
                }
                requests.edit(Edit::UseCamera { camera, used: true });
            }
            SuggestedAction::Track(cues, likely) => {
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
