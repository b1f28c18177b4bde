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
use backlit_take::motion::is_motion;
use backlit_take::source::TakeSource;
use backlit_tracking::body::Pose;
use backlit_tracking::observability::JointUncertainty;
use backlit_ui::drawing::ViewedPicture;

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
    /// The frame on the screen: it stays until the next one is there with its prediction.
    pub(crate) last_frame: Option<Arc<FrameData>>,
    /// Since when a frame that was read waits for its prediction.
    pub(crate) waits_since: Option<f64>,
    /// What the views show, by camera: whoever predicts makes these pictures too.
    pub(crate) viewed: Arc<Vec<Vec<ViewedPicture>>>,
    /// Changes with the pictures on the screen.
    pub(crate) generation: u64,
    /// Where the subject is over the whole take, by camera.
    pub(crate) subject: Vec<Option<Extent>>,
    /// What a Kalman filter believed of frames' joints, by frame.
    pub(crate) beliefs: BTreeMap<usize, BelievedJoints>,
    /// Time of the last prediction, in seconds.
    pub predict_seconds: Option<f64>,
}

/// What a Kalman filter believed of a pose's joints.
#[derive(Debug, Clone)]
pub(crate) struct BelievedJoints {
    /// The pose that it is of.
    pub(crate) pose: Pose,
    pub(crate) joints: Arc<Vec<JointUncertainty>>,
}

impl Session {
    /// What a Kalman filter believed of this pose's joints in a frame, if the pose is a filter's.
    pub(crate) fn believed(&self, frame: usize, pose: &Pose) -> Option<&BelievedJoints> {
        self.beliefs.get(&frame).filter(|believed| believed.pose == *pose)
    }

    /// Which demonstration is open, if one is.
    pub(crate) fn demonstration(&self) -> Option<Demonstration> {
        self.source.as_ref()?.demonstration()
    }

    /// The file of the take that is open, if it has one.
    pub(crate) fn take_path(&self) -> Option<&PathBuf> {
        self.source.as_ref().and_then(TakeSource::path).filter(|path| !is_motion(path))
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

    /// A frame, or the one that was shown last as long as it is not there with its prediction.
    pub fn shown_frame(&self, frame: usize) -> Option<&Arc<FrameData>> {
        match &self.last_frame {
            Some(last) if last.frame != frame => Some(last),
            last => self.frames.get(frame).or(last.as_ref()),
        }
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

    /// Puts a frame on the screen.
    pub(crate) fn show(&mut self, frame: Arc<FrameData>) {
        if self.last_frame.as_ref().is_none_or(|last| last.frame != frame.frame) {
            self.frames.keep_distances_of(frame.frame);
        }
        self.waits_since = None;
        self.last_frame = Some(frame);
    }

    /// Takes in a frame that was read.
    pub(crate) fn keep_frame(&mut self, frame: Arc<FrameData>) {
        self.frames.insert(frame);
        self.generation += 1;
    }
}
