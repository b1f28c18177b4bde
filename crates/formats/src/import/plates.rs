//! Backgrounds learnt from footage that never shows the scene alone, and the size to work at.

use std::path::PathBuf;

use backlit_tracking::body_fit::survey::spread_numbers;
use backlit_tracking::segment::{Background, LearningFrame, LearningOptions, SegmentOptions, segment};
use backlit_tracking::silhouette::{Label, Mask};
use image::RgbImage;

use super::{ImportCamera, ImportError, ImportSurvey};
use crate::keypoints::{self, Person};
use crate::memory;
use crate::plate::{Covered, MOST_FRAMES, Plate};

/// Frames that tell how tall the person is in the picture.
const GUESSING_FRAMES: usize = 12;
/// A person of this height in the picture is well seen, pixels: more costs time and gives next to nothing.
const WORKING_HEIGHT_PX: f64 = 200.0;
/// Pictures are reduced no further.
const MOST_REDUCTION: usize = 16;
/// Where the person's height is unknown, masks are made of pictures of about this height, pixels.
const GUESSING_HEIGHT_PX: usize = 480;
/// No side of a reduced picture is shorter, pixels.
const SHORTEST_SIDE: usize = 64;

/// Frames that are spread over the recording.
pub(super) fn spread(found: &ImportSurvey, most: usize) -> Vec<usize> {
    spread_numbers(found.count, most).map(|frame| found.first + frame).collect()
}

/// A camera's people in a frame.
pub(super) struct Keypoints(Vec<(u64, PathBuf)>);

impl Keypoints {
    pub(super) fn of(camera: &ImportCamera) -> Result<Self, ImportError> {
        Ok(Self(camera.keypoints.as_deref().map(keypoints::files_of).transpose()?.unwrap_or_default()))
    }

    /// The first file belongs to the footage's first frame, whatever its number.
    pub(super) fn people(&self, frame: usize) -> Result<Vec<Person>, ImportError> {
        let Some((first, _)) = self.0.first() else { return Ok(Vec::new()) };
        let file = self.0.iter().find(|(number, _)| *number == first + frame as u64);
        Ok(file.map(|(_, path)| keypoints::read(path)).transpose()?.unwrap_or_default())
    }
}

/// By how much pictures are reduced before anything is done with them: the person stays tall enough in all of them.
pub(super) fn reduction(found: &ImportSurvey) -> Result<usize, ImportError> {
    let mut heights = Vec::new();
    for camera in &found.cameras {
        heights.extend(person_px(found, camera)?);
    }
    heights.sort_by(f64::total_cmp);
    let sides = found.cameras.iter().map(|camera| camera.camera.width().min(camera.camera.height()));
    let most = MOST_REDUCTION.min(sides.min().unwrap_or(1) / SHORTEST_SIDE).max(1);
    let height = heights.get(heights.len() / 2).copied().unwrap_or(0.0);
    Ok(((height / WORKING_HEIGHT_PX).round() as usize).clamp(1, most))
}

/// The person's height in a camera's pictures, pixels: by keypoints, else by what moves.
fn person_px(found: &ImportSurvey, camera: &ImportCamera) -> Result<Option<f64>, ImportError> {
    let frames = spread(found, GUESSING_FRAMES);
    let keypoints = Keypoints::of(camera)?;
    let mut extents = Vec::new();
    for &frame in &frames {
        extents.extend(keypoints::largest_extent(&keypoints.people(frame)?));
    }
    extents.sort_by(f64::total_cmp);
    if let Some(&extent) = extents.get(extents.len() / 2) {
        return Ok(Some(extent));
    }
    if let Some(masks) = &camera.masks {
        return masks.person_px(&frames);
    }
    let divisor = (camera.camera.height() / GUESSING_HEIGHT_PX).max(1);
    let (plate, picture) = learn_from(camera, &frames, &keypoints, divisor)?;
    let background = Background::from_plate(&plate.picture);
    let Ok(mask) = segment(&picture, &background, &SegmentOptions::default()) else { return Ok(None) };
    Ok(height_px(&mask).map(|tall| tall * divisor as f64))
}

/// Number of rows with more than one subject pixel; `None` for an empty mask.
pub(super) fn height_px(mask: &Mask) -> Option<f64> {
    let rows = mask.labels().chunks_exact(mask.width());
    let tall = rows.filter(|row| row.iter().filter(|&&label| label == Label::Subject).count() > 1).count();
    (tall > 0).then_some(tall as f64)
}

/// Learns a camera's plate, reduced, from frames that are spread over the recording. Where there are keypoints, pixels near them
/// are left out.
pub(super) fn learn(
    found: &ImportSurvey,
    camera: &ImportCamera,
    divisor: usize,
) -> Result<Plate, ImportError> {
    let pixels = camera.camera.width() * camera.camera.height() / divisor.pow(2);
    let frames = spread(found, memory::held(pixels, MOST_FRAMES));
    Ok(learn_from(camera, &frames, &Keypoints::of(camera)?, divisor)?.0)
}

/// The plate, and the picture of the frame in the middle.
fn learn_from(
    camera: &ImportCamera,
    frames: &[usize],
    keypoints: &Keypoints,
    divisor: usize,
) -> Result<(Plate, RgbImage), ImportError> {
    let (mut pictures, mut masks) = (Vec::new(), Vec::new());
    let mut sure = Covered::default();
    let size = [camera.camera.width(), camera.camera.height()];
    for &frame in frames {
        pictures.push(camera.pictures.reduced(frame, divisor)?);
        let people = keypoints.people(frame)?;
        masks.push(keypoints::generous_mask(&people, size, divisor));
        if let Some(mask) = keypoints::sure_mask(&people, size, divisor) {
            sure.add(mask.labels().iter().map(|label| *label == Label::Subject));
        }
    }
    let frames: Vec<LearningFrame<'_>> = pictures
        .iter()
        .zip(&masks)
        .map(|(picture, mask)| LearningFrame { picture, subject: mask.as_ref() })
        .collect();
    let plate = Plate::learn(&frames, &LearningOptions::default(), &sure).map_err(|error| {
        ImportError::Background { camera: camera.camera.name().to_owned(), reason: error.to_string() }
    })?;
    let middle = pictures.len() / 2;
    Ok((plate, pictures.swap_remove(middle)))
}
