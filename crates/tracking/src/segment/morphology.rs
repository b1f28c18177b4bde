//! Opening and closing of a binary image by a square of (2r + 1)² pixels.
//!
//! Images are bytes, 0 or 1, row by row; the work is done on [`BitImage`]s, 64 pixels at a time. The square is separable,
//! and the extremum over a window of n pixels needs only about log₂ n combinations of shifted copies (1, 2, 4 … pixels, the
//! last one overlapping).
//!
//! What lies outside the image never decides: it counts as set when eroding and as clear when dilating.

use super::bit_image::BitImage;

/// Removes what a square of (2 · `opening` + 1)² pixels does not fit into, then fills the gaps that one of
/// (2 · `closing` + 1)² does not fit into.
pub(super) fn open_and_close(bits: &[u8], width: usize, opening: usize, closing: usize) -> Vec<u8> {
    let mut image = BitImage::from_bytes(bits, width);
    image.erode(opening);
    image.dilate(opening + closing);
    image.erode(closing);
    image.to_bytes()
}

/// Sets every pixel within `radius` of a set one, along rows and along columns.
pub(super) fn dilate(bits: &[u8], width: usize, radius: usize) -> Vec<u8> {
    let mut image = BitImage::from_bytes(bits, width);
    image.dilate(radius);
    image.to_bytes()
}

#[cfg(test)]
pub(super) mod tests {
    use imageproc::distance_transform::Norm;
    use proptest::prelude::*;

    use super::*;

    /// Bytes of an ASCII image of `#` and `.`, and its width.
    pub(in crate::segment) fn bits(text: &str) -> (Vec<u8>, usize) {
        let rows: Vec<&str> = text.split_whitespace().collect();
        (rows.concat().bytes().map(|character| u8::from(character == b'#')).collect(), rows[0].len())
    }

    #[test]
    fn opening_removes_specks_and_thin_lines() {
        let (before, width) = bits(
            "
            #......
            ..###..
            ..#####
            ..###..
            .......
        ",
        );
        let (after, _) = bits(
            "
            .......
            ..###..
            ..###..
            ..###..
            .......
        ",
        );
        assert_eq!(open_and_close(&before, width, 1, 0), after);
    }

    #[test]
    fn closing_fills_gaps_and_leaves_the_border_alone() {
        let (before, width) = bits(
            "
            ###.###
            ###.###
            ###.#.#
            .......
            .......
        ",
        );
        let (after, _) = bits(
            "
            #######
            #######
            #######
            .......
            .......
        ",
        );
        assert_eq!(open_and_close(&before, width, 0, 1), after);
    }

    fn erode(bits: &[u8], width: usize, radius: usize) -> Vec<u8> {
        let mut image = BitImage::from_bytes(bits, width);
        image.erode(radius);
        image.to_bytes()
    }

    proptest! {
        #[test]
        fn equals_the_definition(
            width in 1..12_usize,
            radius in prop_oneof![0..8_usize, Just(usize::MAX / 4)],
            bits in proptest::collection::vec(0..2_u8, 60),
        ) {
            let height = 60 / width;
            let bits = &bits[..width * height];
            let near = |i: usize, j: usize| {
                (i % width).abs_diff(j % width) <= radius && (i / width).abs_diff(j / width) <= radius
            };
            let all = |i: usize, value: u8| (0..bits.len()).all(|j| !near(i, j) || bits[j] == value);
            let eroded: Vec<u8> = (0..bits.len()).map(|i| u8::from(all(i, 1))).collect();
            let dilated: Vec<u8> = (0..bits.len()).map(|i| u8::from(!all(i, 0))).collect();
            prop_assert_eq!(erode(bits, width, radius), eroded);
            prop_assert_eq!(dilate(bits, width, radius), dilated);
        }
    }

    #[test]
    fn one_pixel_becomes_a_square() {
        let (width, height, x, y) = (199, 90, 70, 40);
        let mut bits = vec![0; width * height];
        bits[y * width + x] = 1;
        for radius in [1, 15, 16, 17, 31, 32, 33, 50, 64, 80, 150] {
            let inside = |i: usize| (i % width).abs_diff(x) <= radius && (i / width).abs_diff(y) <= radius;
            let expected: Vec<u8> = (0..bits.len()).map(|i| u8::from(inside(i))).collect();
            assert!(dilate(&bits, width, radius) == expected, "radius {radius}");
            let holes: Vec<u8> = bits.iter().map(|bit| 1 - bit).collect();
            let expected: Vec<u8> = expected.iter().map(|bit| 1 - bit).collect();
            assert!(erode(&holes, width, radius) == expected, "radius {radius}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]

        /// Rows of several words, with and without bits to spare. (The other implementation clears images that are all set
        /// when the radius is as large as the image.)
        #[test]
        fn equals_another_implementation(
            width in prop_oneof![20..200_usize, Just(64), Just(128), Just(192)],
            density in 0..12_u8,
            (opening, closing) in (0..5_usize, 0..19_usize),
            noise in proptest::collection::vec(0..12_u8, 199 * 6),
        ) {
            let bits: Vec<u8> = noise[..width * 6].iter().map(|&level| u8::from(level < density)).collect();
            let picture: Vec<u8> = bits.iter().map(|bit| 255 * bit).collect();
            let picture = image::GrayImage::from_raw(width as u32, 6, picture).unwrap();
            let opened = imageproc::morphology::open(&picture, Norm::LInf, opening as u8);
            let expected = imageproc::morphology::close(&opened, Norm::LInf, closing as u8);
            let found = open_and_close(&bits, width, opening, closing);
            prop_assert_eq!(found.iter().map(|bit| 255 * bit).collect::<Vec<u8>>(), expected.into_raw());
        }
    }
}
