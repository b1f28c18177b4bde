//! Begun, stopped, and what was found taken in.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::{Duration, Instant};

use backlit_document::edit::Edit;
use backlit_document::tracking_choices::{AtKeys, TrackedBody};
use backlit_jobs::{Job, News};
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::Person;
use backlit_tracking::posing;
use backlit_ui::style::format;

use super::background_job::{self, BackgroundJob};
use super::body_job::{self, BodyJob};
use super::job::{Leg, TrackInputs, TrackJob};
use super::keys::keys_around;
use super::person_job::PersonJob;
use super::poses_job::{OtherPose, PosesJob};
use super::{Found, OtherPoses, Tracking, Work, body, spheres};
use crate::context::activity::TrackingProgress;
use crate::context::command::{Command, FitCommand, HistoryCommand, TrackingCommand};
use crate::context::command_button::next_gesture;
use crate::context::{Context, Request, Requests};
use crate::session::playback::{FrameRange, PlaybackChange};

/// While the tracker is at work, the screen goes on to its newest frame this often: drawing every one would take
/// the tracker's time.
const FOLLOW_EVERY: Duration = Duration::from_millis(100);

/// Which frames are tracked.
struct Way {
    legs: VecDeque<Leg>,
    backwards: bool,
    between: Option<(usize, usize)>,
    turns_round: bool,
}

impl Way {
    fn on(legs: impl Into<VecDeque<Leg>>, backwards: bool) -> Self {
        Self { legs: legs.into(), backwards, between: None, turns_round: false }
    }
}

impl Tracking {
    /// Does a command. A fit that was going on has ended.
    pub(crate) fn run(&mut self, command: TrackingCommand, context: &Context<'_>, requests: &mut Requests) {
        match command {
            TrackingCommand::FindStart => self.find_start(context, requests),
            TrackingCommand::Forward => self.track_forward(context, requests),
            TrackingCommand::Back => self.track(true, context, requests),
            TrackingCommand::Between => self.track_between_keys(context, requests),
            TrackingCommand::TurnRound => self.turn_round(context, requests),
            TrackingCommand::LearnBackground => self.learn_background(context),
            TrackingCommand::Clear => clear(context, requests),
        }
    }

    /// Tracks from the frame on the screen to the end or the beginning.
    fn track(&mut self, backwards: bool, context: &Context<'_>, requests: &mut Requests) {
        let (here, count) = (context.selection.frame, context.session.frame_count());
        let frames = if backwards { (0..=here).rev().collect() } else { (here..count).collect() };
        let legs = [leg(context, here, context.shown_pose(), frames)];
        let keys = other_keys(context, &[here]);
        let mut way = Way::on(legs, backwards);
        let stops = context.document().tracking.at_keys == AtKeys::Stop;
        if stops && let Some(leg) = way.legs.front_mut() {
            let free =
                leg.frames.iter().position(|frame| keys.contains_key(frame)).unwrap_or(leg.frames.len());
            if let Some(key) = leg.frames.get(free) {
                requests.status(format!("The track will end before the key pose of frame {key}."));
            }
            leg.frames.truncate(free);
        }
        self.begin_tracking(way, keys, context, requests);
    }

    /// Tracks from the key pose before forwards and from the one after backwards, and joins the two.
    fn track_between_keys(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let document = context.document();
        let Some((first, last)) = keys_around(document, context.selection.frame) else { return };
        let leg = |key: usize, frames| leg(context, key, document.pose_at(key), frames);
        let legs = [leg(first, (first..=last).collect()), leg(last, (first..=last).rev().collect())];
        let way = Way { between: Some((first, last)), ..Way::on(legs, false) };
        self.begin_tracking(way, other_keys(context, &[first, last]), context, requests);
    }

    /// Turns every pose that was found to face the other way, and fits each frame again from there; key poses are
    /// turned at once.
    fn turn_round(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let document = context.document();
        let found = document.estimates.iter().filter(|(frame, _)| !document.keys.contains_key(*frame));
        let poses: BTreeMap<usize, Pose> =
            found.map(|(frame, estimate)| (*frame, estimate.pose.clone())).collect();
        if let Some((&first, start)) = poses.first_key_value() {
            let leg = Leg { start: start.clone(), continues: None, frames: poses.keys().copied().collect() };
            let way = Way { turns_round: true, ..Way::on([leg], false) };
            self.begin_tracking(way, poses, context, requests);
            requests.request(Request::Follow(first));
        } else {
            self.gesture = Some(next_gesture(context.egui));
        }
        for (&frame, key) in document.keys.iter() {
            let pose = posing::turn_round(&document.model, key);
            let edit = Edit::SetPose { frame, pose, what: "Turn track round".to_owned() };
            requests.edits.push((edit, self.gesture));
        }
    }

    /// `keys` are the poses from which the fit of their frames begins.
    fn begin_tracking(
        &mut self,
        way: Way,
        keys: BTreeMap<usize, Pose>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let Some((take, fit)) = context.session.take.clone().zip(context.fit_inputs()) else { return };
        let document = context.document();
        let Way { legs, backwards, between, turns_round } = way;
        let total = legs.iter().map(|leg| leg.frames.len()).sum();
        let asked = || legs.iter().flat_map(|leg| leg.frames.iter().copied());
        let range = FrameRange::between(asked().min().unwrap_or(0), asked().max().unwrap_or(0));
        let inputs = TrackInputs {
            footage: take,
            measurement: document.measurement.clone(),
            fit,
            choices: document.tracking,
            keys,
            turns_round,
            legs,
        };
        let began = Instant::now();
        let work = Work::Track(TrackingProgress { done: 0, total, backwards, between, range, began });
        self.begin(work, context, TrackJob::new(inputs));
        self.gesture = Some(next_gesture(context.egui));
        (self.follows, self.newest, self.shown) = (true, None, None);
        requests.request(Request::Playback(PlaybackChange::Pause));
        requests.request(Request::LeaveStep);
    }

    /// Begins work; what was under way is superseded.
    fn begin(&mut self, work: Work, context: &Context<'_>, job: impl Job<Found> + 'static) {
        self.task.begin(context.pool, (), |()| job);
        self.work = Some(work);
    }

    /// Looks for other poses that fit the frame on the screen.
    pub(crate) fn search_poses(&mut self, context: &Context<'_>) {
        let Some(fit) = context.fit_inputs() else { return };
        let start = context.shown_pose().clone();
        self.begin(Work::Search(context.selection.frame), context, PosesJob { fit, start });
    }

    /// Fits lengths and radii to the frames that have poses of their own, or makes a body of spheres from them.
    pub(crate) fn make_body(&mut self, command: FitCommand, context: &Context<'_>, requests: &mut Requests) {
        let Some((footage, fit)) = context.session.take.clone().zip(context.fit_inputs()) else { return };
        let measurement = context.document().measurement.clone();
        let read = Vec::new();
        if command == FitCommand::MakeSpheres {
            let waiting = body::frames(context, body::SPHERE_FRAMES);
            self.at = None;
            let job = BodyJob { footage, measurement, fit, waiting, read, make: spheres::spheres };
            self.begin(Work::Spheres, context, job);
        } else {
            let waiting = body::frames(context, body::SIZE_FRAMES);
            let job = BodyJob { footage, measurement, fit, waiting, read, make: body_job::sizes };
            self.begin(Work::FitBody, context, job);
        }
        requests.request(Request::LeaveStep);
    }

    /// Learns the plates again without the body where it was tracked.
    fn learn_background(&mut self, context: &Context<'_>) {
        let Some(job) = BackgroundJob::new(context) else { return };
        self.at = None;
        self.begin(Work::Background, context, job);
    }

    /// Tracks from the frame on the screen to the end. What is lacking is found first: a start, the person's own sizes.
    fn track_forward(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let sizes = context.document().tracking.body == TrackedBody::Own && context.lacks_sizes();
        if sizes || context.lacks_start() {
            let start = (!context.lacks_start()).then(|| context.shown_pose().clone());
            self.find_person(start, sizes, context, requests);
            self.tracks_then = true;
        } else {
            self.track(false, context, requests);
        }
    }

    /// Looks for the person in the frame on the screen.
    fn find_start(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.find_person(None, false, context, requests);
        self.tracks_then = false;
    }

    fn find_person(
        &mut self,
        start: Option<Pose>,
        sizes: bool,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let Some((take, fit)) = context.session.take.clone().zip(context.fit_inputs()) else { return };
        let (here, count) = (context.selection.frame, context.session.frame_count());
        let (measurement, frames) = (context.document().measurement.clone(), (here..count).collect());
        self.at = start.is_some().then(|| "Finding the person’s sizes".to_owned());
        let job = PersonJob { footage: take, measurement, fit, start, frames, sizes };
        self.begin(Work::Person, context, job);
        requests.request(Request::LeaveStep);
    }

    /// The person who was found becomes the document's.
    fn person_found(
        &mut self,
        frame: usize,
        person: &Person,
        said: String,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let before = &context.document().model;
        if *person.model != **before {
            requests.edit(Edit::SetBody(Arc::new((*person.model).clone().renamed(before.name()))));
        }
        let what = "Find person".to_owned();
        requests.edit(Edit::SetPose { frame, pose: person.start.clone(), what });
        requests.inform(said, Some(Command::History(HistoryCommand::Undo)));
        self.tracks_next = std::mem::take(&mut self.tracks_then);
    }

    /// Takes in what was found since the last frame of the window; all of a track is one undoable act.
    pub(crate) fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if std::mem::take(&mut self.tracks_next) {
            self.track(false, context, requests);
            return;
        }
        let (mut track, mut has_ended) = (Vec::new(), false);
        for news in self.task.poll() {
            match news {
                News::Output(Found::Loaded(frame)) => requests.frames.push(frame),
                News::Output(Found::Tracked(frame, estimate)) => {
                    track.push((frame, estimate));
                    self.newest = Some(frame);
                    if let Some(Work::Track(progress)) = &mut self.work {
                        progress.done += 1;
                    }
                }
                News::Output(Found::Revised(found)) => track.extend(found),
                News::Output(Found::Believed(found)) => requests.beliefs.extend(found),
                News::Output(Found::Held(found)) => requests.held.extend(found),
                News::Output(Found::Joined { frame, distance_m, meets }) => {
                    joined(frame, distance_m, meets, requests);
                }
                News::Output(Found::Poses(frame, found)) => self.poses_found(frame, found, context, requests),
                News::Output(Found::Body(fit)) => body::take_in(&fit, context, requests),
                News::Output(Found::Spheres(body)) => spheres::take_in(&body, context, requests),
                News::Output(Found::Person { frame, person, said }) => {
                    self.person_found(frame, &person, said, context, requests);
                }
                News::Output(Found::Plates(plates)) => background_job::take_in(plates, requests),
                News::Output(Found::At(text)) => self.at = Some(text),
                News::Output(Found::Refused(why)) => requests.complain(why),
                News::Ended => has_ended = true,
                News::Failed(failure) => {
                    requests.failed("The tracker", &failure);
                    has_ended = true;
                }
            }
        }
        if !track.is_empty() {
            requests.edits.push((Edit::AddTrack(track), self.gesture));
        }
        self.follow(context, requests);
        if has_ended && let Some(Work::Track(progress)) = self.work.take() {
            let undo = (progress.done > 0).then_some(Command::History(HistoryCommand::Undo));
            requests.inform(ending(&progress), undo);
        }
    }

    /// Goes on to the newest frame, not more often than the screen can show it.
    fn follow(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let Some(newest) = self.newest else { return };
        if !self.follows {
            self.newest = None;
            return;
        }
        let since = self.shown.map_or(FOLLOW_EVERY, |shown| shown.elapsed());
        let is_drawn = !context.session.is_stale;
        if !self.is_busy() || (since >= FOLLOW_EVERY && is_drawn) {
            self.newest = None;
            self.shown = Some(Instant::now());
            requests.request(Request::Follow(newest));
        } else {
            context.egui.request_repaint_after(FOLLOW_EVERY.saturating_sub(since));
        }
    }

    /// Other poses were found for a frame: by a search, or on the way of the tracker.
    fn poses_found(
        &mut self,
        frame: usize,
        found: Vec<OtherPose>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        if matches!(self.work, Some(Work::Search(searched)) if searched == frame) {
            let text = match found.len() {
                0 | 1 => format!("Frame {frame}: no other pose was found that fits."),
                2 => format!("Frame {frame}: two poses fit; see Refit."),
                poses => format!("Frame {frame}: {poses} poses fit; see Refit."),
            };
            requests.inform(text, None);
        }
        let fit = context.document().fit.clone();
        self.other_poses.insert(frame, OtherPoses { found, fit });
    }
}

/// The key poses, but for those of frames where a leg begins, from the pose on the screen.
fn other_keys(context: &Context<'_>, begins: &[usize]) -> BTreeMap<usize, Pose> {
    let mut keys = (*context.document().keys).clone();
    keys.retain(|key, _| !begins.contains(key));
    keys
}

/// A way through these frames. A first frame that was fitted from this pose needs no second fit.
fn leg(context: &Context<'_>, from: usize, start: &Pose, mut frames: VecDeque<usize>) -> Leg {
    let found = context.document().estimates.get(&from);
    let is_fitted = frames.len() > 1 && found.is_some_and(|found| !found.lost && found.pose == *start);
    if is_fitted {
        frames.pop_front();
    }
    Leg { start: start.clone(), continues: is_fitted.then_some(from), frames }
}

fn clear(context: &Context<'_>, requests: &mut Requests) {
    let document = context.document();
    requests.edit(Edit::ClearEstimates);
    let kept = match document.keys.len() {
        0 => String::new(),
        1 => "; 1 key pose stays".to_owned(),
        keys => format!("; {keys} key poses stay"),
    };
    let poses = match document.estimates.len() {
        1 => "pose of 1 frame".to_owned(),
        frames => format!("poses of {frames} frames"),
    };
    let text = format!("Cleared the {poses}{kept}.");
    requests.inform(text, Some(Command::History(HistoryCommand::Undo)));
}

/// What the tracker did, once it has ended.
fn ending(tracking: &TrackingProgress) -> String {
    let TrackingProgress { done, total, between, .. } = *tracking;
    let whole = done == total;
    match between {
        Some((first, last)) if whole => {
            format!("Tracked between the key poses of frames {first} and {last}, from both sides.")
        }
        _ if whole && done == 1 => "Tracked one frame.".to_owned(),
        _ if whole => format!("Tracked {done} frames."),
        Some((first, last)) => format!(
            "Stopped after {done} of {total} fits between the key poses of frames {first} and {last}; the two tracks \
             are not joined."
        ),
        None => format!("Stopped after {done} of {total} frames."),
    }
}

/// Says where two tracks were joined, and what to do where they do not meet.
fn joined(frame: usize, distance_m: f64, meets: bool, requests: &mut Requests) {
    let centimetres = format::number(100.0 * distance_m, 1);
    if meets {
        requests.status(format!("Joined after frame {frame}, where both tracks agree to {centimetres} cm."));
    } else {
        requests.complain(format!(
            "The two tracks do not meet: they are nearest in frame {frame}, {centimetres} cm apart. \
             Set another key pose near there and track again."
        ));
    }
}
