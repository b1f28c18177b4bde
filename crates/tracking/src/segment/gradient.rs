//! |∇i|: how steep a picture is at a pixel, channel by channel: √(∂ₓi² + ∂ᵧi²) by central differences, in grey levels a
//! pixel. Beyond the border the picture goes on as its outermost pixels, so half of a one-sided difference counts there.

use image::RgbImage;

/// The magnitudes at all pixels, row by row.
pub(super) fn magnitudes(picture: &RgbImage) -> Vec<[f32; 3]> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let levels = picture.as_raw().as_chunks::<3>().0;
    (0..height).flat_map(|y| (0..width).map(move |x| magnitude(levels, [width, height], x, y))).collect()
}

/// The magnitude at one pixel of a picture of `size`.
#[inline]
pub(super) fn magnitude(levels: &[[u8; 3]], size: [usize; 2], x: usize, y: usize) -> [f32; 3] {
    let ([left, right], [above, below]) = neighbours(size, x, y);
    [0, 1, 2].map(|c| {
        let difference = |a: usize, b: usize| f32::from(levels[b][c]) - f32::from(levels[a][c]);
        let (along_x, along_y) = (difference(left, right), difference(above, below));
        0.5 * (along_x * along_x + along_y * along_y).sqrt()
    })
}

/// The indices left and right of a pixel, and above and below it; its own where the picture ends.
pub(super) fn neighbours([width, height]: [usize; 2], x: usize, y: usize) -> ([usize; 2], [usize; 2]) {
    let index = y * width + x;
    let along_x = [index - usize::from(x > 0), index + usize::from(x + 1 < width)];
    let along_y = [index - width * usize::from(y > 0), index + width * usize::from(y + 1 < height)];
    (along_x, along_y)
}
