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
    let width = background.width();
    let sampled: Vec<usize> = (0..background.height())
        .step_by(STRIDE)
        .flat_map(|y| (0..width).step_by(STRIDE).map(move |x| y * width + x))
        .collect();
    [0, 1, 2].map(|channel| {
        let mut ratios: Vec<f32> = sampled
            .iter()
            .map(|&index| (f32::from(frame.as_raw()[3 * index + channel]), background.mean()[index][channel]))
            .filter(|&(i, mu)| (DARKEST..=BRIGHTEST).contains(&mu) && i <= BRIGHTEST)
            .map(|(i, mu)| i / mu)
            .collect();
        if ratios.len() < FEWEST {
            return 1.0;
        }
        let middle = ratios.len() / 2;
        *ratios.select_nth_unstable_by(middle, f32::total_cmp).1
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
