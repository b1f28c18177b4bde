//! The fit of frame after frame, one frame a step: one way through the take, or from two key poses towards each
//! other.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use backlit_document::tracking_choices::{AtKeys, CueChoice, Following, TrackingChoices};
use backlit_document::{Estimate, Origin};
use backlit_jobs::{Job, Outbox, Step};
use backlit_take::footage::Footage;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{CueOptions, FrameCues};
use backlit_tracking::fit::FitError;
use backlit_tracking::observability::believed_joints;
use backlit_tracking::posing;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::join::{self, Source};
use backlit_tracking::track::{FrameEstimate, Smoother, SmoothingError, Track, Tracker};

use super::Found;
use super::poses_job::measured;
use super::read_ahead::ReadAhead;
use super::survey::{no_keypoints, nobody_to_track};
use crate::session::prediction::FitInputs;
use crate::session::{BelievedJoints, FrameData, HeldLimbs, load_frame};

/// A way through the take.
#[derive(Debug, Clone)]
pub(super) struct Leg {
    /// The pose before its first frame is fitted.
    pub(super) start: Pose,
    /// The neighbour of the first frame whose fitted pose the start is, if it is one.
    pub(super) continues: Option<usize>,
    /// The frames in their order.
    pub(super) frames: VecDeque<usize>,
}

/// What a run of the tracker depends on.
#[derive(Debug)]
pub(super) struct TrackInputs {
    pub(super) footage: Arc<Footage>,
    pub(super) measurement: Arc<Vec<SegmentOptions>>,
    pub(super) fit: FitInputs,
    pub(super) choices: TrackingChoices,
    /// Key poses on the way: kept, or where the fit of their frames begins, by [`TrackingChoices::at_keys`].
    pub(super) keys: BTreeMap<usize, Pose>,
    /// Whether the body is turned to face the other way in them first.
    pub(super) turns_round: bool,
    /// Tracked one after the other. Two legs are tracks of the same frames from both sides, which are joined.
    pub(super) legs: VecDeque<Leg>,
}

/// A run of the tracker.
#[derive(Debug)]
pub(super) struct TrackJob {
    inputs: TrackInputs,
    /// Whether the silhouettes were looked at.
    is_surveyed: bool,
    tracker: Option<Tracker>,
    reader: Option<ReadAhead>,
    /// Of the leg that is being tracked, if it is to be joined with the other.
    kept: Track,
    /// Smooths the leg's frames by later ones, where that is asked for.
    smoother: Option<Smoother>,
    /// Legs that are whole, if they are to be joined.
    whole: Vec<Track>,
    joins: bool,
}

impl TrackJob {
    pub(super) fn new(inputs: TrackInputs) -> Self {
        Self {
            joins: inputs.legs.len() > 1,
            inputs,
            is_surveyed: false,
            tracker: None,
            reader: None,
            kept: Track::default(),
            smoother: None,
            whole: Vec::new(),
        }
    }

    fn new_tracker(&self, start: Pose) -> anyhow::Result<Tracker> {
        let tracker = Tracker::new(self.inputs.fit.model.clone(), (*self.inputs.fit.fit).clone(), start)?;
        let motion = self.inputs.choices.motion.motion();
        let tracker = tracker
            .with_motion(motion, self.inputs.footage.frame_rate)?
            .with_search(self.inputs.choices.search);
        Ok(match self.inputs.choices.cues.cues() {
            [] => tracker,
            cues => tracker.with_cues(CueOptions::default().only(cues))?,
        })
    }

    /// The frame's pictures.
    fn data(&mut self, frame: usize, cancel: &CancelToken) -> Arc<FrameData> {
        let (footage, measurement) = (&self.inputs.footage, &self.inputs.measurement);
        let to_come = || self.inputs.legs.iter().flat_map(|leg| leg.frames.iter().copied());
        let reader = self.reader.get_or_insert_with(|| {
            let order = std::iter::once(frame).chain(to_come()).collect();
            ReadAhead::new(footage.clone(), measurement.clone(), order, cancel.clone())
        });
        reader.get(frame)
    }

    fn track(&mut self, frame: usize, out: &Outbox<Found>) -> anyhow::Result<FrameEstimate> {
        let data = self.data(frame, out.cancel());
        self.inputs.fit.frame = Some(data.clone());
        out.send(Found::Loaded(data.clone()));
        if let Some(key) = self.kept_key(frame).cloned() {
            self.tracker = Some(self.new_tracker(key.clone())?.continuing_from(frame));
            let mut kept = FrameEstimate::of_pose(frame, key);
            kept.measure_overlap(
                &self.inputs.fit.model,
                self.inputs.fit.fit.renderer,
                &self.inputs.fit.views(),
            );
            return Ok(kept);
        }
        if let Some(key) = self.inputs.keys.get(&frame) {
            let turned = || posing::turn_round(&self.inputs.fit.model, key);
            let start = if self.inputs.turns_round { turned() } else { key.clone() };
            self.tracker = Some(self.new_tracker(start)?);
        }
        if self.tracker.is_none()
            && let Some(leg) = self.inputs.legs.front()
        {
            let tracker = self.new_tracker(leg.start.clone())?;
            let continues = leg.continues;
            self.tracker = Some(match continues {
                Some(neighbour) => tracker.continuing_from(neighbour),
                None => tracker,
            });
        }
        let (views, cues) = (self.inputs.fit.views(), self.cues(&data)?);
        match &mut self.tracker {
            Some(tracker) => Ok(tracker.track_frame_with_cues(frame, views, cues, out.cancel())?),
            None => Err(FitError::NoData { reasons: "there is no pose to begin with".to_owned() }.into()),
        }
    }

    /// What the frame has beside the silhouettes of the cameras that count, in the order of their views.
    fn cues(&self, data: &FrameData) -> anyhow::Result<FrameCues> {
        let (choice, footage) = (self.inputs.choices.cues, &self.inputs.footage);
        if choice == CueChoice::None {
            return Ok(FrameCues::default());
        }
        let picture =
            |camera: usize| data.cameras[camera].image.as_deref().filter(|_| choice.wants_pictures());
        let of = |camera: usize| footage.cues(camera, data.frame, picture(camera));
        let cameras =
            self.inputs.fit.numbered_views().map(|(camera, _)| of(camera)).collect::<Result<_, _>>()?;
        Ok(FrameCues { cameras })
    }

    /// The key pose of a frame, if it stays as it was set.
    fn kept_key(&self, frame: usize) -> Option<&Pose> {
        let keeps = self.inputs.choices.at_keys == AtKeys::Keep && !self.inputs.turns_round;
        self.inputs.keys.get(&frame).filter(|_| keeps)
    }

    /// Keeps what is needed later, and sends what is known of earlier frames by now.
    fn keep(&mut self, found: FrameEstimate, out: &Outbox<Found>) {
        if self.joins {
            let plain = FrameEstimate { belief: None, ..found.clone() };
            self.kept.frames.insert(plain.frame, plain);
        }
        if let Following::Smoothed { lag } = self.inputs.choices.motion {
            let smoother = self.smoother.get_or_insert_with(|| Smoother::new(lag));
            let known = smoother.push(found);
            self.revise(known, out);
        }
    }

    /// Frames are known better now.
    fn revise(&mut self, known: Result<Vec<FrameEstimate>, SmoothingError>, out: &Outbox<Found>) {
        let known = match known {
            Ok(known) => known,
            Err(error) => return out.send(Found::Refused(format!("Poses cannot be smoothed: {error}."))),
        };
        self.tell_beside(&known, out);
        if !known.is_empty() {
            out.send(Found::Revised(known.iter().map(revised).collect()));
        }
        if self.joins {
            self.kept.frames.extend(known.into_iter().map(|found| (found.frame, found)));
        }
    }

    /// Says what is known beside poses: what the filter believes of the joints, and what held the limbs.
    fn tell_beside(&self, found: &[FrameEstimate], out: &Outbox<Found>) {
        let model = &self.inputs.fit.model;
        let held: Vec<_> = found.iter().filter_map(held).collect();
        if !held.is_empty() {
            out.send(Found::Held(held));
        }
        let beliefs: Vec<_> = found.iter().filter_map(|found| believed(model, found)).collect();
        if !beliefs.is_empty() {
            out.send(Found::Believed(beliefs));
        }
    }

    /// A leg is over, or the user has stopped it.
    fn end_leg(&mut self, out: &Outbox<Found>) {
        if let Some(mut smoother) = self.smoother.take() {
            self.revise(smoother.finish(), out);
        }
        self.tracker = None;
        self.whole.push(std::mem::take(&mut self.kept));
    }

    /// Joins the two legs. What lies between them is fitted again.
    fn join(&self, out: &Outbox<Found>) {
        let [forward, backward] = &self.whole[..] else { return };
        let Some(join) = join::join(&self.inputs.fit.model, forward, backward) else { return };
        let mut fit = self.inputs.fit.clone();
        let mut found = Vec::with_capacity(join.sources.len());
        for (frame, source) in &join.sources {
            if out.cancel().is_cancelled() {
                return;
            }
            let (from, to) = (forward.frames.get(frame), backward.frames.get(frame));
            let cost = |found: &FrameEstimate| found.cost.unwrap_or(f64::INFINITY);
            let best = || from.into_iter().chain(to).min_by(|a, b| cost(a).total_cmp(&cost(b)));
            found.extend(match source {
                Source::Forward => from.map(revised),
                Source::Backward => to.map(revised),
                Source::Blended(pose) => {
                    fit.frame =
                        Some(Arc::new(load_frame(&self.inputs.footage, &self.inputs.measurement, *frame)));
                    let again = self.new_tracker(pose.clone()).and_then(|tracker| {
                        let mut tracker = tracker.continuing_from(frame.saturating_sub(1));
                        Ok(tracker.track_frame(*frame, fit.views(), out.cancel())?)
                    });
                    match again {
                        Ok(mut again) if !again.is_lost() => {
                            again.rms = fit.measure(&again.pose).rms;
                            Some(revised(&again))
                        }
                        _ => best().map(revised),
                    }
                }
            });
        }
        out.send(Found::Revised(found));
        let meets = join.meets();
        out.send(Found::Joined { frame: join.frame, distance_m: join.distance_m, meets });
    }

    fn next_frame(&mut self) -> Option<usize> {
        self.inputs.legs.front_mut()?.frames.pop_front()
    }
}

impl Job<Found> for TrackJob {
    fn step(&mut self, out: &Outbox<Found>) -> Step {
        if out.cancel().is_cancelled() {
            self.end_leg(out);
            return Step::Done;
        }
        if !std::mem::replace(&mut self.is_surveyed, true)
            && let Some(why) =
                no_keypoints(&self.inputs).or_else(|| nobody_to_track(&self.inputs, out.cancel()))
        {
            out.send(Found::Refused(why));
            return Step::Done;
        }
        let Some(frame) = self.next_frame() else {
            self.end_leg(out);
            self.inputs.legs.pop_front();
            if !self.inputs.legs.is_empty() {
                return Step::Again;
            }
            if self.joins {
                self.join(out);
            }
            return Step::Done;
        };
        match self.track(frame, out) {
            // What a cancelled fit leaves is half a fit.
            Ok(_) if out.cancel().is_cancelled() => {}
            Ok(mut found) => {
                // As fits and views measure it, whatever scale the tracker's ramps have.
                if found.cost.is_some() {
                    found.rms = self.inputs.fit.measure(&found.pose).rms;
                }
                self.tell_beside(std::slice::from_ref(&found), out);
                out.send(Found::Tracked(frame, estimate(&found)));
                if !found.hypotheses.is_empty() {
                    out.send(Found::Poses(frame, measured(&self.inputs.fit, &found.hypotheses)));
                }
                // What was set by hand is not smoothed.
                if self.kept_key(frame).is_none() {
                    self.keep(found, out);
                }
            }
            Err(error) => {
                out.send(Found::Refused(format!("The tracker stopped at frame {frame}: {error}.")));
                self.end_leg(out);
                return Step::Done;
            }
        }
        Step::Again
    }
}

/// What the filter believed of the joints.
fn believed(model: &Model, found: &FrameEstimate) -> Option<(usize, BelievedJoints)> {
    let covariance = found.belief.as_ref()?.belief.pose_covariance();
    let joints = Arc::new(believed_joints(model, &found.pose, &covariance));
    Some((found.frame, BelievedJoints { pose: found.pose.clone(), joints }))
}

/// What held the limbs, if the frame was tracked with cues.
fn held(found: &FrameEstimate) -> Option<(usize, HeldLimbs)> {
    let holds = (!found.holds.is_empty()).then(|| found.holds.clone().into())?;
    Some((found.frame, HeldLimbs { pose: found.pose.clone(), holds }))
}

fn revised(found: &FrameEstimate) -> (usize, Arc<Estimate>) {
    (found.frame, estimate(found))
}

/// What the document keeps of it.
fn estimate(found: &FrameEstimate) -> Arc<Estimate> {
    Arc::new(Estimate {
        iou: found.iou(),
        pose: found.pose.clone(),
        origin: Origin::Track,
        cost: found.cost,
        rms: found.rms,
        steps: found.iterations,
        lost: found.is_lost(),
        is_stale: false,
    })
}
