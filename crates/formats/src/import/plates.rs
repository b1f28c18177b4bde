//! Backgrounds learnt from footage that never shows the scene alone, and the size to work at.

use std::path::Path;

use backlit_tracking::segment::{
    Background, LearningFrame, LearningOptions, LearntPlate, SegmentOptions, learn_plate, segment,
};
use backlit_tracking::silhouette::Label;
use image::{DynamicImage, RgbImage, Rgba, RgbaImage};

use super::{Found, FoundCamera, ImportError};
use crate::{images, keypoints};

/// Most frames that a plate is learnt from.
const MOST_FRAMES: usize = 36;
/// Fewest frames that are worth learning from.
const FEWEST_FRAMES: usize = 8;
/// Memory that the frames of one camera may take, bytes.
const MEMORY: usize = 400 << 20;
/// A person of this height in the picture is well seen, pixels: more costs time and gives next to nothing.
const WORKING_HEIGHT_PX: f64 = 200.0;
/// Pictures are reduced no further.
const MOST_REDUCTION: u32 = 16;
/// Where nobody says how tall the person is, masks are made of pictures of about this height, pixels.
const GUESSING_HEIGHT_PX: u32 = 480;

/// What was learnt of a camera.
pub(super) struct Learnt {
    pub(super) plate: LearntPlate,
    /// The person's height in the pictures, pixels.
    pub(super) person_px: Option<f64>,
}

/// Learns a camera's plate from frames that are spread over the recording. Where there are keypoints, pixels near them are
/// left out.
pub(super) fn learn(found: &Found, camera: &FoundCamera) -> Result<Learnt, ImportError> {
    let failed = |reason: String| ImportError::Background { camera: camera.camera.name().to_owned(), reason };
    let bytes = camera.camera.width() * camera.camera.height() * 4;
    let most = (MEMORY / bytes.max(1)).clamp(FEWEST_FRAMES, MOST_FRAMES).min(found.count);
    let chosen: Vec<usize> =
        (0..most).map(|k| found.first + (k * (found.count - 1)) / most.saturating_sub(1).max(1)).collect();
    let files = camera.keypoints.as_deref().map(keypoints::files_of).transpose()?.unwrap_or_default();
    let (mut pictures, mut masks, mut extents) = (Vec::new(), Vec::new(), Vec::new());
    let size = [camera.camera.width(), camera.camera.height()];
    for frame in chosen {
        pictures.push(camera.pictures.picture(frame)?);
        // The first file of keypoints belongs to the footage's first frame, whatever its number.
        let number = files.first().map(|(first, _)| first + frame as u64);
        let file = files.iter().find(|(found, _)| Some(*found) == number);
        let people = file.map(|(_, path)| keypoints::read(path)).transpose()?.unwrap_or_default();
        extents.extend(keypoints::largest_extent(&people));
        masks.push(keypoints::generous_mask(&people, size));
    }
    let frames: Vec<LearningFrame<'_>> = pictures
        .iter()
        .zip(&masks)
        .map(|(picture, mask)| LearningFrame { picture, subject: mask.as_ref() })
        .collect();
    let plate =
        learn_plate(&frames, &LearningOptions::default()).map_err(|error| failed(error.to_string()))?;
    extents.sort_by(f64::total_cmp);
    let person_px = match extents.get(extents.len() / 2) {
        Some(&extent) => Some(extent),
        None => pictures.get(pictures.len() / 2).and_then(|picture| person_in(picture, &plate)),
    };
    Ok(Learnt { plate, person_px })
}

/// The height of the largest thing in a picture that is not in the plate, pixels of the picture.
fn person_in(picture: &RgbImage, plate: &LearntPlate) -> Option<f64> {
    let divisor = (picture.height() / GUESSING_HEIGHT_PX).max(1) as usize;
    let small = |picture: &RgbImage| images::reduced(picture.clone(), divisor);
    let background = Background::from_plate(&small(&plate.picture));
    let mask = segment(&small(picture), &background, &SegmentOptions::default()).ok()?;
    let rows = mask.labels().chunks_exact(mask.width());
    let tall = rows.filter(|row| row.iter().filter(|&&label| label == Label::Subject).count() > 1).count();
    (tall > 0).then(|| (tall * divisor) as f64)
}

/// By how much pictures are reduced before anything is done with them: the person stays tall enough.
pub(super) fn reduction(person_px: &[Option<f64>], smallest_side: usize) -> u32 {
    let mut heights: Vec<f64> = person_px.iter().copied().flatten().collect();
    heights.sort_by(f64::total_cmp);
    let Some(&height) = heights.get(heights.len() / 2) else { return 1 };
    let most = MOST_REDUCTION.min((smallest_side / 64).max(1) as u32);
    ((height / WORKING_HEIGHT_PX) as u32).clamp(1, most)
}

/// Writes a plate whose unknown pixels are transparent.
pub(super) fn write(path: &Path, plate: &LearntPlate) -> Result<(), ImportError> {
    let mut picture = RgbaImage::new(plate.picture.width(), plate.picture.height());
    for ((pixel, seen), known) in picture.pixels_mut().zip(plate.picture.pixels()).zip(&plate.known) {
        let [r, g, b] = seen.0;
        *pixel = Rgba([r, g, b, if *known { 255 } else { 0 }]);
    }
    Ok(images::write_png(path, &DynamicImage::ImageRgba8(picture))?)
}
