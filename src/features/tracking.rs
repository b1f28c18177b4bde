//! Tracking, and looking for other poses.

pub(crate) mod choices;
pub(crate) mod job;
pub(crate) mod read_ahead;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use backlit_tracking::body::Pose;
use backlit_tracking::search::Hypothesis;

use crate::app::App;
use crate::context::action::Action;
use crate::document::edit::Edit;
use crate::document::{Document, Estimate};
use crate::features::fit::poses_job::PosesJob;
use crate::features::tracking::job::{Leg, TrackJob};
use crate::session::playback::FrameRange;
use crate::session::{OtherPoses, Tracking};
use crate::worker::Lane;

/// While the tracker is at work, the screen goes on to its newest frame this often: drawing every one would take
/// the tracker's time.
const FOLLOW_EVERY: Duration = Duration::from_millis(100);

/// What the tracker has found and the window has not taken in yet.
#[derive(Debug, Default)]
pub(crate) struct Tracked {
    /// Frames that were heard of since the last frame of the window.
    heard: Vec<(usize, Arc<Estimate>)>,
    /// The frame that the screen goes to next.
    newest: Option<usize>,
    /// When it went on last.
    shown: Option<Instant>,
}

/// The key poses around a frame: the last one up to it and the first one after it. At the last key pose of the
/// take, the one before it and itself.
pub(crate) fn keys_around(document: &Document, frame: usize) -> Option<(usize, usize)> {
    let keys = &document.keys;
    let before = |frame: usize| keys.range(..frame).next_back().map(|(key, _)| *key);
    let after = keys.range(frame + 1..).next().map(|(key, _)| *key);
    match after {
        Some(after) => keys.range(..=frame).next_back().map(|(key, _)| (*key, after)),
        None => keys.contains_key(&frame).then(|| before(frame).map(|first| (first, frame)))?,
    }
}

/// The tracker.
#[derive(Debug, Default)]
pub(crate) struct TrackingState {
    /// Whether the screen follows the tracker.
    pub(crate) follows_tracker: bool,
    pub(crate) tracked: Tracked,
}

impl App {
    /// Tracks from the frame on the screen to the end or the beginning.
    pub(crate) fn track(&mut self, backwards: bool) {
        self.interrupt_fit();
        let (here, count) = (self.state.selection.frame, self.state.session.frame_count());
        let frames: VecDeque<usize> =
            if backwards { (0..=here).rev().collect() } else { (here..count).collect() };
        let start = self.shown_pose().clone();
        let leg = self.leg(here, start, frames);
        self.begin_tracking(vec![leg], &[here], backwards, None);
    }

    /// Tracks from the key pose before forwards and from the one after backwards, and joins the two.
    pub(crate) fn track_between_keys(&mut self) {
        self.interrupt_fit();
        let Some((first, last)) = keys_around(self.document(), self.state.selection.frame) else { return };
        let document = self.document();
        let leg = |key: usize, frames: VecDeque<usize>| self.leg(key, document.pose_at(key).clone(), frames);
        let legs = vec![leg(first, (first..=last).collect()), leg(last, (first..=last).rev().collect())];
        self.begin_tracking(legs, &[first, last], false, Some((first, last)));
    }

    /// A way through these frames. A first frame that was fitted from this pose needs no second fit.
    fn leg(&self, from: usize, start: Pose, mut frames: VecDeque<usize>) -> Leg {
        let found = self.document().estimates.get(&from);
        let is_fitted = frames.len() > 1 && found.is_some_and(|found| !found.lost && found.pose == start);
        if is_fitted {
            frames.pop_front();
        }
        Leg { start, continues: is_fitted.then_some(from), frames }
    }

    fn begin_tracking(
        &mut self,
        legs: Vec<Leg>,
        begins: &[usize],
        backwards: bool,
        between: Option<(usize, usize)>,
    ) {
        let (Some(take), Some(scene)) = (self.state.session.take.clone(), self.scene()) else { return };
        let document = self.document();
        let mut keys = (*document.keys).clone();
        // There a leg begins, from the pose on the screen.
        keys.retain(|key, _| !begins.contains(key));
        let total = legs.iter().map(|leg| leg.frames.len()).sum();
        let asked = || legs.iter().flat_map(|leg| leg.frames.iter().copied());
        let range = FrameRange::between(asked().min().unwrap_or(0), asked().max().unwrap_or(0));
        let job =
            TrackJob::new(take, document.measurement.clone(), scene, document.tracking, Arc::new(keys), legs);
        self.pause();
        self.features.fit.run_gesture = Some(self.new_gesture());
        let began = Instant::now();
        self.state.session.tracking = Some(Tracking { done: 0, total, backwards, between, range, began });
        self.features.tracking.follows_tracker = true;
        self.features.tracking.tracked = Tracked::default();
        self.state.selection.step = None;
        self.worker.request(Lane::Track, job);
    }

    /// A frame was tracked: it is taken in with all others of this frame of the window.
    pub(crate) fn frame_tracked(&mut self, frame: usize, estimate: Arc<Estimate>) {
        self.features.tracking.tracked.heard.push((frame, estimate));
        self.features.tracking.tracked.newest = Some(frame);
        if let Some(tracking) = &mut self.state.session.tracking {
            tracking.done += 1;
        }
    }

    /// Frames that were tracked before are known better now.
    pub(crate) fn track_revised(&mut self, found: Vec<(usize, Arc<Estimate>)>) {
        self.features.tracking.tracked.heard.extend(found);
    }

    /// Takes in what was tracked since the last frame of the window, as part of one undoable act.
    pub(crate) fn take_in_tracked(&mut self) {
        if !self.features.tracking.tracked.heard.is_empty() {
            let found = std::mem::take(&mut self.features.tracking.tracked.heard);
            self.edit(Edit::AddTrack(found), self.features.fit.run_gesture);
        }
        self.follow_tracker();
    }

    /// Goes on to the newest frame, not more often than the screen can show it.
    fn follow_tracker(&mut self) {
        let Some(newest) = self.features.tracking.tracked.newest else { return };
        let is_at_work = self.worker.is_busy(Lane::Track);
        if !self.features.tracking.follows_tracker {
            self.features.tracking.tracked.newest = None;
            return;
        }
        let since = self.features.tracking.tracked.shown.map_or(FOLLOW_EVERY, |shown| shown.elapsed());
        let is_drawn = !self.state.session.is_stale;
        if !is_at_work || (since >= FOLLOW_EVERY && is_drawn) {
            self.features.tracking.tracked.newest = None;
            self.features.tracking.tracked.shown = Some(Instant::now());
            self.go_to_frame(newest);
        } else {
            self.state.egui.request_repaint_after(FOLLOW_EVERY.saturating_sub(since));
        }
    }

    /// The tracker has ended: what it did is said, with the way back.
    pub(crate) fn tracking_ended(&mut self) {
        self.state.session.fitting_body = false;
        self.state.session.searching = None;
        let Some(tracking) = self.state.session.tracking.take() else { return };
        self.take_in_tracked();
        let whole = tracking.done == tracking.total;
        let text = match tracking.between {
            Some((first, last)) if whole => {
                format!("Tracked between the key poses of frames {first} and {last}, from both sides.")
            }
            _ if whole && tracking.done == 1 => "Tracked one frame.".to_owned(),
            _ if whole => format!("Tracked {} frames.", tracking.done),
            Some((first, last)) => format!(
                "Stopped after {} of {} fits between the key poses of frames {first} and {last}; the two tracks \
                 are not joined.",
                tracking.done, tracking.total
            ),
            None => format!("Stopped after {} of {} frames.", tracking.done, tracking.total),
        };
        let undo = (tracking.done > 0).then_some(Action::Undo);
        self.state.notices.info(self.state.now, text, undo);
    }

    /// Says where two tracks were joined, and what to do where they do not meet.
    pub(crate) fn tracks_joined(&mut self, frame: usize, distance_m: f64, meets: bool) {
        let centimetres = crate::style::format::number(100.0 * distance_m, 1);
        if meets {
            self.state.status =
                Some(format!("Joined after frame {frame}, where both tracks agree to {centimetres} cm."));
        } else {
            let text = format!(
                "The two tracks do not meet: they are nearest in frame {frame}, {centimetres} cm apart. \
                 Set another key pose near there and track again."
            );
            self.state.notices.error(text);
        }
    }

    /// Looks for other poses that fit the frame on the screen.
    pub(crate) fn search_poses(&mut self) {
        self.interrupt_fit();
        let Some(scene) = self.scene() else { return };
        let start = self.shown_pose().clone();
        self.state.session.searching = Some(self.state.selection.frame);
        self.worker.request(Lane::Track, PosesJob { scene, start });
    }

    /// Other poses were found for a frame.
    pub(crate) fn poses_found(&mut self, frame: usize, found: Vec<Hypothesis>) {
        if self.state.session.searching == Some(frame) {
            let others = found.len().saturating_sub(1);
            let text = match others {
                0 => format!("Frame {frame}: no other pose was found that fits."),
                1 => format!("Frame {frame}: two poses fit; see Refit."),
                _ => format!("Frame {frame}: {} poses fit; see Refit.", others + 1),
            };
            self.state.notices.info(self.state.now, text, None);
        }
        let fit = self.document().fit.clone();
        self.state.session.other_poses.insert(frame, OtherPoses { found, fit });
    }

    /// Gives the frame on the screen one of the poses that were found for it.
    pub(crate) fn choose_pose(&mut self, index: usize) {
        self.interrupt_fit();
        let frame = self.state.selection.frame;
        let found = self.state.session.other_poses.get(&frame).and_then(|poses| poses.found.get(index));
        if let Some(pose) = found.map(|found| found.pose.clone()) {
            self.edit(Edit::SetPose { frame, pose, what: "Choose pose".to_owned() }, None);
        }
    }

    /// Goes to the nearest frame on a side whose overlap is among the worst tenth.
    pub(crate) fn go_to_worst(&mut self, later: bool) {
        let mut found: Vec<(f64, usize)> = self
            .document()
            .estimates
            .iter()
            .map(|(frame, found)| (if found.lost { -1.0 } else { found.iou.unwrap_or(1.0) }, *frame))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.truncate(found.len().div_ceil(10));
        let frames: Vec<usize> = found.into_iter().map(|(_, frame)| frame).collect();
        if let Some(frame) = neighbour(&frames, self.state.selection.frame, later) {
            self.features.tracking.follows_tracker = false;
            self.go_to_frame(frame);
        }
    }

    /// Goes to the next or the previous key pose; past the last one, to the first.
    pub(crate) fn go_to_key(&mut self, later: bool) {
        let keys: Vec<usize> = self.document().keys.keys().copied().collect();
        if let Some(frame) = neighbour(&keys, self.state.selection.frame, later) {
            self.features.tracking.follows_tracker = false;
            self.interrupt_fit();
            self.go_to_frame(frame);
        }
    }
}

/// The next of some frames on a side, or the one at the other end.
fn neighbour(frames: &[usize], here: usize, later: bool) -> Option<usize> {
    let all = || frames.iter().copied();
    if later {
        all().filter(|frame| *frame > here).min().or_else(|| all().min())
    } else {
        all().filter(|frame| *frame < here).max().or_else(|| all().max())
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn neighbours_go_round() {
        let frames = [30, 2, 11];
        assert_eq!(neighbour(&frames, 11, true), Some(30));
        assert_eq!(neighbour(&frames, 30, true), Some(2));
        assert_eq!(neighbour(&frames, 2, false), Some(30));
        assert_eq!(neighbour(&[], 2, false), None);
    }

    #[test]
    fn keys_lie_around_a_frame() {
        let mut document = Document::new(builtin::single_limb());
        assert_eq!(keys_around(&document, 3), None);
        for frame in [2, 8, 20] {
            document.apply(Edit::SetKey { frame }).unwrap();
        }
        let around = |frame| keys_around(&document, frame);
        assert_eq!(around(1), None, "none before");
        assert_eq!((around(2), around(7)), (Some((2, 8)), Some((2, 8))));
        assert_eq!((around(8), around(20)), (Some((8, 20)), Some((8, 20))));
        assert_eq!(around(21), None, "none after");
    }
}
