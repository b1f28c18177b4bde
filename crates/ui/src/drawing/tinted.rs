//! Agreement, missing and spurious as tints over dimmed footage, or in full on the ground where there is none.

use std::sync::OnceLock;

use backlit_tracking::render::Footprint;
use backlit_tracking::silhouette::Label;
use egui::{Color32, ColorImage};

use super::PictureInput;
use super::compose::{is_shadow_line, is_unknown_line};
use super::input::HALF;
use crate::style::theme::data_colours::{
    AGREEMENT, AGREEMENT_TINT, FOOTAGE_DIM, MISMATCH_TINT, MISSING, PICTURE_GROUND, SHADOW, SPURIOUS, UNKNOWN,
};

/// Opacity of the hatches of shadow and don't-know pixels over footage.
const HATCH_TINT: f32 = 0.5;

pub(super) fn compose(input: &PictureInput<'_>, part: &Footprint, picture: &mut ColorImage) {
    let tints = TINTS.get_or_init(Tints::new);
    let (Some(mask), Some(prediction)) = (input.mask, input.prediction) else {
        return input.paint(part, picture, |x, y, index| {
            let label = (input.label(index), input.is_shadow(index));
            let tint = tints.of(label, input.lambda(index) < HALF, x, y);
            input.footage(x, y).map_or(tint.flat, |colour| tint.over([colour.r(), colour.g(), colour.b()]))
        });
    };
    // Slices side by side: what every frame of the window does for every view is to be quick.
    let footage = input.frame.map(|frame| frame.as_raw().as_chunks::<3>().0);
    let weights = input.data.map(|data| data.weights());
    for y in part.rows() {
        let columns = part.columns(y);
        let (from, start) = (columns.start, y * input.size[0] + columns.start);
        let row = start..start + columns.len();
        let weights = weights.map(|weights| &weights[row.clone()]);
        let (labels, lambda) = (&mask.labels()[row.clone()], &prediction.lambda[row.clone()]);
        let tint = |x: usize| {
            let is_known = weights.is_none_or(|weights| weights[x] > 0.0);
            let label = if is_known { labels[x] } else { Label::Unknown };
            tints.of((label, mask.is_shadow(start + x)), lambda[x] < HALF, from + x, y)
        };
        let pixels = picture.pixels[row.clone()].iter_mut().enumerate();
        match footage {
            Some(footage) => {
                for ((x, pixel), colour) in pixels.zip(&footage[row]) {
                    *pixel = tint(x).over(*colour);
                }
            }
            None => {
                for (x, pixel) in pixels {
                    *pixel = tint(x).flat;
                }
            }
        }
    }
}

/// The tints alone, as premultiplied colours that dim what is under them.
pub(super) fn compose_over_footage(input: &PictureInput<'_>, part: &Footprint, picture: &mut ColorImage) {
    let tints = TINTS.get_or_init(Tints::new);
    input.paint(part, picture, |x, y, index| {
        let label = (input.label(index), input.is_shadow(index));
        tints.of(label, input.lambda(index) < HALF, x, y).layer
    });
}

/// The tints of what a pixel may be.
#[derive(Debug)]
struct Tints {
    ground: Tint,
    agreement: Tint,
    missing: Tint,
    spurious: Tint,
    unknown: Tint,
    shadow: Tint,
}

static TINTS: OnceLock<Tints> = OnceLock::new();

impl Tints {
    fn new() -> Self {
        Self {
            ground: Tint::new(PICTURE_GROUND, 0.0),
            agreement: Tint::new(AGREEMENT, AGREEMENT_TINT),
            missing: Tint::new(MISSING, MISMATCH_TINT),
            spurious: Tint::new(SPURIOUS, MISMATCH_TINT),
            unknown: Tint::new(UNKNOWN, HATCH_TINT),
            shadow: Tint::new(SHADOW, HATCH_TINT),
        }
    }

    /// Of a label, and whether the pixel is shadow.
    #[inline]
    fn of(&self, (label, is_shadow): (Label, bool), is_model: bool, x: usize, y: usize) -> &Tint {
        match (label, is_model) {
            _ if is_shadow && is_shadow_line(y) => &self.shadow,
            (Label::Unknown, _) if is_shadow => &self.ground,
            (Label::Background, false) => &self.ground,
            (Label::Subject, true) => &self.agreement,
            (Label::Subject, false) => &self.missing,
            (Label::Background, true) => &self.spurious,
            (Label::Unknown, _) if is_unknown_line(x, y) => &self.unknown,
            (Label::Unknown, _) => &self.ground,
        }
    }
}

/// A tint, and what dimmed footage becomes under it: each channel is looked up, since mixing four pictures pixel by pixel
/// would take longer than all else in a frame of the window.
#[derive(Debug)]
struct Tint {
    /// Where there is no footage.
    flat: Color32,
    /// What is laid over footage, premultiplied.
    layer: Color32,
    channels: [[u8; 256]; 3],
}

impl Tint {
    fn new(flat: Color32, opacity: f32) -> Self {
        let mut channels = [[0; 256]; 3];
        for level in 0..=u8::MAX {
            let ground = mix(Color32::from_gray(level), Color32::BLACK, FOOTAGE_DIM);
            let mixed = mix(ground, flat, opacity);
            for (channel, value) in channels.iter_mut().zip([mixed.r(), mixed.g(), mixed.b()]) {
                channel[usize::from(level)] = value;
            }
        }
        let [r, g, b] =
            [flat.r(), flat.g(), flat.b()].map(|level| (f32::from(level) * opacity).round() as u8);
        let covered = 1.0 - (1.0 - opacity) * (1.0 - FOOTAGE_DIM);
        let layer = Color32::from_rgba_premultiplied(r, g, b, (255.0 * covered).round() as u8);
        Self { flat, layer, channels }
    }

    #[inline]
    fn over(&self, footage: [u8; 3]) -> Color32 {
        let [red, green, blue] = &self.channels;
        let [r, g, b] = footage.map(usize::from);
        Color32::from_rgb(red[r], green[g], blue[b])
    }
}

/// `over` on `under` with this opacity, in sRGB.
pub(super) fn mix(under: Color32, over: Color32, opacity: f32) -> Color32 {
    let channel = |a: u8, b: u8| (f32::from(a) * (1.0 - opacity) + f32::from(b) * opacity).round() as u8;
    Color32::from_rgb(
        channel(under.r(), over.r()),
        channel(under.g(), over.g()),
        channel(under.b(), over.b()),
    )
}

#[cfg(test)]
mod tests {
    use backlit_tracking::render::Prediction;
    use backlit_tracking::silhouette::{Mask, Measurement};
    use image::{Rgb, RgbImage};

    use super::*;
    use crate::drawing::input::tests::prediction;
    use crate::drawing::{ViewMode, compose as compose_mode};

    #[test]
    fn a_tint_over_footage_is_the_tinted_footage() {
        let tints = Tints::new();
        for tint in [&tints.ground, &tints.agreement, &tints.missing, &tints.spurious, &tints.shadow] {
            for level in [0, 90, 200, 255] {
                let over = |layer: u8| {
                    let kept = 1.0 - f32::from(tint.layer.a()) / 255.0;
                    f32::from(layer) + f32::from(level) * kept
                };
                let laid = [tint.layer.r(), tint.layer.g(), tint.layer.b()].map(over);
                let mixed = tint.over([level; 3]);
                for (laid, mixed) in laid.into_iter().zip([mixed.r(), mixed.g(), mixed.b()]) {
                    assert!((laid - f32::from(mixed)).abs() < 2.0, "{laid} {mixed}");
                }
            }
        }
    }

    #[test]
    fn tints_lie_over_footage_that_is_18_percent_darker() {
        let mask = Mask::from_ascii("##..?").unwrap();
        let prediction = prediction(&[0.0, 200.0, 100.0, 255.0, 0.0], &[0; 5]);
        let frame = RgbImage::from_pixel(5, 1, Rgb([100, 100, 100]));
        let input = PictureInput {
            mask: Some(&mask),
            prediction: Some(&prediction),
            frame: Some(&frame),
            ..PictureInput::empty([5, 1])
        };
        let dimmed = Color32::from_gray(82);
        let expected = [
            mix(dimmed, AGREEMENT, 0.34),
            mix(dimmed, MISSING, 0.62),
            mix(dimmed, SPURIOUS, 0.62),
            dimmed,
            dimmed,
        ];
        assert_eq!(compose_mode(ViewMode::Tinted, &input).pixels, expected);
        let flat = compose_mode(ViewMode::Tinted, &PictureInput { frame: None, ..input }).pixels;
        assert_eq!(flat, [AGREEMENT, MISSING, SPURIOUS, PICTURE_GROUND, PICTURE_GROUND]);
        assert_ne!(flat[4], UNKNOWN, "the hatch passes every fifth pixel");
    }

    #[test]
    fn each_pixel_of_a_row_of_all_kinds_has_its_own_tint() {
        let mask = Mask::from_ascii("##??????-~~~..##\n##??????-~~~..##\n................").unwrap();
        let [width, height] = [mask.width(), mask.height()];
        let values = vec![100.0; width * height];
        let weights = (0..width * height).map(|index| if index % 7 == 0 { 0.0 } else { 1.0 }).collect();
        let data = Measurement::new(width, height, values, weights).unwrap();
        let lambda: Vec<f32> =
            (0..width * height).map(|index| if index % 3 == 0 { 0.0 } else { 255.0 }).collect();
        let prediction = Prediction { width, height, ..prediction(&lambda, &vec![0; lambda.len()]) };
        let frame =
            RgbImage::from_fn(width as u32, height as u32, |x, y| Rgb([9 * x as u8, 80 * y as u8, 7]));
        let input = PictureInput {
            mask: Some(&mask),
            data: Some(&data),
            prediction: Some(&prediction),
            ..PictureInput::empty([width, height])
        };
        let tints = Tints::new();
        for frame in [None, Some(&frame)] {
            let input = PictureInput { frame, ..input };
            let picture = compose_mode(ViewMode::Tinted, &input);
            for (index, pixel) in picture.pixels.iter().enumerate() {
                let (x, y) = (index % width, index / width);
                let label = (input.label(index), input.is_shadow(index));
                let tint = tints.of(label, input.lambda(index) < HALF, x, y);
                let expected = input.footage(x, y).map_or(tint.flat, |c| tint.over([c.r(), c.g(), c.b()]));
                assert_eq!(*pixel, expected, "at {x}, {y}");
            }
        }
    }
}
