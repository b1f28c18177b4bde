//! How silhouettes come about, and what they would be with other options.

use backlit_tracking::fit::FitView;
use backlit_tracking::segment::{SegmentOptions, Segmentation, Stage};
use backlit_tracking::silhouette::Mask;
use image::RgbImage;
use rayon::prelude::*;

use super::{Footage, FootageError};

/// What the cameras of a frame see by some options.
#[derive(Debug)]
pub struct TriedViews {
    /// A view each camera.
    pub views: Vec<FitView>,
    /// How many subject pixels no other camera supports, by camera.
    pub unsupported_px: Vec<usize>,
}

impl Footage {
    /// How the silhouette of a camera's frame comes about from its [`picture`](Self::picture), step by step. `last` is the
    /// silhouette in the end, which other cameras have been asked about. `None` where it was not made of the picture.
    ///
    /// # Errors
    /// Those of [`mask`](Self::mask).
    pub fn stages(
        &self,
        camera: usize,
        frame: usize,
        picture: &RgbImage,
        options: &SegmentOptions,
        last: Option<&Mask>,
    ) -> Result<Option<Segmentation>, FootageError> {
        let is_own = self.masks.get(&frame).is_some_and(|masks| masks.contains_key(&camera));
        if is_own || self.drawn.is_some() || self.given_mask(camera, frame)?.is_some() {
            return Ok(None);
        }
        let mut stages =
            self.prepared.segmented_by_stages((camera, frame), picture, options, &self.changes)?;
        if let Some(mut mask) = stages.mask().cloned() {
            self.hide_people(camera, frame, &mut mask);
            stages.push(Stage::People, &mask);
            self.paint(camera, frame, &mut mask);
            stages.push(Stage::Brush, &mask);
        }
        last.into_iter().for_each(|last| stages.push(Stage::OtherCameras, last));
        Ok(Some(stages))
    }

    /// What cameras would see of a frame with other options, from their [pictures](Self::picture): options and a picture each camera.
    ///
    /// # Errors
    /// Those of [`mask`](Self::mask).
    pub fn tried_views(
        &self,
        cameras: &[usize],
        frame: usize,
        pictures: &[RgbImage],
        options: &[SegmentOptions],
    ) -> Result<TriedViews, FootageError> {
        let tried: Vec<_> = cameras.iter().zip(pictures).zip(options).collect();
        let one = |((camera, picture), options): &((&usize, &RgbImage), &SegmentOptions)| {
            self.mask(**camera, frame, picture, options)
        };
        let masks: Result<Vec<Mask>, FootageError> = tried.par_iter().map(one).collect();
        let mut masks = masks?;
        let unsupported_px =
            self.check_masks(cameras, frame, &mut masks, |place| options[place].needs_support);
        Ok(TriedViews { views: self.views_of(cameras, masks), unsupported_px })
    }

    /// Makes pixels of other people than the one who is followed unknown.
    pub(super) fn hide_people(&self, camera: usize, frame: usize, mask: &mut Mask) {
        if let Some(person) = self.take().person() {
            person.hide_others(&self.cameras[camera], frame, mask);
        }
    }
}
