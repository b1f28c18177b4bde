//! A binary image of one bit a pixel, 64 pixels a word: what morphology needs is shifts and logic, and those work on
//! whole words.
//!
//! Bit b of word w of a row is pixel 64 w + b. Every row ends in at least [`PADDING`] clear bits, so that all rows together
//! may be shifted as one string without touching one another.

/// Clear bits behind each row, at least.
const PADDING: usize = 16;

/// Multiplied by eight bytes of 0 or 1, puts byte i into bit 56 + i; nothing carries into those.
const GATHER: u64 = 0x0102_0408_1020_4080;

/// The lowest bit of each byte.
const LOWEST_BITS: u64 = 0x0101_0101_0101_0101;

/// One bit for each pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BitImage {
    width: usize,
    height: usize,
    /// Words from one row to the next.
    pitch: usize,
    words: Vec<u64>,
}

impl BitImage {
    /// Packs bytes, each 0 or 1, row by row. The width is at least 1.
    pub(super) fn from_bytes(bytes: &[u8], width: usize) -> Self {
        let (height, pitch) = (bytes.len() / width, (width + PADDING).div_ceil(64));
        let mut words = vec![0; height * pitch];
        for (words, row) in words.chunks_exact_mut(pitch).zip(bytes.chunks_exact(width)) {
            for (word, bytes) in words.iter_mut().zip(row.chunks(64)) {
                let (eights, rest) = bytes.as_chunks::<8>();
                for (at, eight) in eights.iter().enumerate() {
                    *word |= pack(*eight) << (8 * at);
                }
                let mut last = [0; 8];
                last[..rest.len()].copy_from_slice(rest);
                *word |= pack(last).unbounded_shl(8 * eights.len() as u32);
            }
        }
        Self { width, height, pitch, words }
    }

    /// Bytes of 0 or 1, row by row.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.width * self.height);
        let (whole, rest) = (self.width / 8, self.width % 8);
        for row in self.words.chunks_exact(self.pitch) {
            let eight = |at: usize| unpack((row[at / 8] >> (8 * (at % 8))) as u8);
            (0..whole).for_each(|at| bytes.extend_from_slice(&eight(at)));
            if rest > 0 {
                bytes.extend_from_slice(&eight(whole)[..rest]);
            }
        }
        bytes
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

    fn clear_padding(&mut self) {
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

/// Eight bits as bytes of 0 or 1, the lowest one first.
fn unpack(bits: u8) -> [u8; 8] {
    // Each byte of the product keeps one bit of the eight, in its own place; adding carries it to the top.
    let one_each = u64::from(bits).wrapping_mul(LOWEST_BITS) & 0x8040_2010_0804_0201;
    let carried = (one_each + 0x7f7f_7f7f_7f7f_7f7f) >> 7;
    (carried & LOWEST_BITS).to_le_bytes()
}
