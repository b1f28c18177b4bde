//! The report's overlay: data black, model white, both dark grey. Where they agree the picture goes quiet.

use backlit_tracking::silhouette::Label;
use egui::{Color32, ColorImage};

use super::{PictureInput, hatch};
use crate::style::theme::data_colours::{REPORT_GROUND, report_grey};

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|x, y, index| match (input.label(index), input.level(index)) {
        (Label::Unknown, _) | (_, None) => hatch::unknown(x, y, Color32::from_gray(REPORT_GROUND)),
        (_, Some(level)) => Color32::from_gray(report_grey(level, input.lambda(index))),
    })
}
