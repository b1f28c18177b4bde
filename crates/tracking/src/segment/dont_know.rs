//! Don't-know pixels: dark in the frame and in the background alike.
//!
//! Black shorts before a black treadmill differ from it by less than the noise, so "not foreground" says nothing there.
//! Such pixels, and those close by, become unknown: they neither pull nor push a limb.

use image::RgbImage;
use serde::{Deserialize, Serialize};

use super::background::Background;
use super::morphology;

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

/// For each pixel whether it is dark in both, or close to such a pixel.
pub(super) fn dark_places(
    frame: &RgbImage,
    background: &Background,
    gains: [f32; 3],
    options: &DontKnowOptions,
) -> Vec<u8> {
    let level = options.dark_level;
    let dark: Vec<u8> = frame
        .as_raw()
        .chunks_exact(3)
        .zip(background.mean())
        .map(|(i, mu)| {
            let dark_in_both = |c: usize| f32::from(i[c]) <= level && mu[c] * gains[c] <= level;
            u8::from(dark_in_both(0) && dark_in_both(1) && dark_in_both(2))
        })
        .collect();
    morphology::dilate(&dark, background.width(), options.grow_px)
}
