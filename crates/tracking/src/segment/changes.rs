//! Backgrounds that change while a take is filmed: something is put down or taken away, a lamp is switched on, the camera is
//! knocked. `still` learns what stands still before a camera although no other camera sees it, `light` how much brighter each part
//! of a picture became. [`Background::with_changes`] is the background of a frame with all of that.

mod light;
mod still;
mod things;

use serde::{Deserialize, Serialize};

use super::background::{Background, GreyLevel, grey_of};
use super::gradient;
use super::luminance::luma;

pub use light::{LightField, LightKey, light_change};
pub use still::StillPixels;
pub use things::StandingThing;

/// What has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeKind {
    /// Something was put down, taken away or moved.
    Thing,
    /// One part of the picture became brighter than another.
    Light,
    /// The camera was knocked: the whole picture is shifted.
    Knock,
}

/// A background that was learnt again from one frame to another.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BackgroundChange {
    /// The camera, by its place in the take.
    pub camera: usize,
    /// The first frame.
    pub from: usize,
    /// The last frame; `None` where the change lasts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<usize>,
    /// What has changed.
    pub kind: ChangeKind,
    /// Of a thing or a knock: the pixels that were learnt again.
    #[serde(default)]
    pub pixels: LearntPixels,
    /// Of light: how much brighter the picture is, in the order of the frames. Between them it is interpolated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub light: Vec<LightKey>,
}

impl BackgroundChange {
    /// Whether a frame shows it.
    #[must_use]
    pub fn is_in(&self, frame: usize) -> bool {
        self.from <= frame && self.until.is_none_or(|until| frame <= until)
    }

    /// Whether it can be of a picture with this number of pixels.
    #[must_use]
    pub fn fits(&self, pixels: usize) -> bool {
        let LearntPixels { runs, levels, unsure } = &self.pixels;
        let count: usize = runs.iter().map(|&[_, length]| length as usize).sum();
        let mut all = runs.iter().chain(unsure);
        levels.len() == count && all.all(|&[first, length]| first as usize + length as usize <= pixels)
    }
}

/// Pixels of a background that were learnt again.
#[derive(Clone, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearntPixels {
    /// The first pixel of each run, counted row by row, and how many there are.
    runs: Vec<[u32; 2]>,
    /// The level of each.
    #[serde(with = "hexadecimal")]
    levels: Vec<[u8; 3]>,
    /// Of the pixels so counted, those whose level may be the subject's all the same, or hide it: likewise runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    unsure: Vec<[u32; 2]>,
}

/// Counts a pixel to the runs of those before it.
fn count(runs: &mut Vec<[u32; 2]>, pixel: usize) {
    let pixel = pixel as u32;
    match runs.last_mut() {
        Some([first, length]) if *first + *length == pixel => *length += 1,
        _ => runs.push([pixel, 1]),
    }
}

/// The pixels of some runs.
fn pixels_of(runs: &[[u32; 2]]) -> impl Iterator<Item = usize> {
    runs.iter().flat_map(|&[first, length]| (first as usize..).take(length as usize))
}

impl LearntPixels {
    /// From pixels in the order of the picture's rows, their levels, and whether they are surely not the subject.
    fn new(pixels: impl Iterator<Item = (usize, [u8; 3], bool)>) -> Self {
        let mut result = Self::default();
        for (pixel, level, is_sure) in pixels {
            count(&mut result.runs, pixel);
            if !is_sure {
                count(&mut result.unsure, pixel);
            }
            result.levels.push(level);
        }
        result
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.levels.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.levels.is_empty()
    }

    /// Each pixel, counted row by row, and its level in grey levels.
    pub fn iter(&self) -> impl Iterator<Item = (usize, [u8; 3])> + '_ {
        pixels_of(&self.runs).zip(self.levels.iter().copied())
    }

    /// Those of them that are unknown, not background, where they show their level.
    pub fn unsure(&self) -> impl Iterator<Item = usize> + '_ {
        pixels_of(&self.unsure)
    }
}

impl Background {
    /// What the camera sees without the subject in a frame, if any of these changes is in it. Changes that do not fit the picture
    /// change nothing.
    #[must_use]
    pub fn with_changes<'a>(
        &self,
        changes: impl Iterator<Item = &'a BackgroundChange>,
        frame: usize,
    ) -> Option<Self> {
        let pixels = self.width() * self.height();
        let found: Vec<&BackgroundChange> =
            changes.filter(|change| change.is_in(frame) && change.fits(pixels)).collect();
        if found.is_empty() {
            return None;
        }
        let mut result = self.clone();
        for change in &found {
            result.learn(&change.pixels);
        }
        for change in found {
            if let Some(field) = LightField::between(&change.light, frame) {
                result.brighten(&field);
            }
        }
        Some(result)
    }

    fn learn(&mut self, learnt: &LearntPixels) {
        let (width, height) = (self.width, self.height);
        let mut levels: Vec<[u8; 3]> =
            self.mean.iter().map(|mean| mean.map(|level| level.round() as u8)).collect();
        for (pixel, level) in learnt.iter() {
            levels[pixel] = level;
            self.mean[pixel] = level.map(f32::from);
            self.deviation[pixel] = [0.0; 3];
            self.grey[pixel] = GreyLevel { mean: f32::from(grey_of(level)), deviation: 0.0 };
            if let Some(unknown) = &mut self.unknown {
                unknown.fill(pixel / width, pixel % width..pixel % width + 1, false);
            }
        }
        for (pixel, _) in learnt.iter() {
            let (x, y) = (pixel % width, pixel / width);
            self.gradient_mean[pixel] = gradient::magnitude(&levels, [width, height], x, y);
            self.gradient_deviation[pixel] = [0.0; 3];
        }
    }

    fn brighten(&mut self, field: &LightField) {
        let (width, height) = (self.width, self.height);
        for y in 0..height {
            for x in 0..width {
                let gains = field.gains([x, y], [width, height]);
                let pixel = y * width + x;
                for (channel, gain) in gains.into_iter().enumerate() {
                    self.mean[pixel][channel] = (self.mean[pixel][channel] * gain).min(255.0);
                    self.gradient_mean[pixel][channel] *= gain;
                }
                let grey = &mut self.grey[pixel].mean;
                *grey = (*grey * luma(gains)).min(255.0);
            }
        }
    }
}

/// Levels as six digits a pixel.
mod hexadecimal {
    use std::fmt::Write;

    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(levels: &[[u8; 3]], serializer: S) -> Result<S::Ok, S::Error> {
        let mut text = String::with_capacity(6 * levels.len());
        for level in levels.as_flattened() {
            // Writing to a string does not fail.
            let _ = write!(text, "{level:02x}");
        }
        serializer.serialize_str(&text)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[u8; 3]>, D::Error> {
        let text = String::deserialize(deserializer)?;
        let digits: Option<Vec<u8>> = text.chars().map(|digit| Some(digit.to_digit(16)? as u8)).collect();
        let wrong = || D::Error::custom("levels of learnt pixels: expected six hexadecimal digits a pixel");
        let digits = digits.ok_or_else(wrong)?;
        let (levels, rest) = digits.as_chunks::<6>();
        if !rest.is_empty() {
            return Err(wrong());
        }
        Ok(levels.iter().map(|[a, b, c, d, e, f]| [a * 16 + b, c * 16 + d, e * 16 + f]).collect())
    }
}

#[cfg(test)]
mod tests {
    use image::{Rgb, RgbImage};

    use super::*;
    use crate::segment::{SegmentOptions, segment};
    use crate::silhouette::Label;

    fn change(pixels: LearntPixels) -> BackgroundChange {
        BackgroundChange {
            camera: 0,
            from: 5,
            until: Some(9),
            kind: ChangeKind::Thing,
            pixels,
            light: Vec::new(),
        }
    }

    #[test]
    fn a_thing_is_background_while_it_stands_and_a_body_before_it_is_subject() {
        let plate = RgbImage::from_pixel(20, 10, Rgb([120, 130, 110]));
        let thing = Rgb([200, 40, 180]);
        let pixels = (0..200).filter(|pixel| (4..12).contains(&(pixel % 20)));
        let pixels = LearntPixels::new(pixels.map(|pixel| (pixel, thing.0, pixel % 20 < 11)));
        assert_eq!(pixels.unsure().count(), 10);
        let (background, change) = (Background::from_plate(&plate), change(pixels));
        assert!(change.fits(192) && !change.fits(191) && change.pixels.len() == 80);
        let mut picture = plate.clone();
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            match (x, y) {
                (6..9, 2..8) => *pixel = Rgb([20, 30, 220]),
                (4..12, _) => *pixel = thing,
                _ => {}
            }
        }
        let options =
            SegmentOptions { opening_px: 0, closing_px: 0, min_component_px: 0, ..SegmentOptions::default() };
        for frame in [4, 5, 9, 10] {
            let changed = background.with_changes([&change].into_iter(), frame);
            assert_eq!(changed.is_some(), change.is_in(frame));
            let mask = segment(&picture, changed.as_ref().unwrap_or(&background), &options).unwrap();
            let expected = if change.is_in(frame) { 18 } else { 80 };
            assert_eq!(mask.count(Label::Subject), expected, "frame {frame}");
        }
        assert!(
            Background::from_plate(&RgbImage::new(4, 4)).with_changes([&change].into_iter(), 6).is_none()
        );
    }

    #[test]
    fn changes_are_read_as_they_were_written() {
        let pixels = [(3, [1, 2, 255], true), (4, [0, 16, 9], false), (9, [255, 0, 255], true)];
        let written = change(LearntPixels::new(pixels.into_iter()));
        let text = serde_json::to_string(&written).unwrap();
        assert_eq!(serde_json::from_str::<BackgroundChange>(&text).unwrap(), written);
        assert_eq!(written.pixels.iter().nth(1), Some((4, [0, 16, 9])));
        for wrong in ["0102f", "01020g", "010203040"] {
            let text = format!(r#"{{"runs": [[0, 1]], "levels": "{wrong}"}}"#);
            assert!(serde_json::from_str::<LearntPixels>(&text).is_err(), "{wrong}");
        }
    }
}
