//! The measurement D in its grey levels; shadow and don't-know pixels hatched.

use egui::{Color32, ColorImage};

use super::{PictureInput, hatch};
use crate::style::theme::data_colours::PICTURE_GROUND;

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|x, y, index| {
        hatch::data(input, [x, y, index], PICTURE_GROUND, |level| Color32::from_gray(level.round() as u8))
    })
}

#[cfg(test)]
mod tests {
    use backlit_tracking::silhouette::{Mask, Measurement};

    use super::*;
    use crate::drawing::{ViewMode, compose as compose_mode};
    use crate::style::theme::data_colours::{SHADOW, UNKNOWN};

    #[test]
    fn grey_levels_are_shown_as_they_are_and_shadow_and_unknown_are_hatched() {
        let shadows = Mask::from_ascii("-~.").unwrap();
        let input = PictureInput { mask: Some(&shadows), ..PictureInput::empty([3, 1]) };
        let picture = compose_mode(ViewMode::Data, &input);
        assert_eq!(picture.pixels, [SHADOW, SHADOW, Color32::WHITE]);
        assert!(input.has_shadow() && !input.has_unknown());
        // Between the lines lies what the shadow weighs.
        let shadows = Mask::from_ascii("-~.\n-~.").unwrap();
        let input = PictureInput { mask: Some(&shadows), ..PictureInput::empty([3, 2]) };
        let picture = compose_mode(ViewMode::Data, &input);
        assert_eq!(picture.pixels[3..], [Color32::WHITE, PICTURE_GROUND, Color32::WHITE]);
        let mask = Mask::from_ascii("?#.").unwrap();
        let input = PictureInput { mask: Some(&mask), ..PictureInput::empty([3, 1]) };
        let picture = compose_mode(ViewMode::Data, &input);
        assert_eq!(picture.pixels, [UNKNOWN, Color32::BLACK, Color32::WHITE]);
        let data = Measurement::new(3, 1, vec![99.6, 40.0, 12.0], vec![1.0, 1.0, 0.0]).unwrap();
        let picture = compose_mode(ViewMode::Data, &PictureInput { data: Some(&data), mask: None, ..input });
        assert_eq!(picture.pixels, [Color32::from_gray(100), Color32::from_gray(40), PICTURE_GROUND]);
    }
}
