//! A binary image of one bit a pixel, 64 pixels a word: what morphology needs is shifts and logic, and those work on
//! whole words. Pixels that are set, and runs of them, are found by counting zeros.
//!
//! Bit b of word w of a row is pixel 64 w + b. Every row ends in at least [`PADDING`] clear bits, so that all rows together
//! may be shifted as one string without touching one another.

use std::ops::Range;

/// Clear bits behind each row, at least.
pub(super) const PADDING: usize = 16;

/// Multiplied by eight bytes of 0 or 1, puts byte i into bit 56 + i; nothing carries into those.
const GATHER: u64 = 0x0102_0408_1020_4080;

/// One bit for each pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BitImage {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Words from one row to the next.
    pub(super) pitch: usize,
    pub(super) words: Vec<u64>,
}

impl BitImage {
    /// An image with no pixel set. The width is at least 1.
    pub(super) fn empty(width: usize, height: usize) -> Self {
        let pitch = (width + PADDING).div_ceil(64);
        Self { width, height, pitch, words: vec![0; height * pitch] }
    }

    /// Writes a row from bytes, each 0 or 1.
    #[inline(always)]
    pub(super) fn set_row(&mut self, y: usize, bytes: &[u8]) {
        for (word, bytes) in self.words[y * self.pitch..][..self.pitch].iter_mut().zip(bytes.chunks(64)) {
            let (eights, rest) = bytes.as_chunks::<8>();
            *word = 0;
            for (at, eight) in eights.iter().enumerate() {
                *word |= pack(*eight) << (8 * at);
            }
            if !rest.is_empty() {
                let mut last = [0; 8];
                last[..rest.len()].copy_from_slice(rest);
                *word |= pack(last) << (8 * eights.len());
            }
        }
    }

    fn row(&self, y: usize) -> &[u64] {
        &self.words[y * self.pitch..][..self.pitch]
    }

    /// Whether a pixel is set.
    pub(super) fn get(&self, x: usize, y: usize) -> bool {
        self.row(y)[x / 64] >> (x % 64) & 1 == 1
    }

    /// Clears the set pixels, by column and row, that are not to be kept.
    pub(super) fn retain(&mut self, mut keep: impl FnMut(usize, usize) -> bool) {
        for (y, row) in self.words.chunks_exact_mut(self.pitch).enumerate() {
            for (at, word) in row.iter_mut().enumerate() {
                let mut left = *word;
                while left != 0 {
                    let bit = left.trailing_zeros() as usize;
                    left &= left - 1;
                    if !keep(64 * at + bit, y) {
                        *word &= !(1 << bit);
                    }
                }
            }
        }
    }

    /// The runs of pixels of one value in a row, from left to right.
    pub(super) fn runs(&self, y: usize, value: bool) -> impl Iterator<Item = Range<usize>> {
        self.runs_from(y, 0, value)
    }

    /// The same from a column on.
    pub(super) fn runs_from(
        &self,
        y: usize,
        mut x: usize,
        value: bool,
    ) -> impl Iterator<Item = Range<usize>> {
        std::iter::from_fn(move || {
            let start = self.find(y, x, value)?;
            x = self.find(y, start, !value).unwrap_or(self.width);
            Some(start..x)
        })
    }

    /// The first pixel of a value at or after column `x`.
    fn find(&self, y: usize, x: usize, value: bool) -> Option<usize> {
        let (row, flip) = (self.row(y), if value { 0 } else { u64::MAX });
        let mut at = x / 64;
        let mut word = (row.get(at)? ^ flip) & (u64::MAX << (x % 64));
        while word == 0 {
            at += 1;
            word = row.get(at)? ^ flip;
        }
        let found = 64 * at + word.trailing_zeros() as usize;
        (found < self.width).then_some(found)
    }

    /// Sets or clears a run of pixels of a row.
    pub(super) fn fill(&mut self, y: usize, run: Range<usize>, value: bool) {
        let mut x = run.start;
        while x < run.end {
            let (at, bit) = (y * self.pitch + x / 64, x % 64);
            let count = (64 - bit).min(run.end - x);
            let bits = (u64::MAX >> (64 - count)) << bit;
            self.words[at] = if value { self.words[at] | bits } else { self.words[at] & !bits };
            x += count;
        }
    }

    /// Clears what is clear in another image of the same size.
    pub(super) fn intersect(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, other)| *word &= other);
    }

    /// Sets what is set in another image of the same size.
    pub(super) fn add(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, other)| *word |= other);
    }

    /// Clears what is set in another image of the same size.
    pub(super) fn subtract(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(word, other)| *word &= !other);
    }

    pub(super) fn clear_padding(&mut self) {
        let (whole, rest) = (self.width / 64, self.width % 64);
        for row in self.words.chunks_exact_mut(self.pitch) {
            row[whole] &= (1 << rest) - 1;
            row[whole + 1..].fill(0);
        }
    }
}

/// Eight bytes of 0 or 1 as bits, the first one lowest.
fn pack(bytes: [u8; 8]) -> u64 {
    u64::from_le_bytes(bytes).wrapping_mul(GATHER) >> 56
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::*;

    impl BitImage {
        /// Packs bytes, each 0 or 1, row by row.
        pub(in crate::segment) fn from_bytes(bytes: &[u8], width: usize) -> Self {
            let mut image = Self::empty(width, bytes.len() / width);
            bytes.chunks_exact(width).enumerate().for_each(|(y, row)| image.set_row(y, row));
            image
        }

        /// Bytes of 0 or 1, row by row.
        pub(in crate::segment) fn to_bytes(&self) -> Vec<u8> {
            let pixels = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
            pixels.map(|(x, y)| u8::from(self.get(x, y))).collect()
        }

        /// An ASCII image of `#` and `.`.
        pub(in crate::segment) fn from_ascii(text: &str) -> Self {
            let rows: Vec<&str> = text.split_whitespace().collect();
            let bytes: Vec<u8> = rows.concat().bytes().map(|character| u8::from(character == b'#')).collect();
            Self::from_bytes(&bytes, rows[0].len())
        }
    }

    proptest! {
        #[test]
        fn runs_and_fills_are_those_of_bytes(
            width in prop_oneof![1..12_usize, 60..70_usize, Just(128), Just(140)],
            density in 0..5_u8,
            noise in proptest::collection::vec(0..4_u8, 3 * 140),
            (start, length, value) in (0..140_usize, 0..140_usize, any::<bool>()),
        ) {
            let mut bytes: Vec<u8> = noise[..3 * width].iter().map(|&level| u8::from(level < density)).collect();
            let mut image = BitImage::from_bytes(&bytes, width);
            prop_assert_eq!(&image.to_bytes(), &bytes);
            for value in [false, true] {
                let mut painted = vec![u8::from(!value); 3 * width];
                for y in 0..3 {
                    let runs: Vec<_> = image.runs(y, value).collect();
                    prop_assert!(runs.windows(2).all(|two| two[0].end < two[1].start));
                    for run in runs {
                        prop_assert!(!run.is_empty());
                        painted[y * width..][run].fill(u8::from(value));
                    }
                }
                prop_assert_eq!(&painted, &bytes);
            }
            let run = start.min(width)..(start + length).min(width);
            image.fill(1, run.clone(), value);
            bytes[width..][run].fill(u8::from(value));
            prop_assert_eq!(&image.to_bytes(), &bytes);
            image.retain(|x, y| (x + y) % 3 != 0);
            let kept = bytes.iter().enumerate().map(|(i, &byte)| byte & u8::from((i % width + i / width) % 3 != 0));
            prop_assert_eq!(image.to_bytes(), kept.collect::<Vec<u8>>());
        }
    }
}
