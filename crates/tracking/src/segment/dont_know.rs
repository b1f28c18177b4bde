//! Don't-know pixels: dark in the frame and in the background alike.
//!
//! Black shorts before a black treadmill differ from it by less than the noise, so "not foreground" says nothing there.
//! Such pixels, and those close by, become unknown: they neither pull nor push a limb.

use image::RgbImage;
use pulp::{Simd, WithSimd};

use crate::processor;
use serde::{Deserialize, Serialize};

use super::background::Background;
use super::bit_image::BitImage;

/// Where nobody can tell subject from background.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DontKnowOptions {
    /// A pixel is dark if none of its channels is brighter, grey levels.
    pub dark_level: f32,
    /// How far the dark places are grown, pixels.
    pub grow_px: usize,
    /// Foreground that differs from the background by this many deviations in some channel stays subject.
    pub sure_z: f32,
}

impl Default for DontKnowOptions {
    fn default() -> Self {
        Self { dark_level: 48.0, grow_px: 3, sure_z: 8.0 }
    }
}

/// The pixels that are dark in both, and those close by.
pub(super) fn dark_places(
    frame: &RgbImage,
    background: &Background,
    gains: [f32; 3],
    options: &DontKnowOptions,
) -> BitImage {
    let mut dark = processor::run(DarkInFrame { frame, level: options.dark_level });
    let (width, means, level) = (background.width(), background.mean(), options.dark_level);
    dark.retain(|x, y| {
        let mean = means[y * width + x];
        (0..3).all(|c| gains[c] * mean[c] <= level)
    });
    dark.dilate(options.grow_px);
    dark
}

/// The pixels of a frame none of whose channels is brighter than a level; compiled once more for wider vectors.
struct DarkInFrame<'a> {
    frame: &'a RgbImage,
    level: f32,
}

impl WithSimd for DarkInFrame<'_> {
    type Output = BitImage;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> BitImage {
        let (width, height) = (self.frame.width() as usize, self.frame.height() as usize);
        // Levels are whole numbers; a float cast rounds down and saturates.
        let level = self.level as u8;
        let (mut channels, mut pixels) = (vec![0_u8; 3 * width], vec![0_u8; width]);
        let mut dark = BitImage::empty(width, height);
        for (y, levels) in self.frame.as_raw().chunks_exact(3 * width).enumerate() {
            for (dark, &found) in channels.iter_mut().zip(levels) {
                *dark = u8::from(found <= level);
            }
            for (dark, channels) in pixels.iter_mut().zip(channels.as_chunks::<3>().0) {
                *dark = channels[0] & channels[1] & channels[2];
            }
            dark.set_row(y, &pixels);
        }
        dark
    }
}
