//! Hatches, in the picture's own pixels.

use backlit_tracking::silhouette::Label;
use egui::Color32;

use super::PictureInput;
use crate::style::theme::data_colours::{NO_GRADIENT, SHADOW, UNKNOWN, mark};

/// A pixel's colour where the data is shown: hatched where it is shadow or says nothing. Under the hatch lies `shown` of its
/// grey level, or `ground` where it weighs nothing.
pub(super) fn data(
    input: &PictureInput<'_>,
    [x, y, index]: [usize; 3],
    ground: Color32,
    shown: impl FnOnce(f32) -> Color32,
) -> Color32 {
    let level = input.level(index).filter(|_| input.label(index) != Label::Unknown);
    match (level, input.is_shadow(index)) {
        (_, true) if is_shadow_line(y) => SHADOW,
        (None, false) => unknown(x, y, ground),
        (level, _) => level.map_or(ground, shown),
    }
}

/// The colour of a don't-know pixel on `ground`: one diagonal of every five, falling to the right.
pub(super) fn unknown(x: usize, y: usize, ground: Color32) -> Color32 {
    if is_unknown_line(x, y) { UNKNOWN } else { ground }
}

/// The colour of a pixel without gradient on `ground`: two diagonals of every six, rising to the right.
pub(super) fn no_gradient(x: usize, y: usize, ground: Color32) -> Color32 {
    let [width, period] = mark::NO_GRADIENT_HATCH.map(|px| px as usize);
    if (x + y) % period < width { NO_GRADIENT } else { ground }
}

/// Whether the hatch of shadows has a line in this row: one of every three.
pub(super) fn is_shadow_line(y: usize) -> bool {
    let [width, period] = mark::SHADOW_HATCH.map(|px| px as usize);
    y % period < width
}

/// Whether the don't-know hatch has a line at this pixel.
pub(super) fn is_unknown_line(x: usize, y: usize) -> bool {
    let [width, period] = mark::UNKNOWN_HATCH.map(|px| px as usize);
    // x − y, kept above zero: y of any picture is far below the offset, a multiple of the period.
    (x + (usize::MAX >> 8) / period * period - y) % period < width
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fall_to_the_right_every_five_pixels() {
        let ground = Color32::BLACK;
        let row = |y: usize| -> String {
            (0..8).map(|x| if unknown(x, y, ground) == UNKNOWN { '\\' } else { '.' }).collect()
        };
        assert_eq!([row(0), row(1), row(2)], ["\\....\\..", ".\\....\\.", "..\\....\\"]);
    }
}
