//! The choices of tracking, in the Solver section: how motion is carried on, and when other poses are looked for.

use backlit_document::edit::Edit;
use backlit_document::tracking_choices::{AtKeys, CueChoice, Following, TrackPrior, TrackedBody};
use backlit_tracking::track::WhenToSearch;
use backlit_ui::widgets::{choice, hint, named_row, number_field};
use egui::Ui;

use crate::context::{Context, Requests};

/// Width of the names, as in the rest of the section.
const NAME: f32 = 78.0;
/// Width of the boxes.
const BOX: f32 = 104.0;
/// Width of the lag's field.
const LAG: f32 = 40.0;
/// The longest lag that can be typed, frames.
const LONGEST_LAG: f64 = 999.0;

const MOTIONS: [(Following, &str, &str); 5] = [
    (Following::Still, "Still", "A frame’s fit starts from the last pose"),
    (Following::Velocity, "Velocity", "It starts where the motion between the last two frames leads"),
    (Following::Kalman, "Kalman", "Pose and velocity by the iterated extended Kalman filter (6.1)"),
    (
        Following::Steered,
        "Steered",
        "The Kalman filter, and every fit begins at its prediction and carries it",
    ),
    (
        Following::Smoothed { lag: None },
        "Smoothed",
        "The Kalman filter, and every frame smoothed by later ones (Rauch, Tung, Striebel); cost and overlap stay \
         those of the frame’s own fit",
    ),
];

const SEARCHES: [(WhenToSearch, &str, &str); 3] = [
    (WhenToSearch::Never, "Never", "Never search: only go downhill from the start"),
    (
        WhenToSearch::WhenPoor,
        "When poor",
        "Look for other poses in a first frame, and in one after a lost one, whose fit overlaps poorly: IoU below 0.9",
    ),
    (
        WhenToSearch::Always,
        "Always",
        "Look for other poses in every first frame and after every lost one; takes seconds",
    ),
];

const AT_KEYS: [(AtKeys, &str, &str); 3] = [
    (AtKeys::Keep, "Keep", "A key pose on the way stays as it was set, and the track goes on from it"),
    (AtKeys::Refine, "Refine", "The fit of a frame with a key pose begins there and may change it"),
    (AtKeys::Stop, "Stop before", "The track ends before the next key pose"),
];

const BODIES: [(TrackedBody, &str, &str); 2] = [
    (
        TrackedBody::Own,
        "Own sizes",
        "The take has an average body: Track forward finds the person’s own lengths and girths first",
    ),
    (TrackedBody::AsItIs, "As it is", "Track the body of the take with the sizes that it has"),
];

const PRIORS: [(TrackPrior, &str, &str); 2] = [
    (
        TrackPrior::People,
        "People",
        "The prior learnt from motion that comes with the program pulls at tracked poses, where silhouettes do not decide",
    ),
    (TrackPrior::None, "None", "No prior says which poses are likely, but for that of the fit above"),
];

const CUES: [(CueChoice, &str, &str); 4] = [
    (CueChoice::None, "None", "Silhouettes alone: a limb before or behind another may drift"),
    (
        CueChoice::Keypoints,
        "Keypoints",
        "The take’s 2-D keypoints of another tool pull at limbs that no camera’s silhouette shows",
    ),
    (
        CueChoice::Pictures,
        "Pictures",
        "Optic flow and stereo points of the pictures pull at limbs that no silhouette shows; slower",
    ),
    (CueChoice::All, "All", "Keypoints where the take has them, optic flow and stereo points; slower"),
];

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let choices = context.document().tracking;
    let mut chosen = choices;
    named_row(ui, "Motion", NAME, |ui| chosen.motion = motion(ui, choices.motion));
    choose(ui, ("Search", "for other poses"), &SEARCHES, &mut chosen.search);
    choose(ui, ("Key poses", "on the way"), &AT_KEYS, &mut chosen.at_keys);
    choose(ui, ("Prior", "of likely poses"), &PRIORS, &mut chosen.prior);
    choose(ui, ("Cues", "of hidden limbs"), &CUES, &mut chosen.cues);
    if context.lacks_sizes() {
        choose(ui, ("Body", "of the person"), &BODIES, &mut chosen.body);
    }
    if chosen != choices {
        requests.edit(Edit::SetTracking(chosen));
    }
}

/// A row with its name, a box of what there is to choose, and a hint.
fn choose<T: Copy + PartialEq, const N: usize>(
    ui: &mut Ui,
    (name, says): (&str, &str),
    offered: &[(T, &str, &str); N],
    chosen: &mut T,
) {
    named_row(ui, name, NAME, |ui| {
        let rows = offered.map(|(value, text, tooltip)| (value, text, tooltip.to_owned()));
        let text = rows.iter().find(|(value, ..)| value == chosen).map_or("", |(_, text, _)| text);
        if let Some(value) = choice(ui, name, BOX, text, &rows) {
            *chosen = value;
        }
        hint(ui, says);
    });
}

fn motion(ui: &mut Ui, motion: Following) -> Following {
    let same = |other: Following| std::mem::discriminant(&other) == std::mem::discriminant(&motion);
    let rows = MOTIONS.map(|(motion, text, tooltip)| (motion, text, tooltip.to_owned()));
    let text = rows.iter().find(|(other, ..)| same(*other)).map_or("", |(_, text, _)| text);
    if let Some(other) = choice(ui, "Motion", BOX, text, &rows) {
        return other;
    }
    let Following::Smoothed { lag } = motion else {
        hint(ui, "from frame to frame");
        return motion;
    };
    let mut frames = lag.map_or(0.0, |lag| lag as f64);
    let field = number_field(ui, "Lag", &mut frames, 0, "", 0.1, LAG);
    let tooltip =
        "Smooth every frame by so many frames after it; 0: by all of them, once the track has ended";
    let changed = field.on_hover_text(tooltip).changed();
    hint(ui, if lag.is_some() { "frames late" } else { "by all frames" });
    if changed {
        let frames = frames.round().clamp(0.0, LONGEST_LAG) as usize;
        return Following::Smoothed { lag: (frames > 0).then_some(frames) };
    }
    motion
}
