//! Begun, stopped, and what was found taken in.

use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

use backlit_document::Document;
use backlit_document::edit::{Edit, Tracked};
use backlit_document::tracking_choices::{AtKeys, TrackedBody};
use backlit_jobs::{Job, Outbox, TaskEvent, one_step};
use backlit_runs::person::PersonSearch;
use backlit_runs::track::Leg;
use backlit_tracking::body::Pose;
use backlit_tracking::posing;
use backlit_tracking::search::{self, SearchOptions};
use backlit_ui::style::format;

use super::background_job::BackgroundJob;
use super::body::{self, BodyJob};
use super::job::{FEW, TrackJob, TrackOrder, WindowReader, measured};
use super::{Applied, OtherPose, OtherPoses, Tracking, TrackingWork, applied, refused};
use crate::context::activity::TrackingProgress;
use crate::context::command::{Command, FitCommand, HistoryCommand, TrackingCommand};
use crate::context::command_button::next_gesture;
use crate::context::{Context, Requests, SessionRequest};
use crate::session::playback::{FrameRange, PlaybackChange};
use crate::session::prediction::FitInputs;

/// While the tracker is at work, the screen goes on to its newest frame this often: drawing every one would take
/// the tracker's time.
const FOLLOW_EVERY: Duration = Duration::from_millis(100);

impl Tracking {
    /// Does a command. A fit that was going on has ended.
    pub(super) fn do_command(
        &mut self,
        command: TrackingCommand,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        match command {
            TrackingCommand::FindStart => {
                self.find_person(None, false, context, requests);
                self.tracks_then = false;
            }
            TrackingCommand::Forward => self.track_forward(context, requests),
            TrackingCommand::Back => self.track(true, context, requests),
            TrackingCommand::Between => self.track_between_keys(context, requests),
            TrackingCommand::TurnRound => self.turn_round(context, requests),
            TrackingCommand::LearnBackground => {
                let Some(job) = BackgroundJob::new(context) else { return };
                let what = "Learning the background without the body".to_owned();
                self.begin(TrackingWork::Make(what, None), context, job);
            }
            TrackingCommand::ChoosePerson => {
                if let Some(reader) = reader(context) {
                    self.find_people(reader, context);
                }
            }
            TrackingCommand::FollowEverybody => self.follow_everybody(context, requests),
            TrackingCommand::Clear => clear(context, requests),
        }
    }

    /// Tracks from the frame on the screen to the end or the beginning.
    fn track(&mut self, backwards: bool, context: &Context<'_>, requests: &mut Requests) {
        let (here, count) = (context.selection.frame, context.session.frame_count());
        let frames = if backwards { (0..=here).rev().collect() } else { (here..count).collect() };
        let mut leg = leg(context, here, context.shown_pose(), frames);
        let keys = other_keys(context, &[here]);
        if context.document().tracking.at_keys == AtKeys::Stop
            && let Some(free) = leg.frames.iter().position(|frame| keys.contains_key(frame))
        {
            let key = leg.frames[free];
            requests.status(format!("The track will end before the key pose of frame {key}."));
            leg.frames.truncate(free);
        }
        let order = TrackOrder { legs: vec![leg], keys, turns_round: false };
        self.begin_tracking(order, backwards, None, context, requests);
    }

    /// Tracks from the key pose before forwards and from the one after backwards, and joins the two.
    fn track_between_keys(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let document = context.document();
        let Some((first, last)) = keys_around(document, context.selection.frame) else { return };
        let leg = |key: usize, frames| leg(context, key, document.pose_at(key), frames);
        // Neither track comes to the key pose of the other.
        let legs = vec![leg(first, (first..last).collect()), leg(last, (first + 1..=last).rev().collect())];
        let order = TrackOrder { legs, keys: other_keys(context, &[first, last]), turns_round: false };
        self.begin_tracking(order, false, Some((first, last)), context, requests);
    }

    /// Turns every pose that was found to face the other way, and fits each frame again from there; key poses are
    /// turned at once.
    fn turn_round(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let document = context.document();
        let found = document.estimates.iter().filter(|(frame, _)| !document.keys.contains_key(*frame));
        let keys: BTreeMap<usize, Pose> =
            found.map(|(frame, estimate)| (*frame, estimate.pose.clone())).collect();
        if let Some((&first, start)) = keys.first_key_value() {
            let leg = Leg { start: start.clone(), continues: None, frames: keys.keys().copied().collect() };
            let order = TrackOrder { legs: vec![leg], keys, turns_round: true };
            self.begin_tracking(order, false, None, context, requests);
            requests.request(SessionRequest::Follow(first));
        } else {
            self.gesture = Some(next_gesture(context.egui));
        }
        for (&frame, key) in document.keys.iter() {
            let pose = posing::turn_round(&document.model, key);
            let edit = Edit::SetPose { frame, pose, what: "Turn track round".to_owned() };
            requests.edits.push((edit, self.gesture));
        }
    }

    fn begin_tracking(
        &mut self,
        order: TrackOrder,
        backwards: bool,
        between: Option<(usize, usize)>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let Some(reader) = reader(context) else { return };
        let asked: Vec<usize> = order.legs.iter().flat_map(|leg| leg.frames.iter().copied()).collect();
        let [first, last] = [asked.iter().min(), asked.iter().max()].map(|frame| frame.copied().unwrap_or(0));
        let (range, began) = (FrameRange::between(first, last), Instant::now());
        let total = asked.len();
        let progress = TrackingProgress { done: 0, total, backwards, between, range, began, surveyed: None };
        let document = context.document();
        // What was learnt is not looked for again, and a short track is not worth it.
        let is_surveyed = document.changes.is_empty() && !order.turns_round && asked.len() > FEW;
        let cameras = document.used_cameras().filter(|_| is_surveyed).collect();
        let job = TrackJob::new(reader, &document.tracking, order).surveying(cameras);
        self.begin(TrackingWork::Track(progress), context, job);
        self.gesture = Some(next_gesture(context.egui));
        (self.follows, self.newest, self.shown) = (true, None, None);
        requests.request(SessionRequest::Playback(PlaybackChange::Pause));
        requests.request(SessionRequest::LeaveStep);
    }

    /// Begins work; what was under way is superseded.
    pub(super) fn begin(
        &mut self,
        work: TrackingWork,
        context: &Context<'_>,
        job: impl Job<Applied> + 'static,
    ) {
        self.task.begin(context.pool, (), |()| job);
        self.work = Some(work);
    }

    /// Looks for other poses that fit the frame on the screen.
    pub(crate) fn search_poses(&mut self, context: &Context<'_>) {
        let Some(fit) = context.fit_inputs() else { return };
        let start = context.shown_pose().clone();
        let job = one_step(move |out: &Outbox<_>| search_from(&fit, &start, out));
        self.begin(TrackingWork::Search(context.selection.frame), context, job);
    }

    /// Fits lengths and radii to the frames that have poses of their own, or makes a body of spheres from them.
    pub(crate) fn make_body(&mut self, command: FitCommand, context: &Context<'_>, requests: &mut Requests) {
        let Some(reader) = reader(context) else { return };
        let (most, make, what): (_, fn(&_, _, &_), _) = match command {
            FitCommand::MakeSpheres => (body::SPHERE_FRAMES, body::spheres, "Making a body of spheres"),
            _ => (body::SIZE_FRAMES, body::sizes, "Fitting the body to several frames"),
        };
        let job = BodyJob { reader, waiting: body::frames(context, most), read: Vec::new(), make };
        self.begin(TrackingWork::Make(what.to_owned(), None), context, job);
        requests.request(SessionRequest::LeaveStep);
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
    fn find_person(
        &mut self,
        start: Option<Pose>,
        sizes: bool,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        let Some(reader) = reader(context) else { return };
        let frames = (context.selection.frame..context.session.frame_count()).collect();
        let what = if start.is_some() { "Finding the person’s sizes" } else { "Looking for the person" };
        let (model, fit) = (reader.fit.model.clone(), (*reader.fit.fit).clone());
        let search = PersonSearch { model, fit, start, frames, sizes };
        let job = one_step(move |out: &Outbox<_>| body::find_person(search, &reader, out));
        self.begin(TrackingWork::Make(what.to_owned(), None), context, job);
        requests.request(SessionRequest::LeaveStep);
    }

    /// Takes in what was found since the last frame of the window; all of a track is one undoable act.
    pub(super) fn take_in(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if std::mem::take(&mut self.tracks_next) {
            self.track(false, context, requests);
            return;
        }
        let mut has_ended = false;
        for event in self.task.poll() {
            match event {
                TaskEvent::Output(apply) => apply(self, context, requests),
                TaskEvent::Ended => has_ended = true,
                TaskEvent::Failed(failure) => {
                    requests.failed("The tracker", &failure);
                    has_ended = true;
                }
            }
        }
        if !self.tracked.is_empty() {
            let track = std::mem::take(&mut self.tracked);
            requests.edits.push((Edit::AddTrack(track), self.gesture));
        }
        self.follow(context, requests);
        if has_ended && let Some(TrackingWork::Track(progress)) = self.work.take() {
            let undo = (progress.done > 0).then_some(Command::History(HistoryCommand::Undo));
            requests.inform(ending(&progress), undo);
        }
    }

    pub(super) fn frame_tracked(&mut self, frame: usize, kept: Vec<Tracked>) {
        self.tracked.extend(kept);
        self.newest = Some(frame);
        if let Some(TrackingWork::Track(progress)) = &mut self.work {
            progress.done += 1;
        }
    }

    /// Backgrounds that change are looked for; at the end of that the tracker begins.
    pub(super) fn surveyed(&mut self, frames: Option<[usize; 2]>, at: Instant) {
        if let Some(TrackingWork::Track(progress)) = &mut self.work {
            (progress.surveyed, progress.began) = (frames, at);
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
            requests.request(SessionRequest::Follow(newest));
        } else {
            context.egui.request_repaint_after(FOLLOW_EVERY.saturating_sub(since));
        }
    }

    /// Other poses were found for a frame: by a search, or on the way of the tracker.
    pub(super) fn poses_found(
        &mut self,
        frame: usize,
        found: Vec<OtherPose>,
        context: &Context<'_>,
        requests: &mut Requests,
    ) {
        if matches!(self.work, Some(TrackingWork::Search(searched)) if searched == frame) {
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

/// Looks for other poses that fit the frame of these inputs.
fn search_from(fit: &FitInputs, start: &Pose, out: &Outbox<Applied>) {
    let Some(frame) = fit.frame.as_ref().map(|frame| frame.frame) else { return };
    let (effort, views) = (SearchOptions::default(), fit.views());
    match search::search(&fit.model, views, start, &fit.fit, &effort, out.cancel()) {
        // Half a search has looked at half of the body.
        Ok(_) if out.cancel().is_cancelled() => {}
        Ok(found) => {
            let poses = measured(fit, &found.hypotheses);
            out.send(applied(move |tracking, context, requests| {
                tracking.poses_found(frame, poses, context, requests);
            }));
        }
        Err(error) => out.send(refused(format!("Other poses cannot be looked for: {error}."))),
    }
}

/// Reads frames as the document has it; `None` without a take.
fn reader(context: &Context<'_>) -> Option<WindowReader> {
    let (footage, fit) = context.session.take.clone().zip(context.fit_inputs())?;
    let document = context.document();
    Some(WindowReader {
        footage,
        measurement: document.measurement.clone(),
        fit,
        cues: document.tracking.cues,
    })
}

/// The last key pose up to a frame and the first one after it. At the last key pose of the take, the one before it and
/// itself.
pub(super) fn keys_around(document: &Document, frame: usize) -> Option<(usize, usize)> {
    let keys = &document.keys;
    let before = |frame: usize| keys.range(..frame).next_back().map(|(key, _)| *key);
    let after = keys.range(frame + 1..).next().map(|(key, _)| *key);
    match after {
        Some(after) => keys.range(..=frame).next_back().map(|(key, _)| (*key, after)),
        None => keys.contains_key(&frame).then(|| before(frame).map(|first| (first, frame)))?,
    }
}

/// The key poses, but for those of frames where a leg begins, from the pose on the screen.
fn other_keys(context: &Context<'_>, begins: &[usize]) -> BTreeMap<usize, Pose> {
    let mut keys = (*context.document().keys).clone();
    keys.retain(|key, _| !begins.contains(key));
    keys
}

/// A track of these frames. A first frame that was fitted from this pose needs no second fit.
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
pub(super) fn joined(frame: usize, distance_m: f64, meets: bool, requests: &mut Requests) {
    let centimetres = format::number(100.0 * distance_m, 1);
    if meets {
        requests.status(format!("Joined after frame {frame}, where both tracks agree to {centimetres} cm."));
    } else {
        requests.complain(format!(
            "The two tracks do not meet: where they change over, after frame {frame}, a joint is {centimetres} cm apart. \
             Set another key pose near there and track again."
        ));
    }
}
