//! Cues from frame to frame: what a frame's fit is to be pulled by, and what is learnt of where it ended.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::coverage::{Coverage, CoverageView};
use super::edges::EdgeMemory;
use super::evidence::FrameCues;
use super::flow;
use super::hold::LimbHold;
use super::keypoints::{self, KeypointOffsets};
use super::options::{CueOptions, CueOptionsError, CueReach};
use super::picture::GreyPicture;
use super::stereo::{self, StereoView};
use super::surface::Seen;
use crate::body::{Kinematics, Model, Pose};
use crate::camera::Camera;
use crate::render::{Ramp, RendererKind, View};
use crate::residual::cue::{Cue, CuePull, CueSet};
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
#[derive(Debug, Clone)]
pub struct CueWatch {
    model: Arc<Model>,
    options: CueOptions,
    renderer: RendererKind,
    offsets: KeypointOffsets,
    /// The frame before, if its pose was good.
    before: Option<Before>,
    /// By camera's name.
    edges: BTreeMap<String, EdgeMemory>,
}

/// The frame before.
#[derive(Debug, Clone)]
struct Before {
    pose: Pose,
    kinematics: Kinematics,
    /// By camera's name.
    pictures: BTreeMap<String, Arc<GreyPicture>>,
}

/// What cues have learnt up to a frame, but for pictures and for edges.
#[derive(Debug, Clone, PartialEq)]
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
    /// Options that make no sense.
    pub fn new(
        model: Arc<Model>,
        options: CueOptions,
        renderer: RendererKind,
    ) -> Result<Self, CueOptionsError> {
        options.check()?;
        let offsets = KeypointOffsets::new(model.limbs().len(), options.offset_m);
        Ok(Self { offsets, options, renderer, model, before: None, edges: BTreeMap::new() })
    }

    /// What pulls in a frame whose fit begins at `start`. `cues` are in the order of the cameras; pictures that are not of
    /// their camera's size are not looked at.
    #[must_use]
    pub fn look(&self, cameras: &[WatchedCamera], cues: &FrameCues, start: &Pose) -> CueSet {
        let kinematics = Kinematics::new(&self.model, start);
        let coverage = self.coverage(&kinematics, cameras);
        let plain: Vec<&Camera> = cameras.iter().map(|watched| &*watched.camera).collect();
        let (model, options) = (&self.model, &self.options);
        let mut pulls = keypoints::pulls(model, &kinematics, &plain, cues, &coverage, &self.offsets, options);
        let is_pulled = |&limb: &usize| options.reach == CueReach::All || coverage.is_covered(limb);
        let limbs: Vec<usize> = (0..model.limbs().len()).filter(is_pulled).collect();
        if !limbs.is_empty() {
            self.pulls_of_pictures(&plain, cues, &kinematics, &limbs, &mut pulls);
        }
        CueSet { cameras: cameras.iter().map(|watched| Arc::clone(&watched.camera)).collect(), pulls }
    }

    fn pulls_of_pictures(
        &self,
        cameras: &[&Camera],
        cues: &FrameCues,
        start: &Kinematics,
        limbs: &[usize],
        pulls: &mut Vec<CuePull>,
    ) {
        let pictures = pictures(cameras, cues);
        if pictures.iter().all(Option::is_none) {
            return;
        }
        let is_on = |cue| self.options.strength(cue).weight > 0.0;
        if is_on(Cue::Flow)
            && let Some(Before { kinematics: before, pictures: last, .. }) = &self.before
        {
            let strength = self.options.strength(Cue::Flow);
            for (index, (camera, picture)) in cameras.iter().zip(&pictures).enumerate() {
                let (Some(now), Some(last)) = (picture, last.get(camera.name())) else { continue };
                let view = self.view(before, camera);
                let seen = self.seen(before, camera, &view);
                pulls.extend(flow::pulls(&seen, [last, now], index, start, limbs, strength));
            }
        }
        if !is_on(Cue::Edges) && !is_on(Cue::Stereo) {
            return;
        }
        let views: Vec<View> = cameras.iter().map(|camera| self.view(start, camera)).collect();
        let stereo_view = |index: usize| {
            let seen = self.seen(start, cameras[index], &views[index]);
            Some(StereoView { seen, picture: pictures[index]? })
        };
        for (index, camera) in cameras.iter().enumerate() {
            let Some(one) = stereo_view(index) else { continue };
            if is_on(Cue::Edges)
                && let Some(edges) = self.edges.get(camera.name())
            {
                let strength = self.options.strength(Cue::Edges);
                pulls.extend(edges.pulls(&one.seen, index, one.picture, limbs, strength));
            }
            if is_on(Cue::Stereo) {
                let strength = self.options.strength(Cue::Stereo);
                for other in (0..cameras.len()).filter(|other| *other != index).filter_map(stereo_view) {
                    pulls.extend(stereo::pulls(&one, &other, limbs, strength));
                }
            }
        }
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
        let kinematics = Kinematics::new(&self.model, pose);
        let coverage = self.coverage(&kinematics, cameras);
        let plain: Vec<&Camera> = cameras.iter().map(|watched| &*watched.camera).collect();
        let holds = LimbHold::of_pose(&self.model, &kinematics, &coverage, set);
        self.before = None;
        if is_good {
            let lowest = self.options.lowest_score;
            self.offsets.learn(&self.model, &kinematics, &plain, cues, &coverage, lowest);
            self.learn_pictures(&plain, cues, pose, kinematics);
        }
        holds
    }

    fn learn_pictures(&mut self, cameras: &[&Camera], cues: &FrameCues, pose: &Pose, kinematics: Kinematics) {
        let learns_edges = self.options.strength(Cue::Edges).weight > 0.0;
        for (camera, picture) in cameras.iter().zip(pictures(cameras, cues)).filter(|_| learns_edges) {
            let Some(picture) = picture else { continue };
            let view = self.view(&kinematics, camera);
            let mut edges = self.edges.remove(camera.name()).unwrap_or_default();
            edges.learn(&self.seen(&kinematics, camera, &view), picture);
            self.edges.insert(camera.name().to_owned(), edges);
        }
        let pictures = shared_pictures(cameras, cues);
        self.before = (!pictures.is_empty()).then(|| Before { pose: pose.clone(), kinematics, pictures });
    }

    /// What it has learnt so far.
    #[must_use]
    pub fn memory(&self) -> CueMemory {
        let before = self.before.as_ref().map(|before| before.pose.clone());
        CueMemory { offsets: self.offsets.numbers(), before }
    }

    /// Goes on from what another one had learnt. The memory must be of the same body.
    pub fn remember(&mut self, memory: CueMemory) {
        self.offsets.remember(&memory.offsets);
        self.before = memory.before.map(|pose| Before {
            kinematics: Kinematics::new(&self.model, &pose),
            pictures: BTreeMap::new(),
            pose,
        });
    }

    /// Shows it the pictures of the frame that it [remembers](Self::remember).
    pub fn see_before(&mut self, cameras: &[WatchedCamera], cues: &FrameCues) {
        let plain: Vec<&Camera> = cameras.iter().map(|watched| &*watched.camera).collect();
        if let Some(before) = &mut self.before {
            before.pictures = shared_pictures(&plain, cues);
        }
    }

    fn view(&self, kinematics: &Kinematics, camera: &Camera) -> View {
        View::new(&self.model, kinematics, camera, self.renderer, Ramp::Half)
    }

    fn seen<'a>(&'a self, kinematics: &'a Kinematics, camera: &'a Camera, view: &'a View) -> Seen<'a> {
        Seen { model: &self.model, kinematics, camera, view }
    }

    /// How far keypoints lie from their joints.
    #[must_use]
    pub fn offsets(&self) -> &KeypointOffsets {
        &self.offsets
    }

    /// Which parts silhouettes hold at a pose.
    #[must_use]
    pub fn coverage(&self, kinematics: &Kinematics, cameras: &[WatchedCamera]) -> Coverage {
        let views: Vec<CoverageView<'_>> = cameras
            .iter()
            .map(|watched| CoverageView { camera: &watched.camera, mask: watched.mask.as_deref() })
            .collect();
        Coverage::new(&self.model, kinematics, &views, self.renderer, &self.options.coverage)
    }
}

/// The pictures that are of their camera's size.
fn pictures<'a>(cameras: &[&Camera], cues: &'a FrameCues) -> Vec<Option<&'a GreyPicture>> {
    let of_camera = |(index, camera): (usize, &&Camera)| {
        let picture = cues.cameras.get(index)?.picture.as_deref()?;
        let is_its_own = (picture.width(), picture.height()) == (camera.width(), camera.height());
        is_its_own.then_some(picture)
    };
    cameras.iter().enumerate().map(of_camera).collect()
}

/// The same, by the camera's name.
fn shared_pictures(cameras: &[&Camera], cues: &FrameCues) -> BTreeMap<String, Arc<GreyPicture>> {
    let are_their_own = pictures(cameras, cues).into_iter().map(|picture| picture.is_some());
    let of_cameras =
        cameras.iter().zip(&cues.cameras).zip(are_their_own).filter(|(_, is_its_own)| *is_its_own);
    of_cameras
        .filter_map(|((camera, cues), _)| Some((camera.name().to_owned(), cues.picture.clone()?)))
        .collect()
}
