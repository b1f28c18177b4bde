//! Opening and closing of a binary image by a square of (2r + 1)² pixels.
//!
//! Images are bytes, 0 or 1, row by row. The square is separable, and the extremum over a window of n pixels needs only
//! about log₂ n combinations of shifted copies (1, 2, 4 … pixels, the last one overlapping). Rows and columns alike are
//! shifts of one flat padded buffer, so each combination is one pass of plain byte operations.
//!
//! What lies outside the image never decides: it counts as set when eroding and as clear when dilating.

/// Removes what a square of (2 · `radius` + 1)² pixels does not fit into.
pub(super) fn open(bits: &[u8], width: usize, radius: usize) -> Vec<u8> {
    dilate(&erode(bits, width, radius), width, radius)
}

/// Fills the gaps that a square of (2 · `radius` + 1)² pixels does not fit into.
pub(super) fn close(bits: &[u8], width: usize, radius: usize) -> Vec<u8> {
    erode(&dilate(bits, width, radius), width, radius)
}

/// Sets every pixel within `radius` of a set one, along rows and along columns.
pub(super) fn dilate(bits: &[u8], width: usize, radius: usize) -> Vec<u8> {
    extremum(bits, width, radius, 0, |a, b| a | b)
}

/// Clears every pixel within `radius` of a clear one, along rows and along columns.
pub(super) fn erode(bits: &[u8], width: usize, radius: usize) -> Vec<u8> {
    extremum(bits, width, radius, 1, |a, b| a & b)
}

/// Combines the pixels of the square around each pixel; `neutral` stands for those outside the image.
fn extremum(
    bits: &[u8],
    width: usize,
    radius: usize,
    neutral: u8,
    combine: impl Fn(u8, u8) -> u8 + Copy,
) -> Vec<u8> {
    if radius == 0 || width == 0 {
        return bits.to_vec();
    }
    let height = bits.len() / width;
    // A larger radius than the image is not different from one that covers it.
    let (radius_x, radius_y) = (radius.min(width), radius.min(height));
    let stride = width + 2 * radius_x;
    let mut padded = vec![neutral; stride * (height + 2 * radius_y)];
    for (to, from) in padded.chunks_exact_mut(stride).skip(radius_y).zip(bits.chunks_exact(width)) {
        to[radius_x..radius_x + width].copy_from_slice(from);
    }
    let columns = window(padded, stride, 2 * radius_y + 1, combine);
    let square = window(columns, 1, 2 * radius_x + 1, combine);
    // Without the padding below, the last row ends with the image.
    let mut out = Vec::with_capacity(bits.len());
    square.chunks(stride).take(height).for_each(|row| out.extend_from_slice(&row[..width]));
    out
}

/// Combines each entry with the `length` − 1 entries that follow at distances of `step`. The result is shorter by the
/// entries that have not so many followers.
fn window(mut buffer: Vec<u8>, step: usize, length: usize, combine: impl Fn(u8, u8) -> u8 + Copy) -> Vec<u8> {
    let mut covered = 1;
    let mut shifted = Vec::with_capacity(buffer.len());
    while covered < length {
        let shift = covered.min(length - covered);
        shifted.clear();
        shifted.extend(buffer.iter().zip(&buffer[shift * step..]).map(|(&a, &b)| combine(a, b)));
        std::mem::swap(&mut buffer, &mut shifted);
        covered += shift;
    }
    buffer
}

#[cfg(test)]
pub(super) mod tests {
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
        assert_eq!(open(&before, width, 1), after);
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
        assert_eq!(close(&before, width, 1), after);
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
}
