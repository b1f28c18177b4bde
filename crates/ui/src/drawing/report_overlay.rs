//! The report's overlay: data black, model white, both dark grey. Where they agree the picture goes quiet.

use egui::{Color32, ColorImage};

use super::{PictureInput, hatch};
use crate::style::theme::data_colours::{REPORT_GROUND, report_grey};

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|x, y, index| {
        let grey = |level| Color32::from_gray(report_grey(level, input.lambda(index)));
        hatch::data(input, [x, y, index], Color32::from_gray(REPORT_GROUND), grey)
    })
}
