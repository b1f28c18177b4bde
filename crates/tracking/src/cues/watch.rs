//! Cues from frame to frame: what a frame's fit is to be pulled by, and what is learnt of where it ended.

use std::sync::{Arc, OnceLock};

use super::coverage::{Coverage, CoverageView, LimbHold};
use super::edges::EdgeSource;
use super::flow::FlowSource;
use super::keypoints::KeypointSource;
use super::options::{CueOptions, CueReach};
use super::source::{CueFrame, CueSource, FrameCues, pictures_of};
use super::stereo::StereoSource;
use crate::body::{Kinematics, Model, Pose};
use crate::camera::Camera;
use crate::numbers::OptionError;
use crate::render::RendererKind;
use crate::residual::cue::CueSet;
use crate::silhouette::Mask;

/// One camera of a frame, as cues ask for it.
#[derive(Debug, Clone)]
pub struct WatchedCamera {
    /// An ideal pinhole.
    pub camera: Arc<Camera>,
    /// Its silhouette, if it has one.
    pub mask: Option<Arc<Mask>>,
}

/// Everything that cues remember from frame to frame.
#[derive(Debug)]
pub struct CueWatch {
    model: Arc<Model>,
    options: CueOptions,
    renderer: RendererKind,
    /// Each group is asked camera by camera, one group after the other.
    groups: [Vec<Box<dyn CueSource>>; 3],
}

/// What cues have learnt up to a frame, but for pictures and for edges.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CueMemory {
    /// Of every limb, what says how far its keypoint is from its joint: nine numbers of products, three of forces.
    pub offsets: Vec<[f64; 12]>,
    /// The pose that the next frame's flow begins at; `None` where that frame was no good one, or had no pictures.
    pub before: Option<Pose>,
}

impl CueWatch {
    /// Remembers nothing yet.
    ///
    /// # Errors
    /// Returns an error if an option is out of range.
    pub fn new(model: Arc<Model>, options: CueOptions, renderer: RendererKind) -> Result<Self, OptionError> {
        options.check()?;
        let keypoints = KeypointSource::new(model.limbs().len(), options.offset_m);
        let groups: [Vec<Box<dyn CueSource>>; 3] = [
            vec![Box::new(keypoints)],
            vec![Box::new(FlowSource::default())],
            vec![Box::new(EdgeSource::default()), Box::new(StereoSource)],
        ];
        Ok(Self { model, options, renderer, groups })
    }

    /// What pulls in a frame whose fit begins at `start`. `cues` are in the order of the cameras; pictures that are not of
    /// their camera's size are not looked at.
    #[must_use]
    pub fn look(&self, cameras: &[WatchedCamera], cues: &FrameCues, start: &Pose) -> CueSet {
        let frame = frame(&self.model, &self.options, self.renderer, cameras, cues, start);
        let mut pulls = Vec::new();
        for group in &self.groups {
            for camera in 0..cameras.len() {
                for source in group {
                    let strength = self.options.strength(source.cue());
                    if strength.weight > 0.0 {
                        pulls.extend(source.pulls(&frame, camera, strength));
                    }
                }
            }
        }
        CueSet { cameras: cameras.iter().map(|watched| Arc::clone(&watched.camera)).collect(), pulls }
    }

    /// Learns from where a frame's fit ended, if that `is_good`, and says what held it there, part by part. What is not good
    /// is no beginning for the next frame's flow either.
    pub fn learn(
        &mut self,
        cameras: &[WatchedCamera],
        cues: &FrameCues,
        set: &CueSet,
        pose: &Pose,
        is_good: bool,
    ) -> Vec<LimbHold> {
        let frame = frame(&self.model, &self.options, self.renderer, cameras, cues, pose);
        for source in self.groups.iter_mut().flatten() {
            if is_good { source.learn(&frame) } else { source.forget_last_frame() }
        }
        LimbHold::of_pose(&self.model, &frame.kinematics, &frame.coverage, set)
    }

    /// What it has learnt so far.
    #[must_use]
    pub fn memory(&self) -> CueMemory {
        let mut memory = CueMemory::default();
        self.groups.iter().flatten().for_each(|source| source.store(&mut memory));
        memory
    }

    /// Goes on from what another one had learnt. The memory must be of the same body.
    pub fn remember(&mut self, memory: &CueMemory) {
        self.groups.iter_mut().flatten().for_each(|source| source.restore(&self.model, memory));
    }

    /// Shows it the pictures of the frame that it [remembers](Self::remember).
    pub fn see_before(&mut self, cameras: &[WatchedCamera], cues: &FrameCues) {
        let plain: Vec<&Camera> = cameras.iter().map(|watched| &*watched.camera).collect();
        let pictures = pictures_of(&plain, cues);
        self.groups.iter_mut().flatten().for_each(|source| source.see_before(&pictures));
    }

    /// Which parts silhouettes hold at a pose.
    #[must_use]
    pub fn coverage(&self, kinematics: &Kinematics, cameras: &[WatchedCamera]) -> Coverage {
        coverage(&self.model, &self.options, self.renderer, kinematics, cameras)
    }
}

fn frame<'a>(
    model: &'a Arc<Model>,
    options: &'a CueOptions,
    renderer: RendererKind,
    cameras: &'a [WatchedCamera],
    cues: &'a FrameCues,
    pose: &'a Pose,
) -> CueFrame<'a> {
    let kinematics = Kinematics::new(model, pose);
    let coverage = coverage(model, options, renderer, &kinematics, cameras);
    let is_pulled = |&limb: &usize| options.reach == CueReach::All || coverage.is_covered(limb);
    CueFrame {
        cameras: cameras.iter().map(|watched| &*watched.camera).collect(),
        limbs: (0..model.limbs().len()).filter(is_pulled).collect(),
        drawn: cameras.iter().map(|_| OnceLock::new()).collect(),
        model,
        options,
        renderer,
        cues,
        pose,
        kinematics,
        coverage,
    }
}

fn coverage(
    model: &Model,
    options: &CueOptions,
    renderer: RendererKind,
    kinematics: &Kinematics,
    cameras: &[WatchedCamera],
) -> Coverage {
    let views: Vec<CoverageView<'_>> = cameras
        .iter()
        .map(|watched| CoverageView { camera: &watched.camera, mask: watched.mask.as_deref() })
        .collect();
    Coverage::new(model, kinematics, &views, renderer, &options.coverage)
}
