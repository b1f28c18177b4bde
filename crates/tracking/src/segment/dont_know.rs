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
    let row = 3 * background.width();
    let row_gains = gains.repeat(background.width());
    let mut channels = vec![0_u8; row];
    let mut dark = Vec::with_capacity(background.mean().len());
    let level = options.dark_level;
    for (i, mu) in frame.as_raw().chunks_exact(row).zip(background.mean().as_flattened().chunks_exact(row)) {
        for (((dark, &i), &mu), &gain) in channels.iter_mut().zip(i).zip(mu).zip(&row_gains) {
            *dark = u8::from(f32::from(i) <= level) & u8::from(gain * mu <= level);
        }
        dark.extend(channels.chunks_exact(3).map(|dark| dark[0] & dark[1] & dark[2]));
    }
    morphology::dilate(&dark, background.width(), options.grow_px)
}
