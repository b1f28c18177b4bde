//! Work on many frames, one kind at a time: the tracker, the search for other poses that fit a frame, and the fit of the
//! body's own sizes. A job sends what is to be done with its results, see [`Applied`].

mod background_job;
mod body;
pub(crate) mod choices;
mod job;
mod offer;
mod other_poses;
mod people;
#[cfg(test)]
mod tests;
mod update;

use backlit_formats::Footage;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use backlit_document::edit::Tracked;
use backlit_document::history::Gesture;
use backlit_jobs::Task;
use backlit_tracking::body::Pose;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::people::PersonTrack;
use backlit_tracking::search::Origin;
use backlit_ui::style::format;

use crate::context::activity::{TrackingProgress, WorkShare};
use crate::context::command::{Command, FitCommand, TrackingCommand};
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_silhouette, no_take, not_tracked};
use crate::context::{Context, FeatureRequest, Published, Requests, priority};
use update::{joined, keys_around};

#[derive(Debug, Default)]
pub(crate) struct Tracking {
    task: Task<(), Applied, { priority::TRACK }>,
    work: Option<TrackingWork>,
    /// All frames of a track are one undoable act.
    gesture: Option<Gesture>,
    /// Frames of the track that the document does not have yet.
    tracked: Vec<Tracked>,
    other_poses: BTreeMap<usize, OtherPoses>,
    /// Whether the screen follows the tracker: not once the user has gone elsewhere.
    pub(crate) follows: bool,
    /// The frame that the screen goes to next.
    newest: Option<usize>,
    /// When it went on last.
    shown: Option<Instant>,
    /// All frames are tracked as soon as the person is found.
    tracks_then: bool,
    /// The person was found and is the document's: all frames are tracked next.
    tracks_next: bool,
    /// The people to choose from, while one is to be chosen.
    people: Arc<Vec<PersonTrack>>,
}

#[derive(Debug, Clone)]
enum TrackingWork {
    Track(TrackingProgress),
    /// Other poses are looked for in a frame.
    Search(usize),
    /// Something that changes nothing when it is stopped; how far it is, in words, and how much of it is done.
    Make(String, Option<WorkShare>),
}

/// What is done with a result of a job, on the window's thread.
type Applied = Box<dyn FnOnce(&mut Tracking, &Context<'_>, &mut Requests) + Send>;

fn applied(apply: impl FnOnce(&mut Tracking, &Context<'_>, &mut Requests) + Send + 'static) -> Applied {
    Box::new(apply)
}

/// The work cannot go on; why, in a sentence.
fn refused(why: String) -> Applied {
    applied(move |_, _, requests| requests.complain(why))
}

/// How far the work is, in words, and how much of it is done where that can be told.
fn progress(text: String, share: Option<WorkShare>) -> Applied {
    applied(move |tracking, _, _| tracking.work = Some(TrackingWork::Make(text, share)))
}

/// A pose that a search has found.
#[derive(Debug, Clone)]
struct OtherPose {
    pose: Pose,
    origin: Origin,
    /// Root mean square residual in grey levels, as the views and the timeline measure it.
    rms: Option<f64>,
}

/// What a search has found for a frame.
#[derive(Debug, Clone)]
struct OtherPoses {
    /// Best first.
    found: Vec<OtherPose>,
    /// The choices of the fit by which they were measured.
    fit: Arc<FitOptions>,
}

impl Feature for Tracking {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.take_in(context, requests);
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        match command {
            Command::Tracking(command) => self.do_command(command, context, requests),
            Command::Fit(FitCommand::SearchPoses) => self.search_poses(context),
            Command::Fit(command @ (FitCommand::FitBody | FitCommand::MakeSpheres)) => {
                self.make_body(command, context, requests);
            }
            Command::Fit(FitCommand::Stop) => self.stop(),
            _ => return false,
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Tracking(command) = command else { return None };
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
            TrackingCommand::ChoosePerson => self.cannot_find_people(context),
            TrackingCommand::FollowEverybody => self.cannot_follow_everybody(context),
            TrackingCommand::Clear => not_tracked(context),
        }
    }

    fn publish(&self, published: &mut Published) {
        published.people = self.people.clone();
    }

    fn answer(&mut self, request: &FeatureRequest, _: &Context<'_>, requests: &mut Requests) {
        if let FeatureRequest::FollowPerson(number) = request {
            self.follow_person(*number, requests);
        }
    }

    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        let tracking = match self.work.as_ref()? {
            TrackingWork::Search(_) => {
                return Some("Looking for other poses that fit this frame. Esc stops it.".to_owned());
            }
            TrackingWork::Make(at, _) => {
                return Some(format!("{at}. Esc stops it; nothing is changed then."));
            }
            TrackingWork::Track(progress) => progress,
        };
        if let Some([done, all]) = tracking.surveyed {
            return Some(format!(
                "Looking for backgrounds that change, {done} of {all} frames; then the frames are tracked."
            ));
        }
        let direction = match tracking.between {
            Some((first, last)) => format!(" between the key poses of {first} and {last}, from both sides"),
            None if tracking.backwards => " back".to_owned(),
            None => String::new(),
        };
        let rate = tracking.rate();
        let rate = rate.map_or_else(String::new, |rate| format!(", {} a second", format::number(rate, 1)));
        Some(format!("Tracking{direction}, {} of {} frames{rate}.", tracking.done, tracking.total))
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self::default();
    }

    fn at_rest(&self) -> Self {
        Self { other_poses: self.other_poses.clone(), ..Self::default() }
    }
}

impl Tracking {
    pub(crate) const fn is_busy(&self) -> bool {
        self.task.is_busy()
    }

    /// How much of the work under way is done, where that can be told.
    pub(crate) fn share(&self) -> Option<WorkShare> {
        match self.work.as_ref()? {
            TrackingWork::Make(_, share) => *share,
            TrackingWork::Track(TrackingProgress { surveyed: Some([done, total]), .. }) => {
                Some(WorkShare { done: *done, total: *total })
            }
            TrackingWork::Track(TrackingProgress { done, total, .. }) => {
                Some(WorkShare { done: *done, total: *total })
            }
            TrackingWork::Search(_) => None,
        }
    }

    pub(crate) fn progress(&self) -> Option<TrackingProgress> {
        if let Some(TrackingWork::Track(progress)) = self.work { Some(progress) } else { None }
    }

    /// Asks the work to end; what it has found stays.
    pub(crate) fn stop(&self) {
        self.task.stop();
    }
}
