//! A small picture of what a camera showed, beside a copy: data with the body over it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::{FileError, images};
use backlit_ui::drawing::{PictureInput, ViewMode, compose};
use egui::{Color32, ColorImage};
use image::{DynamicImage, RgbImage, imageops};

use crate::session::prediction::Predicted;

/// Longest side, pixels: two a point of the card.
const SIDE: u32 = 224;
/// What is kept around subject and body, of the larger side of both.
const MARGIN: f64 = 0.12;
/// Darker is body.
const HALF: f32 = 127.5;

/// What a camera shows of a pose. It holds what is on the screen by reference: it is painted where there is time.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    /// What the pose predicts.
    pub(crate) predicted: Arc<Predicted>,
    pub(crate) camera: usize,
}

impl Picture {
    /// The file beside a copy.
    pub(crate) fn path_of(copy: &Path) -> PathBuf {
        copy.with_extension("png")
    }

    /// Paints it and writes it beside a copy.
    ///
    /// # Errors
    /// The file system says no.
    pub(crate) fn write(&self, copy: &Path) -> Result<(), FileError> {
        match self.paint() {
            Some(picture) => images::write_png(&Self::path_of(copy), &DynamicImage::ImageRgb8(picture)),
            None => Ok(()),
        }
    }

    /// What was written beside a copy, if it is there and can be read.
    pub(crate) fn read(copy: &Path) -> Option<ColorImage> {
        let picture = images::read(&Self::path_of(copy)).ok()?;
        let (width, height) = picture.dimensions();
        let is_ours = width > 0 && height > 0 && width.max(height) <= SIDE;
        is_ours.then(|| ColorImage::from_rgb([width as usize, height as usize], picture.as_raw()))
    }

    /// Subject and body, and a little around them; `None` if the camera has no picture.
    fn paint(&self) -> Option<RgbImage> {
        let shown = self.predicted.cameras.get(self.camera)?;
        let data = self.predicted.scene.frame.as_ref()?.cameras.get(self.camera)?;
        let frame = data.image.as_deref()?;
        let input = PictureInput {
            frame: Some(frame),
            mask: data.mask.as_deref(),
            data: shown.data.as_deref(),
            prediction: Some(&shown.prediction),
            ..PictureInput::empty([frame.width() as usize, frame.height() as usize])
        };
        let image = compose(ViewMode::Tinted, &input);
        let [width, height] = image.size;
        let [left, top, right, bottom] = around_body(&input);
        let mut part = RgbImage::new((right - left) as u32, (bottom - top) as u32);
        for (x, y, pixel) in part.enumerate_pixels_mut() {
            let at = (top + y as usize).min(height - 1) * width + (left + x as usize).min(width - 1);
            let [r, g, b, _] = image.pixels.get(at).unwrap_or(&Color32::BLACK).to_array();
            pixel.0 = [r, g, b];
        }
        let scale = f64::from(SIDE) / f64::from(part.width().max(part.height()));
        if scale >= 1.0 {
            return Some(part);
        }
        let side = |length: u32| ((f64::from(length) * scale).round() as u32).clamp(1, SIDE);
        Some(imageops::thumbnail(&part, side(part.width()), side(part.height())))
    }
}

/// Left, top, right, bottom of subject and body with a margin; the whole picture if there is neither.
fn around_body(input: &PictureInput<'_>) -> [usize; 4] {
    let [width, height] = input.size;
    let mut rect: Option<[usize; 4]> = None;
    for y in 0..height {
        for x in 0..width {
            let Some(sample) = input.sample(x, y) else { continue };
            let is_dark = |level: Option<f32>| level.is_some_and(|level| level < HALF);
            if is_dark(sample.prediction) || (!sample.is_unknown && is_dark(sample.data)) {
                let [left, top, right, bottom] = rect.unwrap_or([x, y, x, y]);
                rect = Some([left.min(x), top.min(y), right.max(x + 1), bottom.max(y + 1)]);
            }
        }
    }
    let Some([left, top, right, bottom]) = rect else { return [0, 0, width, height] };
    let margin = (MARGIN * (right - left).max(bottom - top) as f64).ceil() as usize;
    [
        left.saturating_sub(margin),
        top.saturating_sub(margin),
        (right + margin).min(width),
        (bottom + margin).min(height),
    ]
}
