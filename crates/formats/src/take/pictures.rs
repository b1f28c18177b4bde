//! A take's pictures: frames, backgrounds and masks made elsewhere, reduced and not rectified.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_tracking::camera::Camera;
use image::{RgbImage, imageops};

use super::{BackgroundSource, CameraFootage, PlateKnowledge, Take, TakeError};
use crate::images::{self, MAX_PICTURE_BYTES};
use crate::masks::{self, MaskSequence, MaskValues};
use crate::video::Video;
use crate::{FileError, FileProblem, Result, TakeFiles};

impl Take {
    /// A camera's picture of a frame (counted from 0), [reduced](Self::reduction) and not rectified.
    pub fn frame(&self, camera: usize, frame: usize) -> Result<RgbImage, TakeError> {
        self.frame_reduced(camera, frame, self.reduction as usize)
    }

    /// A camera's picture of a frame (counted from 0), as it is on the disk: not reduced and not rectified.
    pub fn full_frame(&self, camera: usize, frame: usize) -> Result<RgbImage, TakeError> {
        self.frame_reduced(camera, frame, 1)
    }

    /// The same at a part of its size: each square of `divisor`² pixels is averaged to one. Columns at the right and
    /// rows at the bottom that fill no square are left out.
    pub fn frame_reduced(&self, camera: usize, frame: usize, divisor: usize) -> Result<RgbImage, TakeError> {
        let footage = self.footage_of(camera)?;
        if frame >= self.frame_count {
            return Err(TakeError::NoFrame { frame, count: self.frame_count });
        }
        if footage.is_masks_alone() {
            return Ok(masks::drawn(&self.shares_reduced(camera, frame, divisor)?));
        }
        let picture = self.numbered(camera, footage, footage.number(frame), divisor);
        picture.map_err(|error| TakeError::Frame { camera: footage.camera.clone(), frame, error })
    }

    /// What a camera shows `shift` of its own frames later than in a frame of the take, also before the first frame and after
    /// the last one that all cameras have; as large as [`frame_reduced`](Self::frame_reduced) has it. `None` where the camera
    /// has no such picture.
    pub fn shifted_frame(
        &self,
        camera: usize,
        frame: usize,
        shift: i64,
        divisor: usize,
    ) -> Result<Option<RgbImage>, TakeError> {
        let footage = self.footage_of(camera)?;
        let Some(number) = footage.number(frame).checked_add_signed(shift) else { return Ok(None) };
        let has_it = match footage.video() {
            Some(video) => number < video.frame_count() as u64,
            None => self.files.exists(&footage.frames.path(number)),
        };
        if !has_it || footage.is_masks_alone() {
            return Ok(None);
        }
        let picture = self.numbered(camera, footage, number, divisor);
        picture.map(Some).map_err(|error| TakeError::Frame { camera: footage.camera.clone(), frame, error })
    }

    /// The picture of a camera's own number.
    fn numbered(
        &self,
        camera: usize,
        footage: &CameraFootage,
        number: u64,
        divisor: usize,
    ) -> Result<RgbImage> {
        match footage.video() {
            Some(video) => self.video_frame(camera, video, number as usize, divisor),
            None => {
                let picture = self.picture(camera, &footage.frames.path(number))?;
                Ok(images::reduced(picture, divisor))
            }
        }
    }

    /// What the numbers of a camera's masks mean; `None` for a camera without any. Where the take does not say it, masks
    /// that are spread over the take are looked at, once.
    pub fn mask_values(&self, camera: usize) -> Result<Option<&MaskValues>, TakeError> {
        let footage = self.footage_of(camera)?;
        let Some(own) = &footage.masks else { return Ok(None) };
        if let Some(told) = own.told.get() {
            return Ok(Some(told));
        }
        let source = MaskSequence {
            count: self.frame_count,
            path: &|frame| own.path(footage.number(frame)),
            read: &|frame| own.read(self.files.as_ref(), footage.number(frame), &self.check_mask(camera)),
        };
        let told = masks::values_of(own.given.as_ref(), &source);
        let told = told.map_err(|(frame, error)| footage.mask_error(frame, error))?;
        Ok(Some(own.told.get_or_init(|| told)))
    }

    /// A camera's mask of a frame, [reduced](Self::reduction) and not rectified, as [shares](masks::shares). `None` for a
    /// camera without masks.
    pub(crate) fn mask_shares(&self, camera: usize, frame: usize) -> Result<Option<RgbImage>, TakeError> {
        if !self.footage_of(camera)?.has_masks() {
            return Ok(None);
        }
        if frame >= self.frame_count {
            return Err(TakeError::NoFrame { frame, count: self.frame_count });
        }
        self.shares_reduced(camera, frame, self.reduction as usize).map(Some)
    }

    /// The shares of a frame's mask at a part of the pictures' size.
    fn shares_reduced(&self, camera: usize, frame: usize, divisor: usize) -> Result<RgbImage, TakeError> {
        let footage = self.footage_of(camera)?;
        let (Some(own), Some(values)) = (&footage.masks, self.mask_values(camera)?) else {
            return Ok(RgbImage::default());
        };
        let numbers = own.read(self.files.as_ref(), footage.number(frame), &self.check_mask(camera));
        let numbers = numbers.map_err(|error| footage.mask_error(frame, error))?;
        let shares = masks::shares(&numbers, values);
        let full = &self.full_rig.cameras()[camera];
        if numbers.size == [full.width(), full.height()] {
            return Ok(images::reduced(shares, divisor));
        }
        if divisor == self.reduction as usize {
            return Ok(shares);
        }
        // A mask that is reduced already, for a picture of another size.
        let side = |side: usize| (side / divisor.max(1)).max(1) as u32;
        let (width, height) = (side(full.width()), side(full.height()));
        Ok(imageops::resize(&shares, width, height, imageops::FilterType::Nearest))
    }

    /// Masks are of the pictures' size, or reduced already.
    fn check_mask(&self, camera: usize) -> impl Fn(&Path, [usize; 2]) -> Result<()> {
        let (full, small) = (&self.full_rig.cameras()[camera], &self.rig.cameras()[camera]);
        move |path, found| check_size(path, found, small).or_else(|_| check_size(path, found, full))
    }

    /// A camera's pictures without the subject: one plate or several frames, none if the take has none. Reduced and
    /// not rectified. Each is decoded when it is asked for.
    pub fn background(
        &self,
        camera: usize,
    ) -> Result<impl ExactSizeIterator<Item = Result<RgbImage, TakeError>>, TakeError> {
        let footage = self.footage_of(camera)?;
        let source = footage.background.as_ref();
        let count = source.map_or(0, BackgroundSource::count);
        let picture = move |index: usize| match source {
            Some(BackgroundSource::Plate(path)) => self.plate(camera, path),
            Some(BackgroundSource::Frames(paths)) => self.plate(camera, &paths[index]),
            Some(BackgroundSource::Video { video, frames }) => {
                self.video_frame(camera, video, frames[index], self.reduction as usize)
            }
            None => Ok(RgbImage::default()),
        };
        let failed = |error| TakeError::Background { camera: footage.camera.clone(), error };
        Ok((0..count).map(move |index| picture(index).map_err(failed)))
    }

    /// The same take with these plates in the place of its own, by camera; the other cameras keep theirs. A plate that is not there,
    /// or is of another size, is told when it is read.
    #[must_use]
    pub fn with_plates(&self, plates: &BTreeMap<usize, PathBuf>) -> Self {
        let mut take = self.clone();
        for (camera, footage) in take.footage.iter_mut().enumerate() {
            if let Some(path) = plates.get(&camera) {
                footage.background = Some(BackgroundSource::Plate(path.clone()));
            }
        }
        take
    }

    /// What a camera's reduced plate knows of each pixel, row by row. `None` where it knows all.
    pub fn plate_knowledge(&self, camera: usize) -> Result<Option<Vec<PlateKnowledge>>, TakeError> {
        let footage = self.footage_of(camera)?;
        let Some(BackgroundSource::Plate(path)) = &footage.background else { return Ok(None) };
        let alpha = self.files.read(path, MAX_PICTURE_BYTES).and_then(|bytes| images::alpha(path, &bytes));
        let alpha = alpha.map_err(|error| TakeError::Background { camera: footage.camera.clone(), error })?;
        let Some(alpha) = alpha.filter(|alpha| alpha.iter().any(|&alpha| alpha < PlateKnowledge::OPAQUE))
        else {
            return Ok(None);
        };
        let (full, small) = (&self.full_rig.cameras()[camera], &self.rig.cameras()[camera]);
        if alpha.len() == small.width() * small.height() {
            return Ok(Some(alpha.into_iter().map(PlateKnowledge::of_alpha).collect()));
        }
        // Of the pixels that are averaged to one, the least known counts.
        let (side, width) = (self.reduction as usize, small.width());
        let mut out = vec![PlateKnowledge::Scene; width * small.height()];
        for (index, &alpha) in alpha.iter().enumerate() {
            let (x, y) = (index % full.width() / side, index / full.width() / side);
            if x < width && y < small.height() {
                let worst = &mut out[y * width + x];
                *worst = (*worst).min(PlateKnowledge::of_alpha(alpha));
            }
        }
        Ok(Some(out))
    }

    pub(super) fn footage_of(&self, camera: usize) -> Result<&CameraFootage, TakeError> {
        self.footage.get(camera).ok_or(TakeError::NoCamera { camera, count: self.footage.len() })
    }

    fn picture(&self, camera: usize, path: &Path) -> Result<RgbImage> {
        let full = &self.full_rig.cameras()[camera];
        images::decode(path, &sized(&*self.files, path, &|path, found| check_size(path, found, full))?)
    }

    /// A picture of a background, of the full size or of the reduced one already, reduced.
    fn plate(&self, camera: usize, path: &Path) -> Result<RgbImage> {
        let bytes = self.files.read(path, MAX_PICTURE_BYTES)?;
        let found = images::size(path, &bytes)?;
        if check_size(path, found, &self.rig.cameras()[camera]).is_ok() {
            return images::decode(path, &bytes);
        }
        check_size(path, found, &self.full_rig.cameras()[camera])?;
        Ok(images::reduced(images::decode(path, &bytes)?, self.reduction as usize))
    }

    fn video_frame(&self, camera: usize, video: &Video, frame: usize, divisor: usize) -> Result<RgbImage> {
        check_size(video.path(), video.size(), &self.full_rig.cameras()[camera])?;
        video.frame_reduced(frame, divisor).map(Arc::unwrap_or_clone)
    }

    pub(super) fn check_first_picture(&self, camera: usize) -> Result<(), TakeError> {
        let footage = &self.footage[camera];
        if let Some(own) = &footage.masks {
            own.check_size(self.files.as_ref(), footage.number(0), &self.check_mask(camera))
                .map_err(|error| footage.mask_error(0, error))?;
        }
        if footage.is_masks_alone() {
            return Ok(());
        }
        let path = footage.path(0);
        let check = |path: &Path, found| check_size(path, found, &self.full_rig.cameras()[camera]);
        let checked = match footage.video() {
            Some(video) => check(&path, video.size()),
            None => sized(&*self.files, &path, &check).map(drop),
        };
        checked.map_err(|error| TakeError::Frame { camera: footage.camera.clone(), frame: 0, error })
    }
}

/// Asked whether the size of a file's picture is right.
pub(super) type SizeCheck<'a> = dyn Fn(&Path, [usize; 2]) -> Result<()> + 'a;

/// The bytes of a picture of the right size: a wrong one need not be decoded.
pub(super) fn sized(files: &dyn TakeFiles, path: &Path, check: &SizeCheck<'_>) -> Result<Vec<u8>> {
    let bytes = files.read(path, MAX_PICTURE_BYTES)?;
    check(path, images::size(path, &bytes)?)?;
    Ok(bytes)
}

fn check_size(path: &Path, found: [usize; 2], camera: &Camera) -> Result<()> {
    let expected = [camera.width(), camera.height()];
    if found == expected {
        return Ok(());
    }
    Err(FileError::new(path, FileProblem::PictureSize { found, expected }))
}
