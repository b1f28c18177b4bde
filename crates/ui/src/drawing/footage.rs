//! The frame as it is.

use egui::ColorImage;

use super::PictureInput;
use crate::style::theme::data_colours::PICTURE_GROUND;

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|x, y, _| input.footage(x, y).unwrap_or(PICTURE_GROUND))
}
