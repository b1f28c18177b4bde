//! A take's pictures as everything else wants them: on the ideal pinhole grid, with their silhouettes. The user can replace
//! the take's cameras, plates and silhouettes by others.

mod brush;
pub mod changes;
mod frame;
mod prepared;
pub mod replacement;
mod stages;

use std::borrow::Cow;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::{CameraCues, FrameCues, GreyPicture};
use backlit_tracking::fit::FitView;
use backlit_tracking::geometry::NearestToLines;
use backlit_tracking::people::FollowedPerson;
use backlit_tracking::search::start;
use backlit_tracking::segment::changes::BackgroundChange;
use backlit_tracking::segment::{BackgroundError, SegmentError, SegmentOptions};
use backlit_tracking::silhouette::Mask;
use backlit_tracking::visual_hull::{HullView, UnsupportedPart, unsupported_parts};
use image::RgbImage;
use image::imageops::grayscale;
use rayon::prelude::*;
use thiserror::Error;

pub use brush::BrushStroke;
pub use frame::{CameraFrame, DrawnPictures, FrameData, MadeWith, UNKNOWN_GREY};
use prepared::PreparedTake;
use replacement::{Calibration, MaskFiles, PlateFiles, ReplacementError, read_mask};
pub use stages::TriedViews;

use crate::{Take, TakeError};

/// A take with everything that is made once for all its frames; cheap to clone.
#[derive(Debug, Clone)]
pub struct Footage {
    /// The cameras of the pictures, in the take's order: without distortion.
    pub cameras: Arc<Vec<Arc<Camera>>>,
    /// Cameras in the place of the take's, if there are any.
    pub calibration: Option<Arc<Calibration>>,
    /// Plates in the place of the take's.
    pub plates: Arc<PlateFiles>,
    /// Silhouettes in the place of those that are measured.
    pub masks: Arc<MaskFiles>,
    /// What is painted over silhouettes by hand, the oldest first.
    pub brush: Arc<Vec<BrushStroke>>,
    /// Backgrounds that change while the take is filmed.
    pub changes: Arc<Vec<BackgroundChange>>,
    /// What the pictures are if they were drawn, not filmed.
    pub drawn: Option<DrawnPictures>,
    prepared: Arc<PreparedTake>,
    /// The take as its files have it.
    original: Arc<PreparedTake>,
}

/// Why a picture or a silhouette cannot be had.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum FootageError {
    #[error(transparent)]
    Take(#[from] TakeError),
    #[error(transparent)]
    Replacement(#[from] ReplacementError),
    #[error("camera \"{camera}\": the picture is not of the camera's size")]
    Size { camera: String },
    #[error(
        "camera \"{camera}\" has no `background` in the take; expected a plate or frames without the subject, or `masks`"
    )]
    NoBackground { camera: String },
    #[error("camera \"{camera}\", background: {error}")]
    Background { camera: String, error: BackgroundError },
    #[error("camera \"{camera}\": {error}")]
    Segment { camera: String, error: SegmentError },
}

impl Footage {
    /// Prepares a take. Backgrounds are read when they are first needed.
    pub fn new(take: Take) -> Self {
        let prepared = Arc::new(PreparedTake::new(take));
        Self {
            cameras: prepared.cameras.clone(),
            calibration: None,
            plates: Arc::default(),
            masks: Arc::default(),
            brush: Arc::default(),
            changes: Arc::default(),
            drawn: None,
            original: prepared.clone(),
            prepared,
        }
    }

    /// The same seen by the cameras of a calibration, or by the take's own again, with these plates in the place of the
    /// take's, and of one of several people. A calibration of other cameras than the take's changes nothing but
    /// [`calibration`](Self::calibration).
    pub fn with_replacements(
        &self,
        calibration: Option<Arc<Calibration>>,
        plates: Arc<PlateFiles>,
        person: Option<Arc<FollowedPerson>>,
    ) -> Self {
        let own = &self.original.take;
        let rig = calibration.as_ref().map(|calibration| calibration.rig.clone());
        let prepared = match rig.and_then(|rig| own.with_rig(rig)) {
            None if plates.is_empty() && person.is_none() => self.original.clone(),
            take => {
                let take = take.as_ref().unwrap_or(own).with_plates(&plates).with_person(person);
                Arc::new(PreparedTake::new(take))
            }
        };
        Self { calibration, plates, cameras: prepared.cameras.clone(), prepared, ..self.clone() }
    }

    /// The same of one of several people.
    pub fn with_person(&self, person: Option<Arc<FollowedPerson>>) -> Self {
        self.with_replacements(self.calibration.clone(), self.plates.clone(), person)
    }

    /// The same with a body of the same limbs in other sizes; `None` for other limbs.
    pub fn with_body(&self, model: Arc<Model>) -> Option<Self> {
        let original = Arc::new(PreparedTake::new(self.original.take.with_body(model)?));
        Some(Self { original, ..self.clone() }.with_person(self.take().person().cloned()))
    }

    /// The same with backgrounds that change.
    pub fn with_changes(&self, changes: Arc<Vec<BackgroundChange>>) -> Self {
        Self { changes, ..self.clone() }
    }

    /// The take, with the calibration and the plates that replace its own.
    pub fn take(&self) -> &Take {
        &self.prepared.take
    }

    /// The take as its files have it.
    pub fn original(&self) -> &Take {
        &self.original.take
    }

    /// Whether both are of the very same take, whatever replaces parts of it.
    pub fn shares_take_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.original, &other.original)
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.take().frame_count()
    }

    /// The pose to start from: the take's own, else the one that its reference shows in the first frame, else
    /// one at rest before the cameras.
    pub fn start(&self) -> Pose {
        let (take, model) = (self.take(), self.take().model());
        let from_reference =
            || take.reference().and_then(|reference| start::from_joints(model, &reference.joints(0)));
        take.start().cloned().or_else(from_reference).unwrap_or_else(|| {
            let mut pose = Pose::rest(model);
            pose.root = middle_of_view(&self.cameras);
            pose
        })
    }

    /// A camera's picture of a frame, on the ideal grid.
    pub fn picture(&self, camera: usize, frame: usize) -> Result<RgbImage, FootageError> {
        let picture = self.take().frame(camera, frame)?;
        self.prepared.rectified(camera, &picture)
    }

    /// The same as large as it is on the disk: on the ideal grid of the camera at its full size, whose pixels are the
    /// [reduction](Take::reduction) times as many on each side.
    pub fn full_picture(&self, camera: usize, frame: usize) -> Result<RgbImage, FootageError> {
        self.prepared.full_picture(camera, frame)
    }

    /// The silhouette of a frame whose [`picture`](Self::picture) this is: the user's, else [the take's](Self::given_mask),
    /// else the picture is segmented by these options; and what is painted over it. Where the lens saw nothing it is unknown.
    pub fn mask(
        &self,
        camera: usize,
        frame: usize,
        picture: &RgbImage,
        options: &SegmentOptions,
    ) -> Result<Mask, FootageError> {
        self.steered(camera, frame, || Ok(Cow::Borrowed(picture)), options)
    }

    /// The same of a picture that is read where it is needed.
    fn steered<'a>(
        &self,
        camera: usize,
        frame: usize,
        picture: impl FnOnce() -> Result<Cow<'a, RgbImage>, FootageError>,
        options: &SegmentOptions,
    ) -> Result<Mask, FootageError> {
        let mut mask = match self.masks.get(&frame).and_then(|masks| masks.get(&camera)) {
            Some(path) => read_mask(path, &self.take().rig().cameras()[camera])?,
            None => self.measured(camera, frame, picture, options)?,
        };
        self.paint(camera, frame, &mut mask);
        Ok(mask)
    }

    /// The silhouette that the take has from elsewhere, else the one that is made of the picture; without other people.
    fn measured<'a>(
        &self,
        camera: usize,
        frame: usize,
        picture: impl FnOnce() -> Result<Cow<'a, RgbImage>, FootageError>,
        options: &SegmentOptions,
    ) -> Result<Mask, FootageError> {
        let mut mask = match self.given_mask(camera, frame)? {
            Some(mask) => mask,
            None => self.prepared.segmented((camera, frame), &*picture()?, options, &self.changes)?,
        };
        self.hide_people(camera, frame, &mut mask);
        Ok(mask)
    }

    /// The silhouette of a frame that the take has from elsewhere, on the ideal grid; `None` for a camera without masks. It is
    /// reduced and rectified by area before it is decided which pixels are subject.
    pub fn given_mask(&self, camera: usize, frame: usize) -> Result<Option<Mask>, FootageError> {
        self.prepared.given_mask(camera, frame)
    }

    /// The evidence of some cameras in a frame, by the take's own measurement settings; what only one of them sees is unknown
    /// where its settings [ask for support](SegmentOptions::needs_support). Cameras are shared out among threads; the result does not
    /// depend on how.
    pub fn fit_views(&self, cameras: &[usize], frame: usize) -> Result<Vec<FitView>, FootageError> {
        Ok(self.supported_views(cameras, frame, self.single_masks(cameras, frame)?))
    }

    /// The same of silhouettes that are there: a mask each of these cameras.
    pub fn supported_views(&self, cameras: &[usize], frame: usize, mut masks: Vec<Mask>) -> Vec<FitView> {
        let options = self.take().measurement();
        self.check_masks(cameras, frame, &mut masks, |place| options[cameras[place]].needs_support);
        self.views_of(cameras, masks)
    }

    fn views_of(&self, cameras: &[usize], masks: Vec<Mask>) -> Vec<FitView> {
        let view =
            |(&camera, mask): (&usize, Mask)| FitView::of_mask(Arc::clone(&self.cameras[camera]), mask);
        cameras.iter().zip(masks).map(view).collect()
    }

    /// The evidence of some cameras in a frame, each as if there were no other: for those who look for what is wrong with the cameras.
    pub fn single_views(&self, cameras: &[usize], frame: usize) -> Result<Vec<FitView>, FootageError> {
        Ok(self.views_of(cameras, self.single_masks(cameras, frame)?))
    }

    /// The silhouettes of the same.
    pub fn single_masks(&self, cameras: &[usize], frame: usize) -> Result<Vec<Mask>, FootageError> {
        let one = |&camera: &usize| {
            let picture = || Ok(Cow::Owned(self.picture(camera, frame)?));
            self.steered(camera, frame, picture, &self.take().measurement()[camera])
        };
        let masks: Vec<Result<Mask, FootageError>> = cameras.par_iter().map(one).collect();
        masks.into_iter().collect()
    }

    /// [Hides](Self::hide_unsupported) what no other camera supports in a mask each of these cameras; `needs_support` says by the place
    /// of a camera among them whether that is asked for.
    fn check_masks(
        &self,
        cameras: &[usize],
        frame: usize,
        masks: &mut [Mask],
        needs_support: impl Fn(usize) -> bool,
    ) -> Vec<usize> {
        let seen = cameras.iter().zip(masks).enumerate().map(|(place, (&camera, mask))| CheckedMask {
            camera,
            mask,
            needs_support: needs_support(place),
        });
        self.hide_unsupported(frame, seen.collect())
    }

    /// Makes unknown what no other of these cameras supports, where that is asked for; what was painted stays. How many pixels that
    /// were, in their order.
    fn hide_unsupported(&self, frame: usize, seen: Vec<CheckedMask<'_>>) -> Vec<usize> {
        if !seen.iter().any(|one| one.needs_support) {
            return vec![0; seen.len()];
        }
        let mut views: Vec<HullView<&Camera, &Mask>> = Vec::with_capacity(seen.len());
        for CheckedMask { camera, mask, .. } in &seen {
            views.push(HullView { camera: &self.cameras[*camera], silhouette: mask });
        }
        let parts = unsupported_parts(&views);
        let hide = |(one, part): (CheckedMask<'_>, UnsupportedPart)| {
            if !one.needs_support {
                return 0;
            }
            part.hide(one.mask);
            self.paint(one.camera, frame, one.mask);
            part.pixels
        };
        seen.into_iter().zip(parts).map(hide).collect()
    }

    /// What a frame of these cameras has beside its silhouettes: the take's keypoints, and grey pictures if they are asked for.
    pub fn cues(
        &self,
        cameras: &[usize],
        frame: usize,
        wants_pictures: bool,
    ) -> Result<FrameCues, FootageError> {
        let one = |&camera: &usize| -> Result<CameraCues, FootageError> {
            let picture = if wants_pictures { Some(self.picture(camera, frame)?) } else { None };
            Ok(self.camera_cues(camera, frame, picture.as_ref())?)
        };
        let cameras: Vec<Result<CameraCues, FootageError>> = cameras.par_iter().map(one).collect();
        Ok(FrameCues { cameras: cameras.into_iter().collect::<Result<_, _>>()? })
    }

    /// The same of one camera, whose [`picture`](Self::picture) this is if it is to be looked at.
    pub fn camera_cues(
        &self,
        camera: usize,
        frame: usize,
        picture: Option<&RgbImage>,
    ) -> Result<CameraCues, TakeError> {
        let keypoints = self.take().keypoint_cues(camera, frame, &self.cameras[camera])?;
        let grey = picture.and_then(|picture| GreyPicture::of_image(&grayscale(picture)).ok());
        Ok(CameraCues { keypoints, picture: grey.map(Arc::new) })
    }
}

/// A camera's silhouette that the others may be asked about.
struct CheckedMask<'a> {
    camera: usize,
    mask: &'a mut Mask,
    needs_support: bool,
}

/// The point that is nearest to all optical axes; metres in front of the camera if there is only one.
fn middle_of_view(cameras: &[Arc<Camera>]) -> glam::DVec3 {
    /// Distance from a single camera, metres.
    const BEFORE: f64 = 3.0;
    let mut nearest = NearestToLines::default();
    for camera in cameras {
        let axis = camera.axis_in_world();
        nearest.add(camera.centre(), axis, 1.0);
        // A little pull towards the point before the camera keeps parallel axes solvable.
        nearest.pull(camera.centre() + BEFORE * axis, 1e-3);
    }
    nearest.solve().unwrap_or(glam::DVec3::ZERO)
}
