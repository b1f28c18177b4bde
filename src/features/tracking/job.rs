//! The tracker's run in the window: what it reads, and what becomes of what it tells.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use backlit_document::edit::{Edit, Tracked};
use backlit_document::frame_trust::FrameTrust;
use backlit_document::tracking_choices::{AtKeys, CueChoice, TrackPrior, TrackingChoices};
use backlit_document::{Estimate, Origin, likely_poses};
use backlit_formats::footage::changes::ChangeSurvey;
use backlit_formats::{Footage, FootageError};
use backlit_jobs::{Job, Outbox, Turn};
use backlit_runs::changes::change_text;
use backlit_runs::track::{
    FrameReader, KeyUse, Leg, RIVALS, TrackEnding, TrackMessage, TrackPlan, TrackRun, survey,
};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cues::FrameCues;
use backlit_tracking::fit::FitView;
use backlit_tracking::observability::believed_joints;
use backlit_tracking::search::Hypothesis;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::{FrameEstimate, Motion, WhenToSearch};

use super::{Applied, OtherPose, Tracking, applied, people, refused};
use crate::session::BelievedJoints;
use crate::session::prediction::FitInputs;

/// Frames whose silhouettes are looked at first: the tracker waits for them.
const LOOKED_AT: usize = 3;
/// Rival poses that are less likely are not kept.
const LEAST_LIKELY: f64 = 0.02;
/// Up to this many frames are not looked at first: each is seen at once as it is fitted.
pub(super) const FEW: usize = 8;

/// Reads frames as the document has it: its cameras, their weights, its measurement.
#[derive(Debug)]
pub(super) struct WindowReader {
    pub(super) footage: Arc<Footage>,
    pub(super) measurement: Arc<Vec<SegmentOptions>>,
    pub(super) fit: FitInputs,
    pub(super) cues: CueChoice,
}

impl FrameReader for WindowReader {
    type Data = FitInputs;

    fn read(&self, frame: usize) -> Result<FitInputs, FootageError> {
        let data = self.footage.load_frame(&self.measurement, frame);
        Ok(FitInputs { frame: Some(Arc::new(data)), ..self.fit.clone() })
    }

    fn views(&self, frame: &FitInputs) -> Vec<FitView> {
        frame.views()
    }

    fn cues(&self, inputs: &FitInputs) -> Result<FrameCues, FootageError> {
        let Some(data) = &inputs.frame else { return Ok(FrameCues::default()) };
        let picture =
            |camera: usize| data.cameras[camera].image.as_deref().filter(|_| self.cues.wants_pictures());
        let of = |camera: usize| self.footage.camera_cues(camera, data.frame, picture(camera));
        let cameras = inputs.numbered_views().map(|(camera, _)| of(camera)).collect::<Result<_, _>>()?;
        Ok(FrameCues { cameras })
    }

    /// As fits and views measure it, whatever scale the tracker's ramps have.
    fn rms(&self, inputs: &FitInputs, pose: &Pose, _tracked: Option<f64>) -> Option<f64> {
        inputs.measure(pose).rms
    }
}

pub(super) struct TrackOrder {
    /// Tracked one after the other.
    pub(super) legs: Vec<Leg>,
    /// Key poses on the way.
    pub(super) keys: BTreeMap<usize, Pose>,
    /// Whether the body is turned to face the other way in them first.
    pub(super) turns_round: bool,
}

/// A run of the tracker, one frame a step.
#[derive(Debug)]
pub(super) struct TrackJob {
    reader: Arc<WindowReader>,
    run: TrackRun<WindowReader>,
    /// All frames, until the silhouettes of some were looked at.
    unseen: Option<Vec<usize>>,
    /// The cameras among which backgrounds that change are looked for first.
    surveyed: Vec<usize>,
    /// What was read of the newest frame.
    taken: Option<Arc<FitInputs>>,
}

impl TrackJob {
    /// Learns backgrounds again first, where three or more of these cameras show that they change.
    pub(super) fn surveying(self, cameras: Vec<usize>) -> Self {
        Self { surveyed: cameras, ..self }
    }

    pub(super) fn new(reader: WindowReader, choices: &TrackingChoices, order: TrackOrder) -> Self {
        let frames = order.legs.iter().flat_map(|leg| leg.frames.iter().copied());
        let unseen = Some(frames.collect());
        let mut fit = reader.fit.fit.clone();
        if choices.prior == TrackPrior::People && fit.prior.is_none() {
            Arc::make_mut(&mut fit).prior = Some(likely_poses::people());
        }
        let plan = TrackPlan {
            model: reader.fit.model.clone(),
            fit,
            frame_rate: reader.footage.take().frame_rate(),
            motion: Motion::default(),
            search: choices.search,
            rivals: if choices.search == WhenToSearch::Never { 0 } else { RIVALS },
            cues: choices.cues.cues().to_vec(),
            smoothing: None,
            keys: order.keys,
            at_keys: match choices.at_keys {
                _ if order.turns_round => KeyUse::BeginTurned,
                AtKeys::Keep => KeyUse::Keep,
                AtKeys::Refine | AtKeys::Stop => KeyUse::Begin,
            },
            legs: order.legs.into(),
        };
        let reader = Arc::new(reader);
        let run = TrackRun::new(reader.clone(), plan.following(choices.motion));
        Self { run, reader, unseen, surveyed: Vec::new(), taken: None }
    }

    /// Why these frames cannot be tracked, in a sentence.
    fn refusal(&self, frames: &[usize], out: &Outbox<Applied>) -> Option<String> {
        if self.reader.cues == CueChoice::Keypoints {
            match self.reader.footage.take().keypoint_order() {
                Ok(Some(_)) => {}
                Ok(None) => {
                    let why = "Not tracked: the take has no keypoints of a body. Choose other cues in the Solver section, \
                               or name them as keypoints of the take’s cameras.";
                    return Some(why.to_owned());
                }
                Err(error) => return Some(format!("Not tracked: {error}.")),
            }
        }
        if frames.len() <= FEW {
            return None;
        }
        let found = survey(&*self.reader, frames, LOOKED_AT, out.cancel());
        if let Some(several) = found.several_people() {
            out.send(applied(move |_, _, requests| people::tell_of_several(&several, requests)));
        }
        found.check().err().map(|error| format!("Not tracked: {error}."))
    }
}

impl Job<Applied> for TrackJob {
    fn step(&mut self, out: &Outbox<Applied>) -> Turn {
        if let Some(frames) = self.unseen.take()
            && !out.cancel().is_cancelled()
            && let Some(why) = self.refusal(&frames, out)
        {
            out.send(refused(why));
            return Turn::Done;
        }
        if let Some(job) = changed_footage(&self.reader, &std::mem::take(&mut self.surveyed), out) {
            self.reader = Arc::new(job);
            self.run.read_by(self.reader.clone());
        }
        let (mut step, taken, model) = (Turn::Again, &mut self.taken, &self.reader.fit.model);
        self.run.step(out.cancel(), &mut |message| match message {
            TrackMessage::Taken(_, inputs) => {
                let data = inputs.frame.clone();
                *taken = Some(inputs);
                out.send(applied(move |_, _, requests| requests.frames.extend(data)));
            }
            TrackMessage::Frame { estimate, .. } => {
                let (frame, kept) = (estimate.frame, tracked(model, std::slice::from_ref(&*estimate)));
                tell_beliefs(model, std::slice::from_ref(&*estimate), out);
                out.send(applied(move |tracking, _, _| tracking.frame_tracked(frame, kept)));
                if let Some(inputs) = taken.as_ref().filter(|_| !estimate.hypotheses.is_empty()) {
                    let poses = measured(inputs, &estimate.hypotheses);
                    out.send(applied(move |tracking, context, requests| {
                        tracking.poses_found(frame, poses, context, requests);
                    }));
                }
            }
            TrackMessage::Revised(known) | TrackMessage::Rewound(known) => {
                tell_beliefs(model, &known, out);
                revise(model, &known, out);
            }
            TrackMessage::Joined { estimates, frame, distance_m, meets } => {
                revise(model, &estimates, out);
                out.send(applied(move |_, _, requests| super::joined(frame, distance_m, meets, requests)));
            }
            TrackMessage::NotSmoothed(error) => {
                out.send(refused(format!("Poses cannot be smoothed: {error}.")));
            }
            TrackMessage::Done(ending) => {
                if let TrackEnding::Failed { frame, error } = ending {
                    out.send(refused(format!("The tracker stopped at frame {frame}: {error}.")));
                }
                step = Turn::Done;
            }
        });
        step
    }
}

/// The same with backgrounds that change, which become the document's; `None` where none does. Pictures that cannot be read are told
/// of when it is their turn.
fn changed_footage(reader: &WindowReader, cameras: &[usize], out: &Outbox<Applied>) -> Option<WindowReader> {
    let (footage, frames) = (&*reader.footage, (0..reader.footage.frame_count()).collect::<Vec<usize>>());
    let survey = ChangeSurvey { measurement: &reader.measurement, ..footage.change_survey(cameras, &frames) };
    let tell = |frames| {
        let at = Instant::now();
        out.send(applied(move |tracking, _, _| tracking.surveyed(frames, at)));
    };
    let found = survey.changes(out.cancel(), |frames| tell(Some(frames)));
    tell(None);
    let found = found.ok()??;
    if found.is_empty() {
        return None;
    }
    let texts: Vec<String> = found.iter().map(|change| change_text(change, footage.take())).collect();
    let changes = Arc::new(found);
    let footage = Arc::new(footage.with_changes(changes.clone()));
    out.send(applied(move |tracking, _, requests| {
        requests.edits.push((Edit::SetChanges(changes), tracking.gesture));
        requests.inform(format!("{}.", texts.join("; ")), None);
    }));
    let WindowReader { measurement, fit, cues, .. } = reader;
    Some(WindowReader { footage, measurement: measurement.clone(), fit: fit.clone(), cues: *cues })
}

/// Poses that were found, in their order, each measured as the views measure the pose on the screen.
pub(super) fn measured(inputs: &FitInputs, found: &[Hypothesis]) -> Vec<OtherPose> {
    let measured = |found: &Hypothesis| OtherPose {
        rms: inputs.measure(&found.pose).rms,
        pose: found.pose.clone(),
        origin: found.origin.clone(),
    };
    found.iter().map(measured).collect()
}

/// Says what the filter believes of the joints.
fn tell_beliefs(model: &Model, estimates: &[FrameEstimate], out: &Outbox<Applied>) {
    let believed = |one: &FrameEstimate| {
        let covariance = one.belief.as_ref()?.belief.pose_covariance();
        let joints = Arc::new(believed_joints(model, &one.pose, &covariance));
        Some((one.frame, BelievedJoints { pose: one.pose.clone(), joints }))
    };
    let beliefs: Vec<_> = estimates.iter().filter_map(believed).collect();
    out.send(applied(move |_, _, requests| requests.beliefs.extend(beliefs)));
}

fn revise(model: &Model, known: &[FrameEstimate], out: &Outbox<Applied>) {
    let known = tracked(model, known);
    out.send(applied(move |tracking: &mut Tracking, _, _| tracking.tracked.extend(known)));
}

/// What the document keeps of these frames.
fn tracked(model: &Model, found: &[FrameEstimate]) -> Vec<Tracked> {
    let kept = |one: &FrameEstimate| {
        let estimate = Estimate {
            iou: one.iou(),
            pose: one.pose.clone(),
            origin: Origin::Track,
            cost: one.cost,
            rms: one.rms,
            steps: one.iterations,
            lost: one.is_lost(),
            is_stale: false,
        };
        let rivals = one.modes.iter().filter(|mode| mode.weight >= LEAST_LIKELY).cloned().collect();
        let trust = FrameTrust::new(model, one.pose.clone(), one.trust.clone(), one.holds.clone(), rivals);
        (one.frame, Arc::new(estimate), Some(Arc::new(trust)))
    };
    found.iter().map(kept).collect()
}
