//! Work on many frames, one kind at a time: the tracker, the search for other poses that fit a frame, and the fit of the
//! body's own sizes.
//!
//! | file | holds |
//! |---|---|
//! | `update` | begun, stopped, what was found taken in |
//! | `job`, [`read_ahead`] | the fit of frame after frame |
//! | `poses_job`, `body_job`, `person_job` | the search, a body from several frames, and both where nothing is known |
//! | `background_job` | plates learnt again without the tracked body |
//! | `spheres` | a body of spheres, in the place of the sizes |
//! | `body` | which frames say something of the sizes, and what is said of them |
//! | `survey` | whether the silhouettes can be a person's at all |
//! | `keys` | the key poses around a frame |
//! | `choices` | how it tracks, in the Solver section |
//! | `other_poses` | what a search has found, in the Refit section |

mod background_job;
mod body;
mod body_job;
pub(crate) mod choices;
mod job;
mod keys;
mod other_poses;
mod person_job;
mod pose_words;
mod poses_job;
mod read_ahead;
mod spheres;
mod survey;
#[cfg(test)]
mod tests;
mod update;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use backlit_document::Estimate;
use backlit_document::history::Gesture;
use backlit_jobs::{Priority, Task};
use backlit_tracking::body_fit::{BodyFit, Person};
use backlit_tracking::body_spheres::SphereBody;
use backlit_tracking::fit::FitOptions;
use backlit_ui::style::format;

use crate::context::Context;
use crate::context::activity::TrackingProgress;
use crate::context::command::TrackingCommand;
use crate::context::unavailable::{Why, because, no_silhouette, no_take, not_tracked};
use crate::session::{BelievedJoints, FrameData, HeldLimbs};
use keys::keys_around;
use poses_job::OtherPose;

/// The feature.
#[derive(Debug)]
pub(crate) struct Tracking {
    task: Task<(), Found>,
    work: Option<Work>,
    /// All frames of a track are one undoable act.
    gesture: Option<Gesture>,
    other_poses: BTreeMap<usize, OtherPoses>,
    /// Whether the screen follows the tracker.
    follows: bool,
    /// The frame that the screen goes to next.
    newest: Option<usize>,
    /// When it went on last.
    shown: Option<Instant>,
    /// How far the search for a person is.
    at: Option<String>,
    /// All frames are tracked as soon as the person is found.
    tracks_then: bool,
    /// What was found has become the document's: it is tracked next.
    tracks_next: bool,
}

/// What is being done.
#[derive(Debug, Clone, Copy)]
enum Work {
    Track(TrackingProgress),
    /// Of other poses, for a frame.
    Search(usize),
    FitBody,
    /// A body of spheres is made.
    Spheres,
    /// A person is found: where they stand, their own sizes.
    Person,
    /// Plates are learnt without the body.
    Background,
}

/// What the jobs say.
#[derive(Debug)]
enum Found {
    /// A frame was read.
    Loaded(Arc<FrameData>),
    /// A frame was tracked.
    Tracked(usize, Arc<Estimate>),
    /// What was tracked before is now known better: smoothed by later frames, or joined with another track.
    Revised(Vec<(usize, Arc<Estimate>)>),
    /// What the Kalman filter believed of frames.
    Believed(Vec<(usize, BelievedJoints)>),
    /// What held the limbs of frames.
    Held(Vec<(usize, HeldLimbs)>),
    /// Two tracks were joined after this frame; so far apart were their joints there.
    Joined { frame: usize, distance_m: f64, meets: bool },
    /// Poses that fit a frame, best first.
    Poses(usize, Vec<OtherPose>),
    /// The body's own sizes.
    Body(Box<BodyFit>),
    /// A body of spheres.
    Spheres(Box<SphereBody>),
    /// Where the person stands in a frame, and the body; what is said of it.
    Person { frame: usize, person: Box<Person>, said: String },
    /// Plates learnt without the body.
    Plates(background_job::Plates),
    /// How far it is, in words.
    At(String),
    /// It cannot go on; why.
    Refused(String),
}

/// What a search has found for a frame.
#[derive(Debug, Clone)]
struct OtherPoses {
    /// Best first.
    found: Vec<OtherPose>,
    /// The choices of the fit by which they were measured.
    fit: Arc<FitOptions>,
}

impl Default for Tracking {
    fn default() -> Self {
        Self {
            task: Task::new(Priority::TRACK),
            work: None,
            gesture: None,
            other_poses: BTreeMap::new(),
            follows: false,
            newest: None,
            shown: None,
            at: None,
            tracks_then: false,
            tracks_next: false,
        }
    }
}

impl Tracking {
    /// The same without any work that is going on, for a picture of it.
    pub(crate) fn at_rest(&self) -> Self {
        Self { other_poses: self.other_poses.clone(), ..Self::default() }
    }

    /// Another take is open.
    pub(crate) fn reset(&mut self) {
        *self = Self::default();
    }

    /// Whether there is work under way, of any kind.
    pub(crate) const fn is_busy(&self) -> bool {
        self.task.is_busy()
    }

    /// How far the tracker is.
    pub(crate) fn progress(&self) -> Option<TrackingProgress> {
        self.work.and_then(|work| if let Work::Track(progress) = work { Some(progress) } else { None })
    }

    /// Asks the work to end; what it has found stays.
    pub(crate) fn stop(&self) {
        self.task.stop();
    }

    /// The user has gone elsewhere: the screen follows the tracker no more.
    pub(crate) fn stop_following(&mut self) {
        self.follows = false;
    }

    /// What is being done, for the status bar.
    pub(crate) fn sentence(&self) -> Option<String> {
        let tracking = match self.work? {
            Work::Search(_) => {
                return Some("Looking for other poses that fit this frame. Esc stops it.".to_owned());
            }
            Work::FitBody => {
                let text = "Fitting the body to several frames. Esc stops it; nothing is changed then.";
                return Some(text.to_owned());
            }
            Work::Spheres => {
                let at = self.at.as_deref().unwrap_or("Making a body of spheres");
                return Some(format!("{at}. Esc stops it; nothing is changed then."));
            }
            Work::Person => {
                let at = self.at.as_deref().unwrap_or("Looking for the person");
                return Some(format!("{at}. Esc stops it; nothing is changed then."));
            }
            Work::Background => {
                let at = self.at.as_deref().unwrap_or("Learning the background without the body");
                return Some(format!("{at}. Esc stops it; nothing is changed then."));
            }
            Work::Track(progress) => progress,
        };
        let way = match tracking.between {
            Some((first, last)) => format!(" between the key poses of {first} and {last}, from both sides"),
            None if tracking.backwards => " back".to_owned(),
            None => String::new(),
        };
        let rate = tracking.rate();
        let rate = rate.map_or_else(String::new, |rate| format!(", {} a second", format::number(rate, 1)));
        Some(format!("Tracking{way}, {} of {} frames{rate}.", tracking.done, tracking.total))
    }

    /// Why a command cannot be used now.
    pub(crate) fn unavailable(&self, command: TrackingCommand, context: &Context<'_>) -> Why {
        let (document, frame) = (context.document(), context.selection.frame);
        let no_track = || {
            no_take(context)
                .or(because(document.used_cameras().next().is_none(), "No camera is used in the fit"))
                .or(because(self.is_busy(), "The tracker is running"))
                .or(no_silhouette(context))
        };
        match command {
            TrackingCommand::Forward => {
                let is_last = frame + 1 >= context.session.frame_count();
                no_track().or(because(is_last, "This is the last frame: Enter fits it"))
            }
            TrackingCommand::Back => {
                no_track().or(because(frame == 0, "This is the first frame: Enter fits it"))
            }
            TrackingCommand::Between => no_track().or(match keys_around(document, frame) {
                None => Some("Set a key pose before this frame and one after it, with K"),
                Some((first, last)) => {
                    because(last - first < 2, "There is no frame between the key poses around this frame")
                }
            }),
            TrackingCommand::FindStart => no_track(),
            TrackingCommand::TurnRound => no_track().or(not_tracked(context)),
            TrackingCommand::LearnBackground => {
                background_job::unavailable(context).or(because(self.is_busy(), "The tracker is running"))
            }
            TrackingCommand::Clear => not_tracked(context),
        }
    }
}
