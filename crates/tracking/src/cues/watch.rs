//! Cues from frame to frame: what a frame's fit is to be pulled by, and what is learnt of where it ended.

use std::sync::Arc;

use super::coverage::{LimbHold, WatchedCamera};
use super::edges::EdgeSource;
use super::flow::FlowSource;
use super::keypoints::KeypointOffsets;
use super::options::CueOptions;
use super::source::{CueFrame, CueSource, FrameCues, pictures_of};
use super::stereo::StereoSource;
use crate::body::{Model, Pose};
use crate::camera::Camera;
use crate::numbers::OptionError;
use crate::render::RendererKind;
use crate::residual::cue::CueSet;

/// Everything that cues remember from frame to frame, and what pulls in the one at hand.
#[derive(Debug)]
pub struct CueWatch {
    model: Arc<Model>,
    options: CueOptions,
    renderer: RendererKind,
    cameras: Vec<WatchedCamera>,
    cues: FrameCues,
    set: Arc<CueSet>,
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
        let keypoints = KeypointOffsets::new(model.limbs().len(), options.offset_m);
        let groups: [Vec<Box<dyn CueSource>>; 3] = [
            vec![Box::new(keypoints)],
            vec![Box::new(FlowSource::default())],
            vec![Box::new(EdgeSource::default()), Box::new(StereoSource)],
        ];
        let (cameras, cues, set) = (Vec::new(), FrameCues::default(), Arc::default());
        Ok(Self { model, options, renderer, cameras, cues, set, groups })
    }

    /// What pulls in a frame whose fit begins at `start`. `cues` are in the order of the cameras; pictures that are not of
    /// their camera's size are not looked at.
    pub fn update(&mut self, cameras: Vec<WatchedCamera>, cues: FrameCues, start: &Pose) -> &Arc<CueSet> {
        (self.cameras, self.cues) = (cameras, cues);
        let frame =
            CueFrame::new(&self.model, &self.options, self.renderer, &self.cameras, &self.cues, start);
        let mut pulls = Vec::new();
        for group in &self.groups {
            for camera in 0..self.cameras.len() {
                for source in group {
                    let strength = self.options.strength(source.cue());
                    if strength.weight > 0.0 {
                        pulls.extend(source.pulls(&frame, camera, strength));
                    }
                }
            }
        }
        let cameras = self.cameras.iter().map(|watched| Arc::clone(&watched.camera)).collect();
        self.set = Arc::new(CueSet { cameras, pulls });
        &self.set
    }

    /// What pulls in the frame of the last [update](Self::update).
    #[must_use]
    pub fn set(&self) -> &Arc<CueSet> {
        &self.set
    }

    /// Learns from where that frame's fit ended, if that `is_good`, and says what held it there, part by part. What is not good
    /// is no beginning for the next frame's flow either.
    pub fn learn(&mut self, pose: &Pose, is_good: bool) -> Vec<LimbHold> {
        let cues = std::mem::take(&mut self.cues);
        let frame = CueFrame::new(&self.model, &self.options, self.renderer, &self.cameras, &cues, pose);
        for source in self.groups.iter_mut().flatten() {
            if is_good { source.learn(&frame) } else { source.forget_last_frame() }
        }
        LimbHold::of_pose(&self.model, &frame.kinematics, &frame.coverage, &self.set)
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
}
