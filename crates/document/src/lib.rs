//! All that is saved and undone: which take, the body, the poses, and how they are fitted.
//!
//! A document knows nothing of the window and of derived data. Its large parts are shared, so a snapshot for
//! undo costs a few pointers.

pub mod bookmark;
pub mod edit;
pub mod fit_words;
pub mod frame_trust;
pub mod history;
pub mod likely_poses;
pub mod observability_words;
pub mod project;
pub mod run;
pub mod run_names;
pub mod runs;
mod silhouettes;
pub mod take_match;
pub mod tracking_choices;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::footage::BrushStroke;
use backlit_formats::footage::replacement::{Calibration, MaskFiles, PlateFiles};
use backlit_formats::motion::Motion;
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::people::FollowedPerson;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::segment::changes::BackgroundChange;
use serde::{Deserialize, Serialize};

use crate::bookmark::Bookmark;
use crate::frame_trust::FrameTrust;
use crate::tracking_choices::TrackingChoices;

/// What one camera does in the fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraUse {
    /// The camera's name in the take.
    pub name: String,
    /// Whether its silhouette counts.
    pub used: bool,
    /// Weight of its pixels; 1 as a rule.
    pub weight: f64,
}

/// How a frame's pose was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// By steps of a fit on this frame alone.
    Fit,
    /// By the tracker, from a neighbouring frame.
    Track,
}

/// The pose that a fit or the tracker found for a frame; in a project's file the pose is written by limb.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate<P = Pose> {
    /// The pose.
    pub pose: P,
    /// What found it.
    pub origin: Origin,
    /// Cost in squared grey levels; `None` where nobody was in the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
    /// Root mean square residual per pixel, grey levels; `None` likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms: Option<f64>,
    /// Intersection over union of body and silhouettes, all cameras together, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub iou: Option<f64>,
    /// Accepted and rejected steps.
    pub steps: usize,
    /// Whether the tracker says that it lost the subject.
    pub lost: bool,
    /// Whether the body has had another size since: its numbers are those of the old one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_stale: bool,
}

impl<P> Estimate<P> {
    /// The same with the pose in another form.
    pub(crate) fn with_pose<Q>(&self, pose: Q) -> Estimate<Q> {
        let &Self { origin, cost, rms, iou, steps, lost, is_stale, .. } = self;
        Estimate { pose, origin, cost, rms, iou, steps, lost, is_stale }
    }
}

/// The document.
///
/// Guaranteed by `Document::apply`: poses fit the model, numbers are finite, weights are not negative.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// Where the footage is; `None` before a take is opened.
    pub take: Option<TakeSource>,
    /// The body, with its sizes as edited.
    pub model: Arc<Model>,
    /// The pose before anything is known.
    pub start: Arc<Pose>,
    /// Poses set by hand, by frame.
    pub keys: Arc<BTreeMap<usize, Pose>>,
    /// Poses found, by frame. An estimate is younger than the key pose of the same frame.
    pub estimates: Arc<BTreeMap<usize, Arc<Estimate>>>,
    /// What the tracker says of poses that it found, by frame.
    pub trust: Arc<BTreeMap<usize, Arc<FrameTrust>>>,
    /// The cameras, in the order of the take.
    pub cameras: Arc<Vec<CameraUse>>,
    /// How poses are fitted.
    pub fit: Arc<FitOptions>,
    /// How frames are followed.
    pub tracking: TrackingChoices,
    /// How silhouettes are made, camera by camera.
    pub measurement: Arc<Vec<SegmentOptions>>,
    /// Limbs whose second joint stays where it is when another is dragged.
    pub pins: Arc<BTreeSet<usize>>,
    /// Cameras in the place of the take's.
    pub calibration: Option<Arc<Calibration>>,
    /// Plates in the place of the take's.
    pub plates: Arc<PlateFiles>,
    /// Silhouettes in the place of those that are measured.
    pub masks: Arc<MaskFiles>,
    /// What is painted over silhouettes by hand, the oldest first.
    pub brush: Arc<Vec<BrushStroke>>,
    /// Who is followed of several people.
    pub person: Option<Arc<FollowedPerson>>,
    /// Backgrounds that change while the take is filmed.
    pub changes: Arc<Vec<BackgroundChange>>,
    /// Places that somebody marked, in the order of their frames.
    pub bookmarks: Arc<Vec<Bookmark>>,
    /// Files that poses are compared with, in the order in which they were added.
    pub references: Arc<Vec<PathBuf>>,
}

impl Document {
    /// A document about a body, without footage.
    pub fn new(model: Model) -> Self {
        let start = Pose::rest(&model);
        Self {
            take: None,
            model: Arc::new(model),
            start: Arc::new(start),
            keys: Arc::default(),
            estimates: Arc::default(),
            trust: Arc::default(),
            cameras: Arc::default(),
            fit: Arc::default(),
            tracking: TrackingChoices::of_preset(FitOptions::default().as_preset()),
            measurement: Arc::default(),
            pins: Arc::default(),
            calibration: None,
            plates: Arc::default(),
            masks: Arc::default(),
            brush: Arc::default(),
            person: None,
            changes: Arc::default(),
            bookmarks: Arc::default(),
            references: Arc::default(),
        }
    }

    /// The pose of a frame: found there, or set there by hand, or else that of the nearest frame before, or
    /// else the start.
    pub fn pose_at(&self, frame: usize) -> &Pose {
        let found = self.estimates.range(..=frame).next_back();
        let key = self.keys.range(..=frame).next_back();
        match (found, key) {
            (Some((at, estimate)), Some((key_at, _))) if at >= key_at => &estimate.pose,
            (_, Some((_, pose))) => pose,
            (Some((_, estimate)), None) => &estimate.pose,
            (None, None) => &self.start,
        }
    }

    /// The poses that are not another frame's, by frame: found, or set by hand.
    pub fn own_poses(&self) -> BTreeMap<usize, Pose> {
        let frames = self.estimates.keys().chain(self.keys.keys());
        frames.map(|&frame| (frame, self.pose_at(frame).clone())).collect()
    }

    /// The same for other programs, with how far poses that were tracked are believed.
    pub fn motion(&self, name: impl Into<String>, frame_rate: f64) -> Motion {
        let poses = self.own_poses();
        let judged = poses.iter().filter_map(|(&frame, pose)| Some((frame, self.trust_of(frame, pose)?)));
        let trust = judged.map(|(frame, trust)| (frame, trust.limbs.clone())).collect();
        Motion::of_poses(name, (*self.model).clone(), frame_rate, poses).with_trust(trust)
    }

    /// A take's footage with the calibration, plates, person and silhouettes that this document puts in the place of the take's.
    pub fn footage(&self, take: &Footage) -> Footage {
        let mut replaced =
            take.with_replacements(self.calibration.clone(), self.plates.clone(), self.person.clone());
        replaced.masks = self.masks.clone();
        replaced.brush = self.brush.clone();
        replaced.changes = self.changes.clone();
        replaced
    }

    /// Whether a frame has a pose of its own.
    pub fn has_pose(&self, frame: usize) -> bool {
        self.estimates.contains_key(&frame) || self.keys.contains_key(&frame)
    }

    /// The cameras whose silhouettes count, by index.
    pub fn used_cameras(&self) -> impl Iterator<Item = usize> + '_ {
        self.cameras.iter().enumerate().filter(|(_, camera)| camera.used).map(|(index, _)| index)
    }
}
