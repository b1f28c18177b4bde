//! Pictures at a part of their size, by averages.

use image::RgbImage;

/// A picture with each square of `divisor`² pixels averaged to one. Columns at the right and rows at the bottom that fill
/// no square are left out; a divisor larger than a side counts as that side.
#[must_use]
pub fn reduced(picture: RgbImage, divisor: usize) -> RgbImage {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let divisor = divisor.min(width).min(height);
    if divisor <= 1 {
        return picture;
    }
    let size = [width / divisor, height / divisor];
    let out = averaged::<3>(picture.as_raw(), width, size, [divisor; 2]);
    RgbImage::from_raw(size[0] as u32, size[1] as u32, out).unwrap_or_default()
}

/// Averages of blocks of pixels of `N` interleaved bytes; rows of the plane are `width` pixels long.
pub(crate) fn averaged<const N: usize>(
    plane: &[u8],
    width: usize,
    size: [usize; 2],
    block: [usize; 2],
) -> Vec<u8> {
    if block == [1, 1] && width == size[0] {
        return plane[..width * size[1] * N].to_vec();
    }
    let count = (block[0] * block[1]) as u32;
    let used = size[0] * block[0] * N;
    let mut sums = vec![0_u32; used];
    let mut out = Vec::with_capacity(size[0] * size[1] * N);
    for rows in plane.chunks_exact(width * N * block[1]).take(size[1]) {
        sums.fill(0);
        for row in rows.chunks_exact(width * N) {
            for (sum, &value) in sums.iter_mut().zip(row) {
                *sum += u32::from(value);
            }
        }
        for block in sums.chunks_exact(block[0] * N) {
            let mut sum = [count / 2; N];
            for pixel in block.as_chunks::<N>().0 {
                for (sum, value) in sum.iter_mut().zip(pixel) {
                    *sum += value;
                }
            }
            out.extend(sum.map(|sum| (sum / count) as u8));
        }
    }
    out
}
