//! Resampling a distorted picture once to the ideal pinhole grid.
//!
//! On that grid a picture's rays are (x, y, 1), which is what the renderers' rows rely on. Pixels that the
//! lens never saw have no data: their label is unknown, and they weigh nothing.
//!
//! Where a prediction is wanted on the raw picture (overlays, exports), every pixel's own ray is taken instead, which is
//! exact. Resampling is not: it mixes four pixels, with weights in 256ths and levels in whole numbers. Both ways agree
//! where λ is linear over a pixel and differ where a ramp clips or bends: for a ramp 15 px wide by at most 8 grey levels,
//! and 0.5 in the mean of the grey pixels; for ramps of three pixels by at most 40, and 1.8 in the mean.

use glam::DVec2;
use image::RgbImage;
use pulp::{Arch, Simd, WithSimd};

use super::Camera;

/// Fixed point of the bilinear weights: 256 steps between two pixels.
const STEPS: u32 = 256;

/// Where each ideal pixel lies in the distorted picture: made once a camera, used for every frame.
#[derive(Debug, Clone)]
pub struct Rectification {
    width: usize,
    height: usize,
    /// One per ideal pixel; empty for no distortion.
    sources: Vec<MixedPixel>,
}

/// The four pixels that an ideal one is mixed from.
#[derive(Debug, Clone, Copy)]
struct MixedPixel {
    /// Index of the upper left one; `NOWHERE` where there is no data.
    corner: u32,
    /// Weights of the right and the lower neighbours, in 256ths. Zero at the picture's far edges.
    right: u16,
    down: u16,
}

const NOWHERE: u32 = u32::MAX;

impl Rectification {
    /// For a camera's picture size and lens.
    pub fn new(camera: &Camera) -> Self {
        let (width, height) = (camera.width(), camera.height());
        let mut sources = Vec::new();
        if !camera.distortion().is_none() {
            sources.reserve(width * height);
            for y in 0..height {
                for x in 0..width {
                    sources.push(source(camera, DVec2::new(x as f64, y as f64)));
                }
            }
        }
        Self { width, height, sources }
    }

    /// Whether pictures pass unchanged.
    pub fn is_identity(&self) -> bool {
        self.sources.is_empty()
    }

    /// Whether the ideal pixel x, y has data.
    pub fn has_data(&self, x: usize, y: usize) -> bool {
        self.sources.get(y * self.width + x).is_none_or(|source| source.corner != NOWHERE)
    }

    /// Indices of the ideal pixels without data, row by row.
    pub fn unseen(&self) -> Vec<usize> {
        let sources = self.sources.iter().enumerate();
        sources.filter(|(_, source)| source.corner == NOWHERE).map(|(index, _)| index).collect()
    }

    /// The picture on the ideal grid, bilinear; black where there is no data.
    ///
    /// `None` if the picture is not of the camera's size.
    pub fn rectify(&self, image: &RgbImage) -> Option<RgbImage> {
        if image.width() as usize != self.width || image.height() as usize != self.height {
            return None;
        }
        if self.is_identity() {
            return Some(image.clone());
        }
        let mut out = RgbImage::new(image.width(), image.height());
        let mut pixels = Vec::with_capacity(image.len() + READ_BYTES);
        pixels.extend_from_slice(image.as_raw());
        pixels.extend([0; READ_BYTES]);
        let mix = Mix { sources: &self.sources, pixels: &pixels, row: 3 * self.width, out: &mut out };
        Arch::new().dispatch(mix);
        Some(out)
    }

    /// Any values a pixel, row by row, on the ideal grid: each ideal pixel takes the nearest one, or `outside`
    /// where there is no data. For labels, which cannot be averaged.
    ///
    /// `None` if there is not one value a pixel of the camera.
    pub fn nearest<T: Copy>(&self, values: &[T], outside: T) -> Option<Vec<T>> {
        if values.len() != self.width * self.height {
            return None;
        }
        if self.is_identity() {
            return Some(values.to_vec());
        }
        let at = |source: &MixedPixel| {
            if source.corner == NOWHERE {
                return outside;
            }
            let right = usize::from(u32::from(source.right) * 2 >= STEPS);
            let down = if u32::from(source.down) * 2 >= STEPS { self.width } else { 0 };
            values[source.corner as usize + right + down]
        };
        Some(self.sources.iter().map(at).collect())
    }
}

/// Pixels that are mixed together, as vectors do it.
const LANES: usize = 16;
/// Bytes that are read for a pixel and its right neighbour; the picture is longer by as many.
const READ_BYTES: usize = 8;

/// Mixes each pixel from its four; `row` is the length of a row in bytes.
struct Mix<'a> {
    sources: &'a [MixedPixel],
    pixels: &'a [u8],
    row: usize,
    out: &'a mut [u8],
}

impl WithSimd for Mix<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (sources, rest) = self.sources.as_chunks::<LANES>();
        let (out, last) = self.out.as_chunks_mut::<{ 3 * LANES }>();
        for (sources, out) in sources.iter().zip(out) {
            *out = mixed(self.pixels, self.row, sources);
        }
        let mut sources = [MixedPixel { corner: NOWHERE, right: 0, down: 0 }; LANES];
        sources[..rest.len()].copy_from_slice(rest);
        last.copy_from_slice(&mixed(self.pixels, self.row, &sources)[..last.len()]);
    }
}

/// The pixels of some sources. A neighbour beyond the edge has no weight: any pixel will do for it.
#[inline(always)]
fn mixed(pixels: &[u8], row: usize, sources: &[MixedPixel; LANES]) -> [u8; 3 * LANES] {
    let [mut left, mut right, mut below_left, mut below_right] = [[0_u32; LANES]; 4];
    let pair = |at: usize| {
        let bytes = pixels.get(at..).and_then(<[u8]>::first_chunk).copied().unwrap_or([0; READ_BYTES]);
        let levels = u64::from_le_bytes(bytes);
        [levels as u32, (levels >> 24) as u32]
    };
    for (k, source) in sources.iter().enumerate() {
        if source.corner != NOWHERE {
            let corner = 3 * source.corner as usize;
            let below = if source.down > 0 { corner + row } else { corner };
            [left[k], right[k]] = pair(corner);
            [below_left[k], below_right[k]] = pair(below);
        }
    }
    let (across, down) =
        (sources.map(|source| source.right.into()), sources.map(|source| source.down.into()));
    let mut levels = [0_u32; LANES];
    for k in 0..LANES {
        let between = |a: u32, b: u32, step: u32| a * (STEPS - step) + b * step;
        let channel = |bits: u32| {
            let [left, right, below_left, below_right] =
                [left[k], right[k], below_left[k], below_right[k]].map(|levels| (levels >> bits) & 0xff);
            let [above, below] =
                [between(left, right, across[k]), between(below_left, below_right, across[k])];
            ((between(above, below, down[k]) + STEPS * STEPS / 2) / (STEPS * STEPS)) << bits
        };
        levels[k] = channel(0) | channel(8) | channel(16);
    }
    let mut out = [0; 3 * LANES];
    for (out, levels) in out.as_chunks_mut().0.iter_mut().zip(levels) {
        let [red, green, blue, _] = levels.to_le_bytes();
        *out = [red, green, blue];
    }
    out
}

fn source(camera: &Camera, ideal: DVec2) -> MixedPixel {
    let (pinhole, lens) = (camera.intrinsics(), camera.distortion());
    let limit = DVec2::new(camera.width() as f64 - 1.0, camera.height() as f64 - 1.0);
    let plane = pinhole.plane_from_pixel(ideal);
    let bent = lens.distort(plane);
    let place = pinhole.pixel_from_plane(bent);
    // Where the lens model folds over, the way back leads elsewhere.
    let honest = lens.undistort(bent).is_some_and(|back| back.distance(plane) < 1e-6);
    let inside = place.cmpge(DVec2::splat(-0.5)).all() && place.cmple(limit + 0.5).all();
    if !(honest && inside) {
        return MixedPixel { corner: NOWHERE, right: 0, down: 0 };
    }
    let steps = (place.clamp(DVec2::ZERO, limit) * f64::from(STEPS)).round().max(DVec2::ZERO);
    let (x, y) = (steps.x as u32, steps.y as u32);
    MixedPixel {
        corner: y / STEPS * camera.width() as u32 + x / STEPS,
        right: (x % STEPS) as u16,
        down: (y % STEPS) as u16,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use image::Rgb;

    use super::*;
    use crate::camera::Distortion;
    use crate::fixtures;

    fn bent_camera() -> Camera {
        let lens = Distortion::OpenCv { k1: -0.2, k2: 0.05, p1: 1e-3, p2: -1e-3, k3: 0.0 };
        fixtures::lens_camera(lens, [96, 64], [80.0, 82.0, 47.0, 30.0], DVec3::ZERO, DVec3::Z, DVec3::NEG_Y)
    }

    /// Waves across and down the ideal grid: their slope, 39 grey levels a pixel, tells a shift of a quarter of one.
    fn waves(ideal: DVec2) -> [f64; 2] {
        ideal.to_array().map(|place| 128.0 + 100.0 * (place * std::f64::consts::TAU / 16.0).sin())
    }

    #[test]
    fn a_rectified_picture_shows_points_where_the_pinhole_does() {
        let camera = bent_camera();
        let mut picture = RgbImage::new(96, 64);
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            if let Some(ray) = camera.ray_in_camera(DVec2::new(f64::from(x), f64::from(y))) {
                let ideal = camera.intrinsics().pixel_from_plane(ray.truncate() / ray.z);
                let [across, down] = waves(ideal).map(|level| level.round() as u8);
                *pixel = Rgb([across, down, 0]);
            }
        }
        let rectification = Rectification::new(&camera);
        let ideal = rectification.rectify(&picture).unwrap();
        let mut seen = 0;
        for (x, y, pixel) in ideal.enumerate_pixels() {
            if rectification.has_data(x as usize, y as usize) {
                let expected = waves(DVec2::new(f64::from(x), f64::from(y)));
                for (found, expected) in [pixel[0], pixel[1]].into_iter().zip(expected) {
                    assert!((f64::from(found) - expected).abs() < 5.0, "{x} {y}: {found} {expected}");
                }
                seen += 1;
            }
        }
        assert!(seen > 5000, "only {seen} pixels have data");
        assert_eq!(rectification.rectify(&RgbImage::new(10, 10)), None);
    }

    #[test]
    fn a_mixed_pixel_is_the_weighted_sum_of_its_four() {
        let camera = bent_camera();
        let rectification = Rectification::new(&camera);
        let level = |x: u32, y: u32, channel: u32| ((x * 37 + y * 91 + channel * 53) % 256) as u8;
        let picture = RgbImage::from_fn(96, 64, |x, y| Rgb([0, 1, 2].map(|channel| level(x, y, channel))));
        let ideal = rectification.rectify(&picture).unwrap();
        for (source, pixel) in rectification.sources.iter().zip(ideal.pixels()) {
            let (x, y) = (source.corner % 96, source.corner / 96);
            let [right, down] = [source.right, source.down].map(u32::from);
            let mut sums = [STEPS * STEPS / 2; 3];
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let weight = [STEPS - right, right][dx as usize] * [STEPS - down, down][dy as usize];
                if source.corner != NOWHERE && weight > 0 {
                    let levels = picture.get_pixel(x + dx, y + dy).0;
                    sums.iter_mut().zip(levels).for_each(|(sum, level)| *sum += weight * u32::from(level));
                }
            }
            assert_eq!(pixel.0, sums.map(|sum| (sum / (STEPS * STEPS)) as u8), "{source:?}");
        }
    }

    #[test]
    fn labels_come_from_the_nearest_pixel() {
        let camera = bent_camera();
        let rectification = Rectification::new(&camera);
        let places: Vec<usize> = (0..96 * 64).collect();
        let nearest = rectification.nearest(&places, usize::MAX).unwrap();
        for (index, &source) in nearest.iter().enumerate() {
            let ideal = DVec2::new((index % 96) as f64, (index / 96) as f64);
            if rectification.has_data(index % 96, index / 96) {
                let plane = camera.intrinsics().plane_from_pixel(ideal);
                let bent = camera.intrinsics().pixel_from_plane(camera.distortion().distort(plane));
                let off = (bent - DVec2::new((source % 96) as f64, (source / 96) as f64)).abs();
                assert!(off.max_element() <= 0.5 + 1.0 / f64::from(STEPS), "{ideal}: {bent}, {off} off");
            } else {
                assert_eq!(source, usize::MAX, "{ideal}");
            }
        }
        assert_eq!(rectification.nearest(&places[1..], 7), None);
    }
}
