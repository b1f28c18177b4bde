//! The prediction Λ in its grey levels.

use egui::{Color32, ColorImage};

use super::PictureInput;

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|_, _, index| Color32::from_gray(input.lambda(index).round() as u8))
}
