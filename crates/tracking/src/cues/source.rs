//! What a cue is made of: [`CueSource`], asked in every frame, and what it is shown of the frame ([`CueFrame`]).
//!
//! A new cue is a source of its own beside the others, a row of [`Cue`], a strength in
//! [`CueOptions`](super::CueOptions) and a line in `watch`.
//!
//! Points of a limb's surface: about a point q of the axis the surface is a circle of the limb's radius. With e the way from
//! the camera, n = a × e is along the picture and f = n × a towards the camera: points q + r (s n + √(1 − s²) f) face the
//! camera, s from −1 to 1, and s = ±1 is the outline, but for the camera's nearness.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3};

use super::coverage::{Coverage, WatchedCamera};
use super::options::{CueOptions, CueReach, CueStrength};
use super::picture::GreyPicture;
use super::watch::CueMemory;
use crate::body::{Kinematics, Model, Pose};
use crate::camera::Camera;
use crate::render::{Ramp, RendererKind, View};
use crate::residual::Loss;
use crate::residual::cue::{Cue, CuePull, CueTarget};

/// Limbs nearer to the camera's plane than this have no points, metres.
const NEAREST: f64 = 0.1;
/// A limb within this sine of a ray (14°) points at the camera and has no sides.
const END_ON: f64 = 0.25;
/// What lies nearer by less than this hides nothing, metres: limbs lie in one another.
const DEPTH_SLACK: f64 = 0.03;

/// Where another tool saw a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointKeypoint {
    /// The limb whose second joint it is.
    pub limb: usize,
    /// Pixels of the camera that the fit uses: rectified, reduced like its masks. Centres at integers.
    pub pixel: DVec2,
    /// How sure the tool is, 0 to 1; more counts as 1.
    pub score: f64,
}

/// What one camera has beside its silhouette.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CameraCues {
    /// Keypoints of the tracked person.
    pub keypoints: Vec<JointKeypoint>,
    /// The picture, rectified, of the camera's size; none where nobody needs it.
    pub picture: Option<Arc<GreyPicture>>,
}

/// What a frame has beside its silhouettes, in the order of its views. Fewer cameras than views have nothing.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrameCues {
    /// By view.
    pub cameras: Vec<CameraCues>,
}

/// One kind of evidence beside the silhouettes, with what it remembers from frame to frame.
pub(super) trait CueSource: fmt::Debug + Send + Sync {
    /// Which cue it is.
    fn cue(&self) -> Cue;

    /// What pulls in a frame whose fit begins at the frame's pose, by one camera.
    fn pulls(&self, frame: &CueFrame<'_>, camera: usize, strength: CueStrength) -> Vec<CuePull>;

    /// Learns from a frame that was fitted well, at its fitted pose.
    fn learn(&mut self, _frame: &CueFrame<'_>) {}

    /// Hears that the frame before is no good beginning for the next one.
    fn forget_last_frame(&mut self) {}

    /// Writes what it remembers.
    fn store(&self, _memory: &mut CueMemory) {}

    /// Goes on from what was remembered of the same body.
    fn restore(&mut self, _model: &Model, _memory: &CueMemory) {}

    /// Is shown the pictures of the frame that it remembers.
    fn see_before(&mut self, _pictures: &CameraPictures) {}
}

/// Pictures by camera's name.
pub(super) type CameraPictures = BTreeMap<String, Arc<GreyPicture>>;

/// A frame as sources are shown it: at the pose that its fit begins with, or at the fitted one.
pub(super) struct CueFrame<'a> {
    pub(super) model: &'a Arc<Model>,
    pub(super) options: &'a CueOptions,
    pub(super) renderer: RendererKind,
    pub(super) cameras: Vec<&'a Camera>,
    pub(super) cues: &'a FrameCues,
    pub(super) pose: &'a Pose,
    pub(super) kinematics: Kinematics,
    pub(super) coverage: Coverage,
    /// The limbs that cues of pictures pull at.
    pub(super) limbs: Vec<usize>,
    /// By camera, drawn when it is first asked for.
    pub(super) drawn: Vec<OnceLock<View>>,
}

impl<'a> CueFrame<'a> {
    pub(super) fn new(
        model: &'a Arc<Model>,
        options: &'a CueOptions,
        renderer: RendererKind,
        cameras: &'a [WatchedCamera],
        cues: &'a FrameCues,
        pose: &'a Pose,
    ) -> Self {
        let kinematics = Kinematics::new(model, pose);
        let coverage = Coverage::new(model, &kinematics, cameras, renderer, &options.coverage);
        let is_pulled = |&limb: &usize| options.reach == CueReach::All || coverage.is_covered(limb);
        let limbs = (0..model.limbs().len()).filter(is_pulled).collect();
        let drawn = cameras.iter().map(|_| OnceLock::new()).collect();
        let cameras = cameras.iter().map(|watched| &*watched.camera).collect();
        Self { model, options, renderer, cameras, cues, pose, kinematics, coverage, limbs, drawn }
    }

    /// A camera's picture, if it is of the camera's size.
    pub(super) fn picture(&self, camera: usize) -> Option<&GreyPicture> {
        picture_of(self.cameras[camera], self.cues, camera).map(|picture| &**picture)
    }

    /// All such pictures.
    pub(super) fn pictures(&self) -> CameraPictures {
        pictures_of(&self.cameras, self.cues)
    }

    /// The frame's pose as a camera sees it.
    pub(super) fn sight(&self, camera: usize) -> BodySight<'_> {
        let view = self.drawn[camera]
            .get_or_init(|| drawn(self.model, &self.kinematics, self.cameras[camera], self.renderer));
        BodySight { model: self.model, kinematics: &self.kinematics, camera: self.cameras[camera], view }
    }
}

/// The pictures that are of their camera's size.
pub(super) fn pictures_of(cameras: &[&Camera], cues: &FrameCues) -> CameraPictures {
    let of_camera = |(index, camera): (usize, &&Camera)| {
        Some((camera.name().to_owned(), Arc::clone(picture_of(camera, cues, index)?)))
    };
    cameras.iter().enumerate().filter_map(of_camera).collect()
}

fn picture_of<'a>(camera: &Camera, cues: &'a FrameCues, index: usize) -> Option<&'a Arc<GreyPicture>> {
    let picture = cues.cameras.get(index)?.picture.as_ref()?;
    ((picture.width(), picture.height()) == (camera.width(), camera.height())).then_some(picture)
}

/// A pose as a camera draws it, with the `half` ramp.
pub(super) fn drawn(model: &Model, kinematics: &Kinematics, camera: &Camera, renderer: RendererKind) -> View {
    View::new(model, kinematics, camera, renderer, Ramp::Half)
}

/// Metres a pixel at a depth; `None` at the camera.
pub(super) fn metres_per_px(camera: &Camera, depth: f64) -> Option<f64> {
    let metres = depth / camera.intrinsics().mean_focal_px();
    (metres.is_finite() && metres > 1e-9).then_some(metres)
}

impl CueStrength {
    /// A pull of this strength.
    pub(super) fn pull(self, cue: Cue, limb: usize, target: CueTarget, metres_per_px: f64) -> CuePull {
        let loss = Loss::Cauchy { scale: self.scale_m };
        CuePull { cue, limb, target, metres_per_px, weight: self.weight, loss }
    }
}

/// A point of a limb's surface, as a camera sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfacePoint {
    /// From the limb's first joint, in its rest frame, metres.
    pub(super) arm: DVec3,
    /// World, metres.
    pub(super) world: DVec3,
    /// Pixels.
    pub(super) pixel: DVec2,
    /// Depth, metres.
    pub(super) depth: f64,
    /// Unit vectors in the world: outwards along the picture, along the limb, towards the camera.
    pub(super) aside: DVec3,
    pub(super) along: DVec3,
    pub(super) facing: DVec3,
}

/// A pose as one camera sees it.
pub(super) struct BodySight<'a> {
    pub(super) model: &'a Model,
    pub(super) kinematics: &'a Kinematics,
    pub(super) camera: &'a Camera,
    /// With the `half` ramp.
    pub(super) view: &'a View,
}

impl BodySight<'_> {
    /// The points of limbs at these fractions of their lengths and of their breadths that nothing hides, limb by limb.
    pub(super) fn visible_points<'b, const N: usize, const M: usize>(
        &'b self,
        limbs: &'b [usize],
        fractions: [f64; N],
        breadths: [f64; M],
    ) -> impl Iterator<Item = (usize, SurfacePoint)> + 'b {
        let places = move |&limb: &usize| {
            fractions.into_iter().flat_map(move |at| breadths.map(|aside| (limb, at, aside)))
        };
        limbs.iter().flat_map(places).filter_map(|(limb, at, aside)| {
            let point = self.point(limb, at, aside)?;
            self.is_visible(limb, &point).then_some((limb, point))
        })
    }

    /// The point of a limb's surface at a fraction of its length and s of its breadth; `None` for a limb that points at the
    /// camera or is too near to it.
    pub(super) fn point(&self, limb: usize, fraction: f64, s: f64) -> Option<SurfacePoint> {
        let [p0, p1] = [self.kinematics.starts()[limb], self.kinematics.ends()[limb]];
        let axis = p1 - p0;
        let on_axis = p0 + axis * fraction;
        let along = axis.try_normalize()?;
        let way = (on_axis - self.camera.centre()).try_normalize()?;
        let aside = along.cross(way);
        if aside.length() < END_ON {
            return None;
        }
        let aside = aside.normalize();
        let facing = aside.cross(along);
        let facing = if facing.dot(way) > 0.0 { -facing } else { facing };
        let rest = &self.model.limbs()[limb];
        let world = on_axis + (aside * s + facing * (1.0 - s * s).max(0.0).sqrt()) * rest.radius;
        let depth = self.camera.depth(world);
        if depth < NEAREST {
            return None;
        }
        let arm = self.kinematics.world_rotations()[rest.rotation].transpose() * (world - p0);
        Some(SurfacePoint {
            arm,
            world,
            pixel: self.camera.project(world)?,
            depth,
            aside: aside * if s < 0.0 { -1.0 } else { 1.0 },
            along,
            facing,
        })
    }

    /// Whether no limb that turns otherwise lies between the camera and a point of a limb.
    pub(super) fn is_visible(&self, limb: usize, point: &SurfacePoint) -> bool {
        let rotation = self.model.limbs()[limb].rotation;
        let place = self.camera.camera_from_world();
        let way = place.transform(point.world);
        let (ray, distance) = (way.normalize(), way.length());
        let px = point.pixel.round();
        if px.x < 0.0 || px.y < 0.0 {
            return false;
        }
        let (x, y) = (px.x as usize, px.y as usize);
        if x >= self.view.size[0] || y >= self.view.size[1] {
            return false;
        }
        !self.view.primitives.iter().any(|primitive| {
            let is_other = self.model.limbs()[primitive.limb].rotation != rotation;
            is_other && primitive.bounds.contains(x, y) && {
                primitive.candidate(ray).is_some_and(|candidate| {
                    let within = primitive.radius * primitive.radius - candidate.squared;
                    within > 0.0 && candidate.depth - within.sqrt() < distance - DEPTH_SLACK
                })
            }
        })
    }
}
