//! One frame as the window shows it: what can be had of each camera, and why the rest cannot.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use backlit_tracking::cues::JointKeypoint;
use backlit_tracking::fit::{DataView, Evidence};
use backlit_tracking::people::FollowedPerson;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::segment::changes::BackgroundChange;
use backlit_tracking::silhouette::{Label, Mask, Measurement, SignedDistance};
use image::{DynamicImage, RgbImage};
use rayon::prelude::*;

use super::replacement::{Calibration, PlateFiles};
use super::{BrushStroke, CheckedMask, Footage};

/// Grey levels below this are the subject's.
const HALF_GREY: u8 = 128;
/// Grey level of unknown pixels in drawn masks.
pub const UNKNOWN_GREY: u8 = 128;

/// What pictures are that were drawn, not filmed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawnPictures {
    /// The renderer's grey levels.
    GreyLevels,
    /// Hard masks; [`UNKNOWN_GREY`] is unknown.
    Masks,
}

/// What a frame's pictures and silhouettes depend on, besides the take.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MadeWith {
    measurement: Arc<Vec<SegmentOptions>>,
    calibration: Option<Arc<Calibration>>,
    plates: Arc<PlateFiles>,
    person: Option<Arc<FollowedPerson>>,
    changes: Arc<Vec<BackgroundChange>>,
    masks: BTreeMap<usize, PathBuf>,
    brush: Vec<BrushStroke>,
}

/// One camera's picture of one frame, on the ideal pinhole grid.
#[derive(Debug, Clone, Default)]
pub struct CameraFrame {
    /// The picture.
    pub image: Option<Arc<RgbImage>>,
    /// Its silhouette.
    pub mask: Option<Arc<Mask>>,
    distance: Arc<Mutex<Option<Arc<SignedDistance>>>>,
    /// Grey levels D that stand for the silhouette wherever D is looked at as it is; of simulations.
    pub grey_levels: Option<Arc<Measurement>>,
    /// Where another tool saw joints; empty where none has looked, or its file cannot be read.
    pub keypoints: Vec<JointKeypoint>,
    /// How many subject pixels are unknown because no other camera supports them.
    pub unsupported_px: usize,
    /// Why something is missing.
    pub problem: Option<String>,
}

impl CameraFrame {
    /// Distance from the silhouette's border, measured when it is first asked for; `None` without a silhouette.
    pub fn distance(&self) -> Option<Arc<SignedDistance>> {
        let mask = self.mask.as_ref()?;
        Some(self.kept_distance().get_or_insert_with(|| Arc::new(SignedDistance::from_mask(mask))).clone())
    }

    /// Lets go of the distance, which is larger than picture and silhouette together; it is measured again when it is asked for.
    pub fn forget_distance(&self) {
        *self.kept_distance() = None;
    }

    fn kept_distance(&self) -> MutexGuard<'_, Option<Arc<SignedDistance>>> {
        self.distance.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What a fit takes of it where D is looked at by `data`; `None` without a silhouette. Grey levels of a simulation are
    /// smooth as they are.
    pub fn evidence(&self, data: DataView) -> Option<Evidence> {
        match &self.grey_levels {
            Some(levels) if data != DataView::Distance => Some(Evidence::Measurement(levels.clone())),
            _ => self.mask.clone().map(Evidence::Mask),
        }
    }

    /// Takes a drawn picture, whose grey levels are the silhouette: no segmentation.
    fn take_drawn(&mut self, image: RgbImage, drawn: DrawnPictures) {
        let grey = DynamicImage::ImageRgb8(image.clone()).into_luma8();
        let label = |pixel: &u8| match *pixel {
            UNKNOWN_GREY if drawn == DrawnPictures::Masks => Label::Unknown,
            level if level < HALF_GREY => Label::Subject,
            _ => Label::Background,
        };
        let labels = grey.as_raw().iter().map(label).collect();
        match Mask::new(grey.width() as usize, grey.height() as usize, labels) {
            Ok(mask) => self.mask = Some(Arc::new(mask)),
            Err(problem) => self.problem = Some(problem.to_string()),
        }
        if drawn == DrawnPictures::GreyLevels {
            self.grey_levels = Some(Arc::new(Measurement::from_gray(&grey)));
        }
        self.image = Some(Arc::new(image));
    }
}

/// All cameras' pictures of one frame.
#[derive(Debug, Clone)]
pub struct FrameData {
    /// The frame.
    pub frame: usize,
    /// By camera.
    pub cameras: Vec<CameraFrame>,
    /// What it depends on, besides the take.
    pub made_with: MadeWith,
}

impl Footage {
    /// What a frame's pictures and silhouettes depend on, besides the take.
    pub fn made_with(&self, measurement: &Arc<Vec<SegmentOptions>>, frame: usize) -> MadeWith {
        MadeWith {
            measurement: measurement.clone(),
            calibration: self.calibration.clone(),
            plates: self.plates.clone(),
            person: self.take().person().cloned(),
            changes: self.changes.clone(),
            masks: self.masks.get(&frame).cloned().unwrap_or_default(),
            brush: self.brush.iter().filter(|one| one.is_of(one.camera, frame)).cloned().collect(),
        }
    }

    /// Reads, rectifies and segments one camera's picture. What goes wrong is said in the result: the other
    /// cameras and the picture without its silhouette are still of use.
    pub fn load(&self, camera: usize, frame: usize, options: &SegmentOptions) -> CameraFrame {
        // The tracker says what is wrong with a file of keypoints.
        let cues = self.camera_cues(camera, frame, None);
        let keypoints = cues.map_or_else(|_| Vec::new(), |cues| cues.keypoints);
        let mut result = CameraFrame { keypoints, ..CameraFrame::default() };
        match (self.picture(camera, frame), self.drawn) {
            (Ok(image), Some(drawn)) => {
                result.take_drawn(image, drawn);
                if let Some(mask) = result.mask.as_mut().filter(|_| result.grey_levels.is_none()) {
                    self.paint(camera, frame, Arc::make_mut(mask));
                }
            }
            (Ok(image), None) => {
                match self.mask(camera, frame, &image, options) {
                    Ok(mask) => result.mask = Some(Arc::new(mask)),
                    Err(problem) => result.problem = Some(problem.to_string()),
                }
                result.image = Some(Arc::new(image));
            }
            (Err(problem), _) => result.problem = Some(problem.to_string()),
        }
        result
    }

    /// The same of all cameras, each by its own options. The result does not depend on how cameras are shared out among
    /// threads.
    pub fn load_frame(&self, measurement: &Arc<Vec<SegmentOptions>>, frame: usize) -> FrameData {
        let all: Vec<usize> = (0..self.cameras.len()).collect();
        let cameras = self.load_cameras(&all, measurement, frame);
        FrameData { frame, cameras, made_with: self.made_with(measurement, frame) }
    }

    /// The same of some cameras, in their order: no other supports what they see.
    pub fn load_cameras(
        &self,
        cameras: &[usize],
        measurement: &[SegmentOptions],
        frame: usize,
    ) -> Vec<CameraFrame> {
        let load = |&camera: &usize| {
            let options = measurement.get(camera).cloned().unwrap_or_default();
            self.load(camera, frame, &options)
        };
        let mut loaded: Vec<CameraFrame> = cameras.par_iter().map(load).collect();
        self.check_one_another(cameras, &mut loaded, measurement, frame);
        loaded
    }

    /// Makes unknown what no other camera supports. Drawn pictures and the user's own silhouettes stay as they are.
    fn check_one_another(
        &self,
        cameras: &[usize],
        loaded: &mut [CameraFrame],
        measurement: &[SegmentOptions],
        frame: usize,
    ) {
        if self.drawn.is_some() {
            return;
        }
        let own = self.masks.get(&frame);
        let (mut seen, mut hidden) = (Vec::new(), Vec::new());
        for (&number, CameraFrame { mask, unsupported_px, .. }) in cameras.iter().zip(loaded) {
            let is_asked = measurement.get(number).is_none_or(|options| options.needs_support);
            let is_own = own.is_some_and(|masks| masks.contains_key(&number));
            if let Some(mask) = mask {
                let mask = Arc::make_mut(mask);
                seen.push(CheckedMask { camera: number, mask, needs_support: is_asked && !is_own });
                hidden.push(unsupported_px);
            }
        }
        hidden.into_iter().zip(self.hide_unsupported(frame, seen)).for_each(|(px, found)| *px = found);
    }
}
