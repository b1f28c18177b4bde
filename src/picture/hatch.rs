//! The don't-know hatch, in the picture's own pixels.

use egui::Color32;

use crate::theme::data_colours::{UNKNOWN, mark};

/// The colour of a don't-know pixel on `ground`: one diagonal of every five, falling to the right.
pub(super) fn unknown(x: usize, y: usize, ground: Color32) -> Color32 {
    let [width, period] = mark::UNKNOWN_HATCH.map(|px| px as usize);
    // x − y, kept above zero: y of any picture is far below the offset, a multiple of the period.
    let along = (x + (usize::MAX >> 8) / period * period - y) % period;
    if along < width { UNKNOWN } else { ground }
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
