//! D − Λ in two hues on a fixed scale: orange where data lacks model, blue where model lacks data, dark at zero.

use egui::ColorImage;

use super::{PictureInput, hatch};
use crate::style::theme::data_colours::PICTURE_GROUND;
use crate::style::theme::residual_colour;

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|x, y, index| {
        let colour = |level| residual_colour(level - input.lambda(index));
        hatch::data(input, [x, y, index], PICTURE_GROUND, colour)
    })
}
