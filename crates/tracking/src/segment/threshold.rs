//! The deviation test: a pixel is foreground if |i − g µ| > β max(σ, floor) in some channel, or by its grey level alone (4.25).

use image::RgbImage;
use pulp::{Simd, WithSimd};

use crate::processor;

use super::background::{Background, grey_of};
use super::bit_image::BitImage;
use super::luminance::{Chroma, luma};

/// The test, apart from the background.
#[derive(Clone, Copy, Debug)]
pub(super) struct Threshold {
    /// g of red, green and blue.
    pub(super) gains: [f32; 3],
    /// β.
    pub(super) z: f32,
    /// The smallest deviation that is believed, grey levels.
    pub(super) noise_floor: f32,
    /// Whether grey levels decide, not the channels.
    pub(super) grey: bool,
    /// Whether luminance and chroma decide, not the channels, and the limit of chroma.
    pub(super) chroma: Option<Chroma>,
}

impl Threshold {
    /// For each pixel whether some channel is off.
    pub(super) fn foreground(&self, frame: &RgbImage, background: &Background) -> BitImage {
        if !self.grey && self.chroma.is_none() {
            return processor::run(ByDeviation { threshold: self, frame, background });
        }
        let width = background.width();
        let mut foreground = BitImage::empty(width, background.height());
        for y in 0..background.height() {
            let row = y * width..(y + 1) * width;
            let off = row.map(|index| u8::from(self.is_off(frame, background, index)));
            foreground.set_row(y, &off.collect::<Vec<_>>());
        }
        foreground
    }

    /// The same test with another β.
    pub(super) fn with_z(&self, z: f32) -> Self {
        let chroma =
            self.chroma.map(|chroma| Chroma { z: chroma.z * z / self.z.max(f32::MIN_POSITIVE), ..chroma });
        Self { z, chroma, ..*self }
    }

    /// Whether some channel of one pixel is off, or its grey level where that decides, or its luminance or chroma.
    pub(super) fn is_off(&self, frame: &RgbImage, background: &Background, index: usize) -> bool {
        let colour = frame.as_raw().as_chunks::<3>().0[index];
        if self.grey {
            let (known, gain) = (background.grey()[index], luma(self.gains));
            return self.is_level_off(grey_of(colour), gain, known.mean, known.deviation);
        }
        let (mean, deviation) = (background.mean()[index], background.deviation()[index]);
        if let Some(chroma) = &self.chroma {
            let off = [0, 1, 2].map(|c| f32::from(colour[c]) - self.gains[c] * mean[c]);
            let luminance = background.grey()[index].deviation.max(self.noise_floor);
            return luma(off).abs() > self.z * luminance || chroma.is_off(off, deviation);
        }
        (0..3).any(|c| self.is_level_off(colour[c], self.gains[c], mean[c], deviation[c]))
    }

    /// By how many thresholds each pixel is off: foreground is what exceeds 1. Infinite where β is 0 and a pixel is off at all.
    pub(super) fn excess(&self, frame: &RgbImage, background: &Background) -> Vec<f32> {
        let (colours, means) = (frame.as_raw().as_chunks::<3>().0, background.mean());
        let excess = |index: usize| {
            let (mean, deviation) = (means[index], background.deviation()[index]);
            let off = [0, 1, 2].map(|c| f32::from(colours[index][c]) - self.gains[c] * mean[c]);
            let over = |off: f32, deviation: f32| off.abs() / (self.z * deviation.max(self.noise_floor));
            if self.grey {
                let known = background.grey()[index];
                return over(
                    f32::from(grey_of(colours[index])) - luma(self.gains) * known.mean,
                    known.deviation,
                );
            }
            match &self.chroma {
                Some(chroma) => {
                    over(luma(off), background.grey()[index].deviation).max(chroma.excess(off, deviation))
                }
                None => [0, 1, 2].map(|c| over(off[c], deviation[c])).into_iter().fold(0.0, f32::max),
            }
        };
        (0..means.len()).map(excess).map(|found| if found.is_nan() { 0.0 } else { found }).collect()
    }

    /// Whether the magnitude of one pixel's gradient is off in some channel: ||∇i| − g |∇B|µ| > β max(|∇B|σ, floor / √2). Half the
    /// difference of two pixels has 1/√2 of a pixel's deviation.
    pub(super) fn is_gradient_off(&self, found: [f32; 3], background: &Background, index: usize) -> bool {
        let (mean, deviation) = (background.gradient_mean()[index], background.gradient_deviation()[index]);
        let floor = self.noise_floor * std::f32::consts::FRAC_1_SQRT_2;
        (0..3).any(|c| (found[c] - self.gains[c] * mean[c]).abs() > self.z * deviation[c].max(floor))
    }

    #[inline(always)]
    fn is_level_off(&self, level: u8, gain: f32, mean: f32, deviation: f32) -> bool {
        (f32::from(level) - gain * mean).abs() > self.z * deviation.max(self.noise_floor)
    }
}

/// The work of [`Threshold::foreground`], compiled once more for wider vectors.
struct ByDeviation<'a> {
    threshold: &'a Threshold,
    frame: &'a RgbImage,
    background: &'a Background,
}

impl WithSimd for ByDeviation<'_> {
    type Output = BitImage;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> BitImage {
        let Self { threshold, frame, background } = self;
        // The three channels of a row are one run of numbers, which suits vectors.
        let row = 3 * background.width();
        let row_gains = threshold.gains.repeat(background.width());
        let mut off = vec![0_u8; row];
        let mut pixels = vec![0_u8; background.width()];
        let mut foreground = BitImage::empty(background.width(), background.height());
        let mean = background.mean().as_flattened().chunks_exact(row);
        let deviation = background.deviation().as_flattened().chunks_exact(row);
        let rows = frame.as_raw().chunks_exact(row).zip(mean.zip(deviation));
        for (y, (levels, (mu, sigma))) in rows.enumerate() {
            let numbers = off.iter_mut().zip(levels).zip(mu.iter().zip(sigma)).zip(&row_gains);
            for (((off, &level), (&mu, &sigma)), &gain) in numbers {
                *off = u8::from(threshold.is_level_off(level, gain, mu, sigma));
            }
            for (pixel, channels) in pixels.iter_mut().zip(off.as_chunks::<3>().0) {
                *pixel = channels[0] | channels[1] | channels[2];
            }
            foreground.set_row(y, &pixels);
        }
        foreground
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn rows_decide_as_pixels_do(
            first in any::<[u8; 3]>(),
            second in any::<[u8; 3]>(),
            z in prop_oneof![Just(0.0_f32), 0.0..6_f32, Just(1e30)],
            noise_floor in prop_oneof![Just(0.0_f32), 0.0..300_f32, Just(5.0)],
        ) {
            let frames = [first, second, second].map(|colour| RgbImage::from_pixel(256, 1, Rgb(colour)));
            let plate = Background::from_plate(&frames[0]);
            let all_levels = RgbImage::from_fn(256, 1, |x, _| Rgb([x as u8; 3]));
            for background in [plate, Background::from_frames(&frames).unwrap()] {
                let threshold = Threshold { gains: [1.0; 3], z, noise_floor, grey: false, chroma: None };
                for channel in 0..3 {
                    let mut frame = RgbImage::from_pixel(256, 1, Rgb(second));
                    for (pixel, level) in frame.pixels_mut().zip(all_levels.pixels()) {
                        pixel.0[channel] = level.0[channel];
                    }
                    let expected: Vec<u8> =
                        (0..256).map(|index| u8::from(threshold.is_off(&frame, &background, index))).collect();
                    prop_assert_eq!(&threshold.foreground(&frame, &background).to_bytes(), &expected, "channel {}", channel);
                }
            }
        }
    }
}
