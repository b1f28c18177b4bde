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
use super::bit_image::BitImage;
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

/// Clears the foreground that is so by its brightness alone, pixel by pixel; `on_shadow` hears of each by its index.
pub(super) fn clear_shadows(
    foreground: &mut BitImage,
    frame: &RgbImage,
    background: &Background,
    gains: [f32; 3],
    options: &ShadowOptions,
    mut on_shadow: impl FnMut(usize),
) {
    let (width, height) = (background.width(), background.height());
    let (levels, means) = (frame.as_raw().as_chunks::<3>().0, background.mean());
    let colour = |index: usize| levels[index].map(f32::from);
    let expected = |index: usize| {
        let mean = means[index];
        [0, 1, 2].map(|c| mean[c] * gains[c])
    };
    let is_shadow = |x: usize, y: usize| {
        let index = y * width + x;
        let (i, mu) = (colour(index), expected(index));
        let ratio = luma(i) / luma(mu).max(1.0);
        if !(options.darkest..=options.brightest).contains(&ratio)
            || (0..3).any(|c| (i[c] - ratio * mu[c]).abs() > options.colour_tolerance)
        {
            return false;
        }
        let along_x = [index - usize::from(x > 0), index + usize::from(x + 1 < width)];
        let along_y = [index - width * usize::from(y > 0), index + width * usize::from(y + 1 < height)];
        [along_x, along_y].into_iter().all(|[a, b]| {
            let difference = |at: usize| luma(colour(at)) - ratio * luma(expected(at));
            0.5 * (difference(b) - difference(a)).abs() <= options.gradient_tolerance
        })
    };
    foreground.retain(|x, y| {
        let is_shadow = is_shadow(x, y);
        if is_shadow {
            on_shadow(y * width + x);
        }
        !is_shadow
    });
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
        let mut foreground = BitImage::from_bytes(&foreground, 12);
        let mut count = 0;
        let options = ShadowOptions::default();
        clear_shadows(&mut foreground, &frame, &background, [1.0; 3], &options, |_| count += 1);
        assert_eq!(foreground.to_bytes().iter().map(|&bit| usize::from(bit)).sum::<usize>(), 16 - count);
        count
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
