//! A take's pictures as the window wants them: what can be had of each camera, and why the rest cannot.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use backlit_formats::synchronise::{self, TakeClocks, TakeClocksError};
use backlit_formats::{Take, TakeError};
use backlit_lab::experiment::Simulation;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::{CameraCues, JointKeypoint};
use backlit_tracking::fit::{DataView, Evidence};
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::start;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::{Label, Mask, Measurement, SignedDistance};
use backlit_tracking::synchronise::SynchroniseOptions;
use image::{DynamicImage, RgbImage};

use crate::demonstration::{Demonstration, UNKNOWN_GREY};
use crate::replacement::{Calibration, MaskFiles, PlateFiles, read_mask};
use crate::source::TakeSource;

/// Grey levels below this are the subject's.
const HALF_GREY: u8 = 128;

/// A take with everything that is made once for all its frames.
#[derive(Debug)]
pub struct Footage {
    /// Where it came from; `None` for one that was made in memory.
    pub source: Option<TakeSource>,
    /// What it is called.
    pub name: String,
    /// Frames per second.
    pub frame_rate: f64,
    /// The cameras of the pictures: without distortion.
    pub cameras: Arc<Vec<Arc<Camera>>>,
    /// Cameras in the place of the take's, if there are any.
    pub calibration: Option<Arc<Calibration>>,
    /// Plates in the place of the take's.
    pub plates: Arc<PlateFiles>,
    /// Silhouettes in the place of those that are measured.
    pub masks: Arc<MaskFiles>,
    inner: Arc<backlit_formats::Footage>,
    /// The take as its files have it.
    original: Arc<backlit_formats::Footage>,
}

/// What a frame's pictures and silhouettes depend on, besides the take.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MadeWith {
    measurement: Arc<Vec<SegmentOptions>>,
    calibration: Option<Arc<Calibration>>,
    plates: Arc<PlateFiles>,
    masks: BTreeMap<usize, PathBuf>,
}

/// One camera's picture of one frame, on the ideal pinhole grid.
#[derive(Debug, Clone, Default)]
pub struct CameraFrame {
    /// The picture.
    pub image: Option<Arc<RgbImage>>,
    /// Its silhouette.
    pub mask: Option<Arc<Mask>>,
    distance: OnceLock<SignedDistance>,
    /// Grey levels D that stand for the silhouette wherever D is looked at as it is; of simulations.
    pub grey_levels: Option<Arc<Measurement>>,
    /// Where another tool saw joints; empty where none has looked, or its file cannot be read.
    pub keypoints: Vec<JointKeypoint>,
    /// Why something is missing.
    pub problem: Option<String>,
}

impl CameraFrame {
    /// Distance from the silhouette's border, measured when it is first asked for; `None` without a silhouette.
    pub fn distance(&self) -> Option<&SignedDistance> {
        let mask = self.mask.as_ref()?;
        Some(self.distance.get_or_init(|| SignedDistance::from_mask(mask)))
    }

    /// What a fit takes of it where D is looked at by `data`; `None` without a silhouette. Grey levels of a simulation are
    /// smooth as they are.
    pub fn evidence(&self, data: DataView) -> Option<Evidence> {
        match &self.grey_levels {
            Some(levels) if data != DataView::Distance => Some(Evidence::Measurement(levels.clone())),
            _ => self.mask.clone().map(Evidence::Mask),
        }
    }

    /// Takes a simulated picture, whose grey levels are the silhouette: no segmentation.
    fn simulate(&mut self, image: RgbImage, simulation: Simulation) {
        let grey = DynamicImage::ImageRgb8(image.clone()).into_luma8();
        let label = |pixel: &u8| match *pixel {
            UNKNOWN_GREY if simulation == Simulation::Mask => Label::Unknown,
            level if level < HALF_GREY => Label::Subject,
            _ => Label::Background,
        };
        let labels = grey.as_raw().iter().map(label).collect();
        match Mask::new(grey.width() as usize, grey.height() as usize, labels) {
            Ok(mask) => self.mask = Some(Arc::new(mask)),
            Err(problem) => self.problem = Some(problem.to_string()),
        }
        if simulation == Simulation::Prediction {
            self.grey_levels = Some(Arc::new(Measurement::from_gray(&grey)));
        }
        self.image = Some(Arc::new(image));
    }
}

impl Footage {
    /// Which demonstration this is, if it is one.
    pub fn demonstration(&self) -> Option<Demonstration> {
        match self.source {
            Some(TakeSource::Demonstration(which)) => Some(which),
            _ => None,
        }
    }

    /// Prepares a take.
    pub fn new(take: Take, source: Option<TakeSource>) -> Self {
        let (name, frame_rate) = (take.name().to_owned(), take.frame_rate());
        let inner = Arc::new(backlit_formats::Footage::new(take));
        Self {
            source,
            name,
            frame_rate,
            cameras: Arc::new(inner.cameras().to_vec()),
            calibration: None,
            plates: Arc::default(),
            masks: Arc::default(),
            original: inner.clone(),
            inner,
        }
    }

    /// The joints that keypoints of another tool show in these frames, by frame.
    ///
    /// # Errors
    /// A file that is not one of keypoints.
    pub fn keypoint_joints(&self, frames: &[usize]) -> Result<BTreeMap<usize, ReferenceJoints>, TakeError> {
        self.inner.take().keypoint_joints(frames)
    }

    /// What a camera has in a frame beside its silhouette: keypoints of another tool, and this picture of it in grey.
    ///
    /// # Errors
    /// A file that is not one of keypoints.
    pub fn cues(
        &self,
        camera: usize,
        frame: usize,
        picture: Option<&RgbImage>,
    ) -> Result<CameraCues, TakeError> {
        self.inner.camera_cues(camera, frame, picture)
    }

    /// How far the cameras were started apart, from the motion of the take's silhouettes. `on_frame` hears how many frames are
    /// done, of how many.
    ///
    /// # Errors
    /// A silhouette that cannot be had, a single camera, or `cancel`.
    pub fn clocks(
        &self,
        cancel: &CancelToken,
        on_frame: impl FnMut(usize, usize),
    ) -> Result<TakeClocks, TakeClocksError> {
        let options = SynchroniseOptions::default();
        synchronise::find(&self.inner, synchronise::USUAL_FRAMES, &options, cancel, on_frame)
    }

    /// The same with other silhouettes in the place of those that are measured.
    pub fn with_masks(&self, masks: Arc<MaskFiles>) -> Self {
        Self {
            source: self.source.clone(),
            name: self.name.clone(),
            frame_rate: self.frame_rate,
            cameras: self.cameras.clone(),
            calibration: self.calibration.clone(),
            plates: self.plates.clone(),
            masks,
            inner: self.inner.clone(),
            original: self.original.clone(),
        }
    }

    /// The same seen by the cameras of a calibration, or by the take's own again, and with these plates in the place of the
    /// take's. A calibration of other cameras than the take's changes nothing but what is said of it.
    pub fn with_replacements(&self, calibration: Option<Arc<Calibration>>, plates: Arc<PlateFiles>) -> Self {
        let own = self.original.take();
        let rig = calibration.as_ref().map(|calibration| calibration.rig.clone());
        let seen_anew = rig.and_then(|rig| own.with_rig(rig));
        let inner = match (seen_anew, plates.is_empty()) {
            (None, true) => self.original.clone(),
            (None, false) => Arc::new(backlit_formats::Footage::new(own.with_plates(&plates))),
            (Some(take), _) => Arc::new(backlit_formats::Footage::new(take.with_plates(&plates))),
        };
        let cameras = Arc::new(inner.cameras().to_vec());
        Self { calibration, plates, cameras, inner, ..self.with_masks(self.masks.clone()) }
    }

    /// What a frame's pictures and silhouettes depend on, besides the take.
    pub fn made_with(&self, measurement: &Arc<Vec<SegmentOptions>>, frame: usize) -> MadeWith {
        MadeWith {
            measurement: measurement.clone(),
            calibration: self.calibration.clone(),
            plates: self.plates.clone(),
            masks: self.masks.get(&frame).cloned().unwrap_or_default(),
        }
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.inner.take().frame_count()
    }

    /// The cameras for pictures as they are on the disk, with their lenses.
    pub fn full_cameras(&self) -> &[Camera] {
        self.original.take().full_rig().cameras()
    }

    /// The cameras as the take's files have them, with their lenses.
    pub fn take_cameras(&self) -> &[Camera] {
        self.original.take().rig().cameras()
    }

    /// The body of the take.
    pub fn model(&self) -> &Arc<Model> {
        self.inner.take().model()
    }

    /// The pose to start from: the take's own, else the one that its reference shows in the first frame, else
    /// one at rest before the cameras.
    pub fn start(&self) -> Pose {
        let from_reference = || {
            self.inner
                .take()
                .reference()
                .and_then(|reference| start::from_joints(self.model(), &reference.joints(0)))
        };
        self.inner.take().start().cloned().or_else(from_reference).unwrap_or_else(|| {
            let mut pose = Pose::rest(self.model());
            pose.root = middle_of_view(&self.cameras);
            pose
        })
    }

    /// How the take says that silhouettes are made, camera by camera.
    pub fn measurement(&self) -> &[SegmentOptions] {
        self.inner.take().measurement()
    }

    /// The take itself.
    pub fn take(&self) -> &Take {
        self.inner.take()
    }

    /// A camera's picture as large as it is on the disk, rectified: where frames are worked on at a part of their size. Nothing
    /// where they are not, or where it cannot be read.
    pub fn full_picture(&self, camera: usize, frame: usize) -> Option<RgbImage> {
        if self.take().reduction() < 2 {
            return None;
        }
        self.inner.full_picture(camera, frame).ok()
    }

    /// Reads, rectifies and segments one camera's picture. What goes wrong is said in the result: the other
    /// cameras and the picture without its silhouette are still of use.
    pub fn load(&self, camera: usize, frame: usize, options: &SegmentOptions) -> CameraFrame {
        // The tracker says what is wrong with a file of keypoints.
        let keypoints = self.cues(camera, frame, None).map_or_else(|_| Vec::new(), |cues| cues.keypoints);
        let mut result = CameraFrame { keypoints, ..CameraFrame::default() };
        if let Some(TakeSource::Demonstration(which)) = &self.source
            && which.pictures_are_silhouettes()
        {
            match self.inner.picture(camera, frame) {
                Ok(image) => result.simulate(image, which.simulation()),
                Err(problem) => result.problem = Some(problem.to_string()),
            }
            return result;
        }
        match self.inner.picture(camera, frame) {
            Ok(image) => {
                match self.mask(camera, frame, &image, options) {
                    Ok(mask) => result.mask = Some(Arc::new(mask)),
                    Err(problem) => result.problem = Some(problem.to_string()),
                }
                result.image = Some(Arc::new(image));
            }
            Err(problem) => result.problem = Some(problem.to_string()),
        }
        result
    }
}

impl Footage {
    /// The silhouette of a frame: a picture of it if the user has given one, else it is measured.
    fn mask(
        &self,
        camera: usize,
        frame: usize,
        image: &RgbImage,
        options: &SegmentOptions,
    ) -> anyhow::Result<Mask> {
        match self.masks.get(&frame).and_then(|masks| masks.get(&camera)) {
            Some(path) => {
                let lens = &self.inner.take().rig().cameras()[camera];
                Ok(read_mask(path, lens)?)
            }
            None => Ok(self.inner.mask(camera, frame, image, options)?),
        }
    }
}

/// The point that is nearest to all optical axes; metres in front of the camera if there is only one.
fn middle_of_view(cameras: &[Arc<Camera>]) -> glam::DVec3 {
    use glam::{DMat3, DVec3};
    /// Distance from a single camera, metres.
    const BEFORE: f64 = 3.0;
    let (mut sum, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for camera in cameras {
        let axis = camera.camera_from_world().rotation.transpose().z_axis;
        let across = DMat3::IDENTITY - DMat3::from_cols(axis * axis.x, axis * axis.y, axis * axis.z);
        // A little pull towards the point before the camera keeps parallel axes solvable.
        let weight = 1e-3;
        sum += across + DMat3::IDENTITY * weight;
        right += across * camera.centre() + weight * (camera.centre() + BEFORE * axis);
    }
    let middle = sum.inverse() * right;
    if middle.is_finite() { middle } else { DVec3::ZERO }
}
