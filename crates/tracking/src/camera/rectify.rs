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
        let pixels = image.as_raw();
        for (mixed, source) in out.chunks_exact_mut(3).zip(&self.sources) {
            if source.corner == NOWHERE {
                continue;
            }
            let corner = 3 * source.corner as usize;
            // A neighbour beyond the edge has no weight: any pixel will do for it.
            let right = if source.right > 0 { 3 } else { 0 };
            let down = if source.down > 0 { 3 * self.width } else { 0 };
            let (wx, wy) = (u32::from(source.right), u32::from(source.down));
            let weights = [(STEPS - wx) * (STEPS - wy), wx * (STEPS - wy), (STEPS - wx) * wy, wx * wy];
            let mut sums = [STEPS * STEPS / 2; 3];
            for (weight, offset) in weights.into_iter().zip([0, right, down, down + right]) {
                let neighbour = &pixels[corner + offset..][..3];
                sums.iter_mut().zip(neighbour).for_each(|(sum, &level)| *sum += weight * u32::from(level));
            }
            mixed.iter_mut().zip(sums).for_each(|(value, sum)| *value = (sum / (STEPS * STEPS)) as u8);
        }
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
