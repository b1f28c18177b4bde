//! Everything derived from document and footage: pictures, silhouettes, predictions. It can be made again at any time and
//! is never saved.

mod frames;
pub(crate) mod playback;
pub(crate) mod prediction;
pub mod selection;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_tracking::belief::LimbTrust;
use backlit_tracking::body::Pose;
use backlit_tracking::cues::LimbHold;
use backlit_tracking::observability::JointUncertainty;
use backlit_tracking::track::Mode;

pub(crate) use backlit_formats::footage::FrameData;
pub(crate) use frames::SegmentedFrames;

use crate::session::prediction::Predicted;

/// Bounds in a camera's pictures: left, top, right, bottom, in pixels.
pub(crate) type Extent = [f32; 4];

pub(crate) fn union(a: Extent, b: Extent) -> Extent {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

/// The derived data.
#[derive(Debug, Clone, Default)]
pub struct Session {
    /// The take that is open.
    pub take: Option<Arc<Footage>>,
    /// Where it came from; `None` for one that was made in memory.
    pub source: Option<TakeSource>,
    /// Decoded frames and their silhouettes.
    pub frames: SegmentedFrames,
    /// The silhouettes that the pose on the screen predicts. While a newer one is made, the old stays.
    pub predicted: Option<Arc<Predicted>>,
    /// Whether [`predicted`](Self::predicted) is of an older pose than the one on the screen.
    pub is_stale: bool,
    /// The frame that was shown last: it stays until the next one is there.
    pub(crate) last_frame: Option<Arc<FrameData>>,
    /// Changes with the pictures on the screen.
    pub(crate) generation: u64,
    /// Where the subject is over the whole take, by camera.
    pub(crate) subject: Vec<Option<Extent>>,
    /// What a Kalman filter believed of frames' joints, by frame.
    pub(crate) beliefs: BTreeMap<usize, BelievedJoints>,
    /// What the tracker told beside poses, by frame.
    pub(crate) told: BTreeMap<usize, ToldOfPose>,
    /// Time of the last prediction, in seconds.
    pub(crate) predict_seconds: Option<f64>,
}

/// What a Kalman filter believed of a pose's joints.
#[derive(Debug, Clone)]
pub(crate) struct BelievedJoints {
    /// The pose that it is of.
    pub(crate) pose: Pose,
    pub(crate) joints: Arc<Vec<JointUncertainty>>,
}

/// Two poses whose rotations differ by less are the same, radians and metres.
const SAME: f64 = 1e-6;

/// Whether two poses are the same but for rounding: a pose that is set is normalised.
pub(crate) fn are_same(a: &Pose, b: &Pose) -> bool {
    a.root.distance(b.root) < SAME && a.local(b).iter().all(|value| value.abs() < SAME)
}

/// What the tracker told beside a pose: what held its limbs, and which of them are not believed.
#[derive(Debug, Clone)]
pub(crate) struct ToldOfPose {
    /// The pose that it is of.
    pub(crate) pose: Pose,
    /// Empty where it was not tracked with cues.
    pub(crate) holds: Arc<[LimbHold]>,
    /// The limbs that are doubtful or wrong and have a rotation of their own.
    pub(crate) doubts: Arc<[LimbTrust]>,
    /// Poses that were carried beside it, likeliest first; those that are hardly likely are left out.
    pub(crate) rivals: Arc<[Mode]>,
}

impl ToldOfPose {
    /// How many limbs are wrong in the mean of such frames: the sum of P(wrong) of those that are not believed.
    pub(crate) fn expected_wrong(&self) -> f64 {
        self.doubts.iter().map(|doubt| doubt.wrong).sum()
    }

    /// The tracked pose and its rivals with their weights; empty where there are none.
    pub(crate) fn modes(&self) -> impl Iterator<Item = (&Pose, f64)> {
        let rivals: f64 = self.rivals.iter().map(|rival| rival.weight).sum();
        let tracked = (!self.rivals.is_empty()).then_some((&self.pose, 1.0 - rivals));
        tracked.into_iter().chain(self.rivals.iter().map(|rival| (&rival.pose, rival.weight)))
    }
}

impl Session {
    /// The poses that a frame allowed as it was tracked, if this one is one of them.
    pub(crate) fn modes(&self, frame: usize, pose: &Pose) -> Vec<(&Pose, f64)> {
        let modes: Vec<_> = self.told.get(&frame).into_iter().flat_map(ToldOfPose::modes).collect();
        if modes.iter().any(|(mode, _)| are_same(mode, pose)) { modes } else { Vec::new() }
    }

    /// What the tracker told beside this pose of a frame.
    pub(crate) fn told_of(&self, frame: usize, pose: &Pose) -> Option<&ToldOfPose> {
        self.told.get(&frame).filter(|told| told.pose == *pose)
    }

    /// The same, if a limb of it is not believed.
    pub(crate) fn doubted(&self, frame: usize, pose: &Pose) -> Option<&ToldOfPose> {
        self.told.get(&frame).filter(|told| !told.doubts.is_empty() && told.pose == *pose)
    }

    /// What held the limbs of this pose in a frame, part by part; empty where it was not tracked with cues.
    pub(crate) fn held(&self, frame: usize, pose: &Pose) -> &[LimbHold] {
        self.told_of(frame, pose).map_or(&[], |told| &told.holds)
    }

    /// The limbs of this pose that are not believed in a frame.
    pub(crate) fn doubts(&self, frame: usize, pose: &Pose) -> &[LimbTrust] {
        self.doubted(frame, pose).map_or(&[], |told| &told.doubts)
    }

    /// What a Kalman filter believed of this pose's joints in a frame, if the pose is a filter's.
    pub(crate) fn believed(&self, frame: usize, pose: &Pose) -> Option<&BelievedJoints> {
        self.beliefs.get(&frame).filter(|believed| believed.pose == *pose)
    }

    /// Which demonstration is open, if one is.
    pub(crate) fn demonstration(&self) -> Option<Demonstration> {
        self.source.as_ref()?.demonstration()
    }

    /// The file of the take that is open, if it is one.
    pub(crate) fn take_path(&self) -> Option<&PathBuf> {
        if let Some(TakeSource::Path(path)) = &self.source { Some(path) } else { None }
    }

    /// Number of frames of the take, zero without one.
    pub fn frame_count(&self) -> usize {
        self.take.as_ref().map_or(0, |take| take.frame_count())
    }

    /// Width of the pictures over their height: of most cameras alike.
    pub(crate) fn aspect(&self) -> f32 {
        let first = self.take.as_ref().and_then(|take| take.cameras.first());
        first.map_or(4.0 / 3.0, |camera| camera.width() as f32 / camera.height() as f32)
    }

    /// Number of cameras, zero without a take.
    pub(crate) fn camera_count(&self) -> usize {
        self.take.as_ref().map_or(0, |take| take.cameras.len())
    }

    /// Pixels of a camera's pictures, across and down.
    pub(crate) fn camera_size(&self, camera: usize) -> Option<[usize; 2]> {
        let camera = self.take.as_ref()?.cameras.get(camera)?;
        Some([camera.width(), camera.height()])
    }

    /// A frame, or the one that was shown last as long as it is not there.
    pub fn shown_frame(&self, frame: usize) -> Option<&Arc<FrameData>> {
        self.frames.get(frame).or(self.last_frame.as_ref())
    }

    /// Whether a prediction's data are those of the frame on the screen.
    pub(crate) fn is_of_shown_frame(&self, predicted: &Predicted, frame: usize) -> bool {
        let shown = self.shown_frame(frame);
        predicted.scene.frame.as_ref().zip(shown).is_some_and(|(a, b)| Arc::ptr_eq(a, b))
    }

    /// Intersection over union of all cameras together, of the prediction on the screen.
    pub fn iou(&self) -> Option<f64> {
        self.predicted.as_ref()?.iou()
    }

    /// Forgets what was made of another take.
    pub(crate) fn reset(&mut self, take: Option<Arc<Footage>>, source: Option<TakeSource>) {
        let mut frames = std::mem::take(&mut self.frames);
        frames.clear();
        *self = Self { take, source, frames, ..Self::default() };
    }

    /// Takes in a frame that was read.
    pub(crate) fn keep_frame(&mut self, frame: Arc<FrameData>) {
        self.frames.insert(frame);
        self.generation += 1;
    }
}
