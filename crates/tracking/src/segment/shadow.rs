//! Shadows and weak reflections: foreground by its brightness alone, background by everything else (6.12).
//!
//! A shadow multiplies the light by a factor r < 1 and changes neither colour nor texture. So with luma Y of the frame
//! and M of the background, r = Y / M, a pixel counts as shadow if
//!
//! - `darkest` ≤ r ≤ `brightest`,
//! - |i − r µ| ≤ `colour_tolerance` in each channel,
//! - |∇Y − r ∇M| ≤ `gradient_tolerance` along both axes (central differences).

use image::RgbImage;
use serde::{Deserialize, Serialize};

use super::background::Background;
use crate::silhouette::Label;

/// When a pixel that differs from the background is only a shadow (or a weak reflection) on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ShadowOptions {
    /// The darkest shadow, as a fraction of the background's brightness.
    pub darkest: f32,
    /// The brightest reflection, as a fraction of the background's brightness; 1 if only shadows are expected.
    pub brightest: f32,
    /// How far a channel may be off the darkened background, grey levels.
    pub colour_tolerance: f32,
    /// How far the gradient may be off that of the darkened background, grey levels per pixel.
    pub gradient_tolerance: f32,
    /// Whether shadow is unknown, not background. Safer where the subject has the colour of the floor.
    pub unknown: bool,
}

impl Default for ShadowOptions {
    fn default() -> Self {
        Self { darkest: 0.6, brightest: 1.4, colour_tolerance: 10.0, gradient_tolerance: 4.0, unknown: false }
    }
}

impl ShadowOptions {
    /// What a shadow is labelled.
    pub(super) fn label(&self) -> Label {
        if self.unknown { Label::Unknown } else { Label::Background }
    }
}

/// For each pixel whether it is foreground by its brightness alone.
pub(super) fn shadows(
    foreground: &[u8],
    frame: &RgbImage,
    background: &Background,
    gains: [f32; 3],
    options: &ShadowOptions,
) -> Vec<u8> {
    let (width, height) = (background.width(), background.height());
    let colour = |index: usize| [0, 1, 2].map(|c| f32::from(frame.as_raw()[3 * index + c]));
    let expected = |index: usize| {
        let mean = background.mean()[index];
        [0, 1, 2].map(|c| mean[c] * gains[c])
    };
    let is_shadow = |index: usize| {
        let (i, mu) = (colour(index), expected(index));
        let ratio = luma(i) / luma(mu).max(1.0);
        if !(options.darkest..=options.brightest).contains(&ratio)
            || (0..3).any(|c| (i[c] - ratio * mu[c]).abs() > options.colour_tolerance)
        {
            return false;
        }
        let (x, y) = (index % width, index / width);
        let along_x = [index - usize::from(x > 0), index + usize::from(x + 1 < width)];
        let along_y = [index - width * usize::from(y > 0), index + width * usize::from(y + 1 < height)];
        [along_x, along_y].into_iter().all(|[a, b]| {
            let difference = |at: usize| luma(colour(at)) - ratio * luma(expected(at));
            0.5 * (difference(b) - difference(a)).abs() <= options.gradient_tolerance
        })
    };
    foreground.iter().enumerate().map(|(index, &bit)| u8::from(bit == 1 && is_shadow(index))).collect()
}

/// Brightness as the eye weighs it (BT.601).
fn luma([red, green, blue]: [f32; 3]) -> f32 {
    0.299 * red + 0.587 * green + 0.114 * blue
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    /// A plate with texture; the frame is changed pixel by pixel in a block in its middle.
    fn shadow_count(change: impl Fn(u32, [f32; 3]) -> [f32; 3]) -> usize {
        let plate = RgbImage::from_fn(12, 12, |x, y| {
            let level = 100 + 12 * (((x / 2 + y / 2) % 2) as u8);
            Rgb([level, level + 20, level - 30])
        });
        let mut frame = plate.clone();
        let mut foreground = vec![0; 144];
        for (x, y, pixel) in frame.enumerate_pixels_mut() {
            if (2..10).contains(&x) && (2..10).contains(&y) {
                *pixel = Rgb(change(x + y, pixel.0.map(f32::from)).map(|level| level.round() as u8));
                foreground[(y * 12 + x) as usize] = u8::from((4..8).contains(&x) && (4..8).contains(&y));
            }
        }
        let background = Background::from_plate(&plate);
        let found = shadows(&foreground, &frame, &background, [1.0; 3], &ShadowOptions::default());
        found.iter().map(|&bit| usize::from(bit)).sum()
    }

    #[test]
    fn darkened_background_is_shadow() {
        assert_eq!(shadow_count(|_, colour| colour.map(|level| 0.7 * level)), 16);
    }

    #[test]
    fn too_dark_another_colour_or_another_texture_is_not() {
        assert_eq!(shadow_count(|_, colour| colour.map(|level| 0.4 * level)), 0);
        assert_eq!(shadow_count(|_, [r, g, b]| [0.9 * r, 0.7 * g, 0.7 * b]), 0);
        assert_eq!(
            shadow_count(|at, colour| colour.map(|level| level * if at % 4 < 2 { 0.65 } else { 0.85 })),
            0
        );
    }
}
