//! One gain per channel between a frame and the plate, for a camera that was exposed a little differently.
//!
//! The gain is the median of i / µ over a grid of pixels, so a subject that covers less than half of the view does not
//! move it. A change of exposure multiplies the light; after the camera's gamma curve that is still one factor.

use image::RgbImage;

use super::background::Background;

/// One pixel in this many, along both axes, is looked at.
const STRIDE: usize = 3;

/// Darker background than this says little about a factor, grey levels.
const DARKEST: f32 = 24.0;

/// Brighter background or frame than this may be clipped, grey levels.
const BRIGHTEST: f32 = 245.0;

/// With fewer usable pixels than this the gain is left at 1.
const FEWEST: usize = 64;

/// The gain of red, green and blue by which the background must be multiplied to look like the frame.
pub(super) fn gains(frame: &RgbImage, background: &Background) -> [f32; 3] {
    let (width, height) = (background.width(), background.height());
    let (levels, means) = (frame.as_raw().as_chunks::<3>().0, background.mean());
    let most = width.div_ceil(STRIDE) * height.div_ceil(STRIDE);
    // Ratios are not negative, so their bits are in the order of the numbers.
    let mut ratios = [0, 1, 2].map(|_| vec![0_u32; most]);
    let mut counts = [0; 3];
    for y in (0..height).step_by(STRIDE) {
        let row = y * width..(y + 1) * width;
        let pixels = levels[row.clone()].iter().zip(&means[row]).step_by(STRIDE);
        for (level, mean) in pixels {
            for c in 0..3 {
                // Written in any case, and kept if it counts: a branch would be guessed wrong too often.
                let (i, mu) = (f32::from(level[c]), mean[c]);
                ratios[c][counts[c]] = (i / mu).to_bits();
                counts[c] += usize::from((DARKEST..=BRIGHTEST).contains(&mu) & (i <= BRIGHTEST));
            }
        }
    }
    [0, 1, 2].map(|c| {
        let found = &mut ratios[c][..counts[c]];
        if found.len() < FEWEST {
            return 1.0;
        }
        let middle = found.len() / 2;
        f32::from_bits(*found.select_nth_unstable(middle).1)
    })
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    fn plate() -> RgbImage {
        RgbImage::from_fn(60, 40, |x, y| Rgb([40 + x as u8, 60 + y as u8, 100 + (x + y) as u8]))
    }

    #[test]
    fn a_subject_does_not_move_the_gain() {
        let background = Background::from_plate(&plate());
        let mut frame = plate();
        for (x, _, pixel) in frame.enumerate_pixels_mut() {
            let gain = if x < 20 { 0.2 } else { 1.1 };
            *pixel = Rgb(pixel.0.map(|level| (f32::from(level) * gain).round() as u8));
        }
        for gain in gains(&frame, &background) {
            assert!((gain - 1.1).abs() < 0.01, "{gain}");
        }
    }

    #[test]
    fn without_usable_pixels_the_gain_is_one() {
        let background = Background::from_plate(&RgbImage::new(60, 40));
        assert_eq!(gains(&plate(), &background), [1.0; 3]);
    }
}
