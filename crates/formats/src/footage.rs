//! A take's pictures as everything else wants them: on the ideal pinhole grid, with their silhouettes.

use std::sync::{Arc, OnceLock};

use backlit_tracking::camera::{Camera, Rectification};
use backlit_tracking::cues::{CameraCues, FrameCues, GreyPicture};
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::segment::{Background, BackgroundError, SegmentError, SegmentOptions, segment};
use backlit_tracking::silhouette::{Label, Mask};
use image::RgbImage;
use image::imageops::grayscale;
use rayon::prelude::*;
use thiserror::Error;

use super::take::Known;
use super::{Take, TakeError, keypoints, masks};

/// A take with everything that is made once for all its frames: ideal cameras, rectifications, backgrounds.
///
/// Guaranteed: pictures and masks are of their camera's size, and [`cameras`](Self::cameras) have no distortion.
#[derive(Debug)]
pub struct Footage {
    take: Take,
    cameras: Vec<Arc<Camera>>,
    rectifications: Vec<Rectification>,
    /// The same for pictures at their full size, made when one is asked for.
    full_rectifications: Vec<OnceLock<Rectification>>,
    /// Pixels of every camera that its lens does not see.
    unseen: Vec<Vec<usize>>,
    backgrounds: Vec<OnceLock<Learnt>>,
}

/// A background, and the pixels that the subject covers in every frame.
#[derive(Debug)]
struct Learnt {
    background: Background,
    always_subject: Vec<usize>,
    /// Pixels of which neither the background nor the subject is known.
    unknown: Vec<usize>,
}

/// Why a picture or a silhouette cannot be had.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum FootageError {
    #[error(transparent)]
    Take(#[from] TakeError),
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
    #[must_use]
    pub fn new(take: Take) -> Self {
        let cameras = take.rig().cameras();
        let rectifications: Vec<Rectification> = cameras.iter().map(Rectification::new).collect();
        Self {
            cameras: cameras.iter().map(|camera| Arc::new(camera.without_distortion())).collect(),
            unseen: rectifications.iter().map(Rectification::unseen).collect(),
            full_rectifications: cameras.iter().map(|_| OnceLock::new()).collect(),
            rectifications,
            backgrounds: cameras.iter().map(|_| OnceLock::new()).collect(),
            take,
        }
    }

    /// The take itself.
    #[must_use]
    pub fn take(&self) -> &Take {
        &self.take
    }

    /// The cameras of the pictures: without distortion, in the take's order.
    #[must_use]
    pub fn cameras(&self) -> &[Arc<Camera>] {
        &self.cameras
    }

    /// A camera's picture of a frame, on the ideal grid.
    ///
    /// # Errors
    /// No such camera or frame, or the picture cannot be read; the message names file and frame.
    pub fn picture(&self, camera: usize, frame: usize) -> Result<RgbImage, FootageError> {
        let picture = self.take.frame(camera, frame)?;
        self.rectified(camera, &picture)
    }

    /// The same as large as it is on the disk: on the ideal grid of the camera at its full size, whose pixels are the
    /// [reduction](Take::reduction) times as many on each side.
    pub fn full_picture(&self, camera: usize, frame: usize) -> Result<RgbImage, FootageError> {
        let picture = self.take.full_frame(camera, frame)?;
        let full = &self.take.full_rig().cameras()[camera];
        let rectification = self.full_rectifications[camera].get_or_init(|| Rectification::new(full));
        let rectified = rectification.rectify(&picture);
        rectified.ok_or_else(|| FootageError::Size { camera: full.name().to_owned() })
    }

    /// What a camera sees without the subject, on the ideal grid.
    ///
    /// # Errors
    /// No such camera, no background in the take, or it cannot be read.
    pub fn background(&self, camera: usize) -> Result<&Background, FootageError> {
        Ok(&self.learnt(camera)?.background)
    }

    fn learnt(&self, camera: usize) -> Result<&Learnt, FootageError> {
        if let Some(learnt) = self.backgrounds.get(camera).and_then(OnceLock::get) {
            return Ok(learnt);
        }
        let pictures = self.take.background(camera)?;
        let name = || self.cameras[camera].name().to_owned();
        let pictures: Vec<RgbImage> =
            pictures.iter().map(|picture| self.rectified(camera, picture)).collect::<Result<_, _>>()?;
        let failed = |error| FootageError::Background { camera: name(), error };
        let (mut always_subject, mut unknown) = (Vec::new(), Vec::new());
        let background = match pictures.as_slice() {
            [] => return Err(FootageError::NoBackground { camera: name() }),
            [plate] => {
                let background = Background::from_plate(plate);
                match self.take.plate_knowledge(camera)? {
                    None => background,
                    Some(known) => {
                        let known =
                            self.rectifications[camera].nearest(&known, Known::Scene).unwrap_or_default();
                        let those = |wanted: Known| {
                            let pixels = known.iter().enumerate().filter(move |(_, known)| **known == wanted);
                            pixels.map(|(index, _)| index).collect()
                        };
                        (always_subject, unknown) = (those(Known::AlwaysSubject), those(Known::Nothing));
                        let is_known: Vec<bool> = known.iter().map(|known| *known == Known::Scene).collect();
                        background.with_known(&is_known).map_err(failed)?
                    }
                }
            }
            frames => Background::from_frames(frames).map_err(failed)?,
        };
        Ok(self.backgrounds[camera].get_or_init(|| Learnt { background, always_subject, unknown }))
    }

    /// The silhouette of a frame whose [`picture`](Self::picture) this is: the one that was [made elsewhere](Self::given_mask),
    /// else the picture is segmented by these options. Where the lens saw nothing it is unknown.
    pub fn mask(
        &self,
        camera: usize,
        frame: usize,
        picture: &RgbImage,
        options: &SegmentOptions,
    ) -> Result<Mask, FootageError> {
        match self.given_mask(camera, frame)? {
            Some(mask) => Ok(mask),
            None => self.segmented(camera, frame, picture, options),
        }
    }

    /// The silhouette of a frame that the take has from elsewhere, on the ideal grid; `None` for a camera without masks. It is
    /// reduced and rectified by area before it is decided which pixels are subject.
    ///
    /// # Errors
    /// No such camera or frame, or the mask cannot be read or understood; the message names file and frame.
    pub fn given_mask(&self, camera: usize, frame: usize) -> Result<Option<Mask>, FootageError> {
        let Some(shares) = self.take.mask_shares(camera, frame)? else { return Ok(None) };
        // Where the lens saw nothing the picture is black: nothing is known there.
        Ok(masks::mask_of(&self.rectified(camera, &shares)?))
    }

    fn segmented(
        &self,
        camera: usize,
        frame: usize,
        picture: &RgbImage,
        options: &SegmentOptions,
    ) -> Result<Mask, FootageError> {
        let Learnt { background, always_subject, unknown } = self.learnt(camera)?;
        let mut mask = segment(picture, background, options).map_err(|error| FootageError::Segment {
            camera: self.cameras[camera].name().to_owned(),
            error,
        })?;
        let labels = mask.labels_mut();
        for &pixel in always_subject {
            labels[pixel] = Label::Subject;
        }
        if !unknown.is_empty()
            && let Some(coarse) = self.by_keypoints(camera, frame)?
        {
            for &pixel in unknown {
                labels[pixel] = coarse[pixel];
            }
        }
        for &pixel in &self.unseen[camera] {
            labels[pixel] = Label::Unknown;
        }
        Ok(mask)
    }

    /// What keypoints tell of the silhouette, on the ideal grid; `None` without any.
    fn by_keypoints(&self, camera: usize, frame: usize) -> Result<Option<Vec<Label>>, FootageError> {
        let full = &self.take.full_rig().cameras()[camera];
        let size = [full.width(), full.height()];
        let people = self.take.people(camera, frame)?;
        let order = self.take.keypoint_order()?;
        let coarse = keypoints::coarse_mask(&people, order, size, self.take.reduction() as usize);
        Ok(coarse.and_then(|mask| self.rectifications[camera].nearest(mask.labels(), Label::Unknown)))
    }

    /// The evidence of some cameras in a frame, by the take's own measurement settings. Cameras are shared out
    /// among threads; the result does not depend on how.
    ///
    /// # Errors
    /// The first camera's, in the order asked for, whose picture or silhouette cannot be had.
    pub fn fit_views(&self, cameras: &[usize], frame: usize) -> Result<Vec<FitView>, FootageError> {
        let one = |&camera: &usize| {
            let mask = match self.given_mask(camera, frame)? {
                Some(mask) => mask,
                None => {
                    let picture = self.picture(camera, frame)?;
                    self.segmented(camera, frame, &picture, &self.take.measurement()[camera])?
                }
            };
            let evidence = Evidence::Mask(Arc::new(mask));
            Ok(FitView { camera: Arc::clone(&self.cameras[camera]), evidence, weight: 1.0 })
        };
        let views: Vec<Result<FitView, FootageError>> = cameras.par_iter().map(one).collect();
        views.into_iter().collect()
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
    ///
    /// # Errors
    /// A file that is not one of keypoints.
    pub fn camera_cues(
        &self,
        camera: usize,
        frame: usize,
        picture: Option<&RgbImage>,
    ) -> Result<CameraCues, TakeError> {
        let keypoints = self.take.keypoint_cues(camera, frame, &self.cameras[camera])?;
        let grey = picture.and_then(|picture| GreyPicture::of_image(&grayscale(picture)).ok());
        Ok(CameraCues { keypoints, picture: grey.map(Arc::new) })
    }

    fn rectified(&self, camera: usize, picture: &RgbImage) -> Result<RgbImage, FootageError> {
        self.rectifications[camera]
            .rectify(picture)
            .ok_or_else(|| FootageError::Size { camera: self.cameras[camera].name().to_owned() })
    }
}
