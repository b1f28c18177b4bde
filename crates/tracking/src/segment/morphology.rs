//! Growing, shrinking, opening and closing of a binary image by a square of (2r + 1)² pixels.
//!
//! The square is separable, and the extremum over a window of n pixels needs only about log₂ n combinations of shifted
//! copies (1, 2, 4 … pixels, the last one overlapping).
//!
//! What lies outside the image never decides: it counts as set when eroding and as clear when dilating.

use super::bit_image::{BitImage, PADDING};

impl BitImage {
    /// Removes what a square of (2 · `opening` + 1)² pixels does not fit into, then fills the gaps that one of
    /// (2 · `closing` + 1)² does not fit into.
    pub(super) fn open_and_close(&mut self, opening: usize, closing: usize) {
        self.erode(opening);
        self.dilate(opening + closing);
        self.erode(closing);
    }

    /// Sets every pixel within `radius` of a set one, along rows and along columns.
    pub(super) fn dilate(&mut self, radius: usize) {
        // A larger radius than the image is not different from one that covers it.
        let (mut along_rows, along_columns) = (radius.min(self.width), radius.min(self.height));
        if along_columns > 0 {
            self.dilate_columns(along_columns);
        }
        while along_rows > 0 {
            // Growing twice is growing by the sum.
            let step = along_rows.min(PADDING);
            self.dilate_rows(step);
            along_rows -= step;
        }
    }

    /// Clears every pixel within `radius` of a clear one, along rows and along columns.
    pub(super) fn erode(&mut self, radius: usize) {
        self.invert();
        self.dilate(radius);
        self.invert();
    }

    /// At most by [`PADDING`].
    fn dilate_rows(&mut self, radius: usize) {
        // Shifted by the radius, a pixel's window begins at the pixel itself. The padding takes what leaves the row.
        let shifted = |words: &[u64], at: usize| words[at] << radius | words[at - 1] >> (64 - radius);
        let mut window: Vec<u64> = Vec::with_capacity(self.words.len());
        window.push(self.words[0] << radius);
        window.extend((1..self.words.len()).map(|at| shifted(&self.words, at)));
        let mut covered = 1;
        while covered < 2 * radius + 1 {
            let shift = covered.min(2 * radius + 1 - covered);
            for at in 1..window.len() {
                window[at - 1] |= window[at - 1] >> shift | window[at] << (64 - shift);
            }
            if let Some(last) = window.last_mut() {
                *last |= *last >> shift;
            }
            covered += shift;
        }
        self.words = window;
        self.clear_padding();
    }

    /// At most by the height.
    fn dilate_columns(&mut self, radius: usize) {
        let border = radius * self.pitch;
        let mut rows = Vec::with_capacity(self.words.len() + 2 * border);
        rows.resize(border, 0);
        rows.extend_from_slice(&self.words);
        rows.resize(self.words.len() + 2 * border, 0);
        let mut covered = 1;
        while covered < 2 * radius + 1 {
            let shift = covered.min(2 * radius + 1 - covered) * self.pitch;
            rows = rows.iter().zip(&rows[shift..]).map(|(a, b)| a | b).collect();
            covered += shift / self.pitch;
        }
        self.words = rows;
    }

    fn invert(&mut self) {
        self.words.iter_mut().for_each(|word| *word = !*word);
        self.clear_padding();
    }
}

#[cfg(test)]
mod tests {
    use imageproc::distance_transform::Norm;
    use proptest::prelude::*;

    use super::*;

    fn open_and_close(image: &BitImage, opening: usize, closing: usize) -> BitImage {
        let mut image = image.clone();
        image.open_and_close(opening, closing);
        image
    }

    fn dilate(bits: &[u8], width: usize, radius: usize) -> Vec<u8> {
        let mut image = BitImage::from_bytes(bits, width);
        image.dilate(radius);
        image.to_bytes()
    }

    #[test]
    fn opening_removes_specks_and_closing_fills_gaps_but_the_border_stays() {
        for (opening, closing, before, after) in [
            (1, 0, "#...... ..###.. ..##### ..###.. .......", "....... ..###.. ..###.. ..###.. ......."),
            (0, 1, "###.### ###.### ###.#.# ....... .......", "####### ####### ####### ....... ......."),
        ] {
            let found = open_and_close(&BitImage::from_ascii(before), opening, closing);
            assert_eq!(found, BitImage::from_ascii(after), "{opening}, {closing}");
        }
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
            let found = open_and_close(&BitImage::from_bytes(&bits, width), opening, closing).to_bytes();
            prop_assert_eq!(found.iter().map(|bit| 255 * bit).collect::<Vec<u8>>(), expected.into_raw());
        }
    }
}
