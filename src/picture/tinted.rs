//! Agreement, missing and spurious as tints over dimmed footage, or in full on the ground where there is none.

use backlit_tracking::silhouette::Label;
use egui::{Color32, ColorImage};

use super::input::HALF;
use super::{PictureInput, hatch};
use crate::theme::data_colours::{
    AGREEMENT, AGREEMENT_TINT, FOOTAGE_DIM, MISMATCH_TINT, MISSING, PICTURE_GROUND, SPURIOUS, UNKNOWN,
};

/// Opacity of the don't-know hatch over footage.
const HATCH_TINT: f32 = 0.5;

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|x, y, index| {
        let footage = input.footage(x, y);
        let ground = footage.map_or(PICTURE_GROUND, |colour| mix(colour, Color32::BLACK, FOOTAGE_DIM));
        let is_model = input.lambda(index) < HALF;
        let (tint, opacity) = match (input.label(index), is_model) {
            (Label::Unknown, _) if !hatch::is_unknown_line(x, y) => return ground,
            (Label::Unknown, _) => (UNKNOWN, HATCH_TINT),
            (Label::Background, false) => return ground,
            (Label::Subject, true) => (AGREEMENT, AGREEMENT_TINT),
            (Label::Subject, false) => (MISSING, MISMATCH_TINT),
            (Label::Background, true) => (SPURIOUS, MISMATCH_TINT),
        };
        if footage.is_some() { mix(ground, tint, opacity) } else { tint }
    })
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
    use backlit_tracking::silhouette::Mask;
    use image::{Rgb, RgbImage};

    use super::*;
    use crate::picture::input::tests::prediction;
    use crate::picture::{ViewMode, compose as compose_mode};

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
}
