//! Shadows and weak reflections: foreground that shows the background under another light.
//!
//! Two ways to tell, [`ShadowTest`]:
//!
//! - **Gradient**, (6.12): a pixel is subject only if its level and the magnitude of its gradient both leave their intervals,
//!   |i − µ| > β σ and ||∇i| − |∇B|µ| > β |∇B|σ, each in some channel; a level that does so alone is a shadow's. A plain shirt before
//!   a plain wall is as flat as the wall, so this calls its inside shadow.
//! - **Brightness**: a shadow multiplies the light by a factor r and changes neither colour nor texture. With luma Y of the
//!   frame and M of the background, r = Y / M, a pixel is shadow if `darkest` ≤ r ≤ `brightest`, |i − r µ| ≤ `colour_tolerance`
//!   in each channel and |∇Y − r ∇M| ≤ `gradient_tolerance` along both axes. A grey shirt before a grey wall passes all of that.
//!
//! Gradients are central differences.

use image::RgbImage;
use serde::{Deserialize, Serialize};

use super::background::Background;
use super::bit_image::BitImage;
use super::gradient::{magnitude, neighbours};
use super::luminance::luma;
use super::threshold::Threshold;
use crate::silhouette::Label;

/// How a shadow is told from the subject.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShadowTest {
    /// By its brightness alone being off: luma ratio, colour, and a gradient within a fixed tolerance.
    #[default]
    Brightness,
    /// By a gradient that stays within the background's own interval (6.12). One plate has no such interval: that is an error.
    Gradient,
}

/// When a pixel that differs from the background is only a shadow (or a weak reflection) on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ShadowOptions {
    /// How it is told. The next four options are those of [`ShadowTest::Brightness`]; the other test takes β and the noise
    /// floor of the segmentation.
    pub test: ShadowTest,
    /// The darkest shadow, as a fraction of the background's brightness.
    pub darkest: f32,
    /// The brightest reflection, as a fraction of the background's brightness; 1 if only shadows are expected.
    pub brightest: f32,
    /// How far a channel may be off the darkened background, grey levels.
    pub colour_tolerance: f32,
    /// How far the gradient may be off that of the darkened background, grey levels per pixel.
    pub gradient_tolerance: f32,
    /// Whether shadow counts as unknown, not as background: cloth that passes for shadow is then not held against the subject.
    pub unknown: bool,
}

impl Default for ShadowOptions {
    fn default() -> Self {
        Self {
            test: ShadowTest::default(),
            darkest: 0.6,
            brightest: 1.4,
            colour_tolerance: 10.0,
            gradient_tolerance: 4.0,
            unknown: true,
        }
    }
}

impl ShadowOptions {
    /// What a shadow is labelled.
    pub(super) fn label(&self) -> Label {
        if self.unknown { Label::Unknown } else { Label::Background }
    }
}

/// Clears the foreground that is shadow, and returns what was cleared.
pub(super) fn clear_shadows(
    foreground: &mut BitImage,
    frame: &RgbImage,
    background: &Background,
    threshold: &Threshold,
    options: &ShadowOptions,
) -> BitImage {
    let mut shadow = foreground.clone();
    match options.test {
        ShadowTest::Brightness => {
            let test = Brightness { frame, background, gains: threshold.gains, options };
            foreground.retain(|x, y| !test.is_shadow(x, y));
        }
        ShadowTest::Gradient => {
            let levels = frame.as_raw().as_chunks::<3>().0;
            let size = [background.width(), background.height()];
            foreground.retain(|x, y| {
                let found = magnitude(levels, size, x, y);
                threshold.is_gradient_off(found, background, y * size[0] + x)
            });
        }
    }
    shadow.subtract(foreground);
    shadow
}

/// The test of [`ShadowTest::Brightness`].
struct Brightness<'a> {
    frame: &'a RgbImage,
    background: &'a Background,
    gains: [f32; 3],
    options: &'a ShadowOptions,
}

impl Brightness<'_> {
    fn is_shadow(&self, x: usize, y: usize) -> bool {
        let (size, options) = ([self.background.width(), self.background.height()], self.options);
        let index = y * size[0] + x;
        let (i, mu) = (self.colour(index), self.expected(index));
        let ratio = luma(i) / luma(mu).max(1.0);
        if !(options.darkest..=options.brightest).contains(&ratio)
            || (0..3).any(|c| (i[c] - ratio * mu[c]).abs() > options.colour_tolerance)
        {
            return false;
        }
        let (along_x, along_y) = neighbours(size, x, y);
        [along_x, along_y].into_iter().all(|[a, b]| {
            let difference = |at: usize| luma(self.colour(at)) - ratio * luma(self.expected(at));
            0.5 * (difference(b) - difference(a)).abs() <= options.gradient_tolerance
        })
    }

    fn colour(&self, index: usize) -> [f32; 3] {
        self.frame.as_raw().as_chunks::<3>().0[index].map(f32::from)
    }

    /// The background's colour in the light of the frame's exposure.
    fn expected(&self, index: usize) -> [f32; 3] {
        let mean = self.background.mean()[index];
        [0, 1, 2].map(|c| mean[c] * self.gains[c])
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;
    use crate::segment::BETA;

    /// A wall of squares that differ by `texture` grey levels; the frame is changed pixel by pixel in a block in its middle.
    fn shadow_count(test: ShadowTest, texture: u8, change: impl Fn(u32, [f32; 3]) -> [f32; 3]) -> usize {
        let plate = RgbImage::from_fn(12, 12, |x, y| {
            let level = 100 + texture * (((x / 2 + y / 2) % 2) as u8);
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
        let threshold = Threshold { gains: [1.0; 3], z: BETA, noise_floor: 1.0, grey: false, chroma: None };
        let options = ShadowOptions { test, ..ShadowOptions::default() };
        let shadow = clear_shadows(&mut foreground, &frame, &background, &threshold, &options);
        let count = |image: &BitImage| image.to_bytes().iter().map(|&bit| usize::from(bit)).sum::<usize>();
        assert_eq!(count(&foreground), 16 - count(&shadow));
        count(&shadow)
    }

    #[test]
    fn darkened_background_is_shadow() {
        for test in [ShadowTest::Brightness, ShadowTest::Gradient] {
            assert_eq!(shadow_count(test, 12, |_, colour| colour.map(|level| 0.8 * level)), 16, "{test:?}");
        }
    }

    #[test]
    fn too_dark_another_colour_or_another_texture_is_not() {
        use ShadowTest::Brightness;
        assert_eq!(shadow_count(Brightness, 12, |_, colour| colour.map(|level| 0.4 * level)), 0);
        assert_eq!(shadow_count(Brightness, 12, |_, [r, g, b]| [0.9 * r, 0.7 * g, 0.7 * b]), 0);
        let stripes = |at: u32| if at % 4 < 2 { 0.65 } else { 0.85 };
        for test in [Brightness, ShadowTest::Gradient] {
            let found = shadow_count(test, 12, |at, colour| colour.map(|level| stripes(at) * level));
            assert_eq!(found, 0, "{test:?}");
        }
    }

    /// (6.12) looks at the gradient alone: whatever is as flat as the wall is shadow, even a red shirt. Before a chequered wall
    /// the shirt is told by being flat.
    #[test]
    fn a_plain_shirt_is_told_from_a_chequered_wall_only() {
        let shirt = |_, _| [200.0, 40.0, 40.0];
        for (texture, expected) in [(0, 16), (12, 0)] {
            assert_eq!(shadow_count(ShadowTest::Gradient, texture, shirt), expected);
            assert_eq!(shadow_count(ShadowTest::Brightness, texture, shirt), 0);
        }
        // A grey one passes the other test too.
        let grey = |_, colour: [f32; 3]| colour.map(|level| 0.8 * level);
        assert_eq!(shadow_count(ShadowTest::Brightness, 0, grey), 16);
    }
}
