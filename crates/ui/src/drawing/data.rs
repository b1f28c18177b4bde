//! The measurement D in its grey levels; don't-know pixels hatched.

use backlit_tracking::silhouette::Label;
use egui::{Color32, ColorImage};

use super::{PictureInput, hatch};
use crate::style::theme::data_colours::PICTURE_GROUND;

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|x, y, index| match (input.label(index), input.level(index)) {
        (Label::Unknown, _) | (_, None) => hatch::unknown(x, y, PICTURE_GROUND),
        (_, Some(level)) => Color32::from_gray(level.round() as u8),
    })
}

#[cfg(test)]
mod tests {
    use backlit_tracking::silhouette::{Mask, Measurement};

    use super::*;
    use crate::drawing::{ViewMode, compose as compose_mode};
    use crate::style::theme::data_colours::UNKNOWN;

    #[test]
    fn grey_levels_are_shown_as_they_are_and_unknown_is_hatched() {
        let mask = Mask::from_ascii("?#.").unwrap();
        let input = PictureInput { mask: Some(&mask), ..PictureInput::empty([3, 1]) };
        let picture = compose_mode(ViewMode::Data, &input);
        assert_eq!(picture.pixels, [UNKNOWN, Color32::BLACK, Color32::WHITE]);
        let data = Measurement::new(3, 1, vec![99.6, 40.0, 12.0], vec![1.0, 1.0, 0.0]).unwrap();
        let picture = compose_mode(ViewMode::Data, &PictureInput { data: Some(&data), mask: None, ..input });
        assert_eq!(picture.pixels, [Color32::from_gray(100), Color32::from_gray(40), PICTURE_GROUND]);
    }
}
