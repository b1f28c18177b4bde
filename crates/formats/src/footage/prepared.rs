//! A take with everything that is made once for all its frames: ideal cameras, rectifications, backgrounds.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use backlit_tracking::camera::{Camera, Rectification};
use backlit_tracking::segment::changes::BackgroundChange;
use backlit_tracking::segment::{
    Background, BackgroundSums, SegmentError, SegmentOptions, Segmentation, Stage, segment, segment_by_stages,
};
use backlit_tracking::silhouette::{Label, Mask};
use image::RgbImage;

use super::FootageError;
use crate::take::PlateKnowledge;
use crate::{Take, keypoints, masks};

/// Guaranteed: pictures and masks are of their camera's size, and `cameras` have no distortion.
#[derive(Debug)]
pub(super) struct PreparedTake {
    pub(super) take: Take,
    pub(super) cameras: Arc<Vec<Arc<Camera>>>,
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

impl PreparedTake {
    pub(super) fn new(take: Take) -> Self {
        let cameras = take.rig().cameras();
        let rectifications: Vec<Rectification> = cameras.iter().map(Rectification::new).collect();
        let ideal = cameras.iter().map(|camera| Arc::new(camera.without_distortion()));
        Self {
            cameras: Arc::new(ideal.collect()),
            unseen: rectifications.iter().map(Rectification::unseen).collect(),
            full_rectifications: cameras.iter().map(|_| OnceLock::new()).collect(),
            rectifications,
            backgrounds: cameras.iter().map(|_| OnceLock::new()).collect(),
            take,
        }
    }

    pub(super) fn full_picture(&self, camera: usize, frame: usize) -> Result<RgbImage, FootageError> {
        let picture = self.take.full_frame(camera, frame)?;
        let full = &self.take.full_rig().cameras()[camera];
        let rectification = self.full_rectifications[camera].get_or_init(|| Rectification::new(full));
        let rectified = rectification.rectify(&picture);
        rectified.ok_or_else(|| FootageError::Size { camera: full.name().to_owned() })
    }

    fn learnt(&self, camera: usize) -> Result<&Learnt, FootageError> {
        if let Some(learnt) = self.backgrounds.get(camera).and_then(OnceLock::get) {
            return Ok(learnt);
        }
        let mut pictures = self.take.background(camera)?.map(|picture| self.rectified(camera, &picture?));
        let name = || self.cameras[camera].name().to_owned();
        let failed = |error| FootageError::Background { camera: name(), error };
        let (mut always_subject, mut unknown) = (Vec::new(), Vec::new());
        let first = pictures.next().ok_or_else(|| FootageError::NoBackground { camera: name() })??;
        let background = if pictures.len() == 0 {
            let background = Background::from_plate(&first);
            match self.take.plate_knowledge(camera)? {
                None => background,
                Some(known) => {
                    let known = self.rectifications[camera]
                        .nearest(&known, PlateKnowledge::Scene)
                        .unwrap_or_default();
                    let those = |wanted: PlateKnowledge| {
                        let pixels = known.iter().enumerate().filter(move |(_, known)| **known == wanted);
                        pixels.map(|(index, _)| index).collect()
                    };
                    (always_subject, unknown) =
                        (those(PlateKnowledge::AlwaysSubject), those(PlateKnowledge::Nothing));
                    let is_known: Vec<bool> =
                        known.iter().map(|known| *known == PlateKnowledge::Scene).collect();
                    background.with_known(&is_known).map_err(failed)?
                }
            }
        } else {
            let mut sums = BackgroundSums::default();
            sums.add(&first).map_err(failed)?;
            drop(first);
            pictures.try_for_each(|picture| sums.add(&picture?).map_err(failed))?;
            sums.background().map_err(failed)?
        };
        Ok(self.backgrounds[camera].get_or_init(|| Learnt { background, always_subject, unknown }))
    }

    /// What a camera sees without the subject, as the take has it.
    pub(super) fn background(&self, camera: usize) -> Result<&Background, FootageError> {
        Ok(&self.learnt(camera)?.background)
    }

    pub(super) fn given_mask(&self, camera: usize, frame: usize) -> Result<Option<Mask>, FootageError> {
        let Some(shares) = self.take.mask_shares(camera, frame)? else { return Ok(None) };
        // Where the lens saw nothing the picture is black: nothing is known there.
        Ok(masks::mask_of(&self.rectified(camera, &shares)?))
    }

    pub(super) fn segmented(
        &self,
        (camera, frame): (usize, usize),
        picture: &RgbImage,
        options: &SegmentOptions,
        changes: &[BackgroundChange],
    ) -> Result<Mask, FootageError> {
        let background = self.background_of((camera, frame), changes)?;
        let mut mask =
            segment(picture, &background, options).map_err(|error| self.segment_error(camera, error))?;
        self.complete((camera, frame), changes, &mut mask)?;
        Ok(mask)
    }

    /// The same, step by step.
    pub(super) fn segmented_by_stages(
        &self,
        (camera, frame): (usize, usize),
        picture: &RgbImage,
        options: &SegmentOptions,
        changes: &[BackgroundChange],
    ) -> Result<Segmentation, FootageError> {
        let background = self.background_of((camera, frame), changes)?;
        let mut stages = segment_by_stages(picture, &background, options)
            .map_err(|error| self.segment_error(camera, error))?;
        if let Some(mut mask) = stages.mask().cloned() {
            self.complete((camera, frame), changes, &mut mask)?;
            stages.push(Stage::Take, &mask);
        }
        Ok(stages)
    }

    /// The background of a frame, with what has changed in it.
    fn background_of(
        &self,
        (camera, frame): (usize, usize),
        changes: &[BackgroundChange],
    ) -> Result<Cow<'_, Background>, FootageError> {
        let own = changes.iter().filter(|change| change.camera == camera);
        let background = &self.learnt(camera)?.background;
        Ok(background.with_changes(own, frame).map_or(Cow::Borrowed(background), Cow::Owned))
    }

    fn segment_error(&self, camera: usize, error: SegmentError) -> FootageError {
        FootageError::Segment { camera: self.cameras[camera].name().to_owned(), error }
    }

    /// Adds what is known beside the picture: pixels that are always subject, keypoints, where a change may
    /// hide the subject, what the lens does not see.
    fn complete(
        &self,
        (camera, frame): (usize, usize),
        changes: &[BackgroundChange],
        mask: &mut Mask,
    ) -> Result<(), FootageError> {
        let Learnt { always_subject, unknown, .. } = self.learnt(camera)?;
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
        let is_now = |change: &&BackgroundChange| {
            change.camera == camera && change.is_in(frame) && change.fits(labels.len())
        };
        let now = changes.iter().filter(is_now);
        for pixel in now.flat_map(|change| change.pixels.unsure()).collect::<Vec<_>>() {
            if labels[pixel] == Label::Background {
                labels[pixel] = Label::Unknown;
            }
        }
        for &pixel in &self.unseen[camera] {
            labels[pixel] = Label::Unknown;
        }
        Ok(())
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

    pub(super) fn rectified(&self, camera: usize, picture: &RgbImage) -> Result<RgbImage, FootageError> {
        self.rectifications[camera]
            .rectify(picture)
            .ok_or_else(|| FootageError::Size { camera: self.cameras[camera].name().to_owned() })
    }
}
