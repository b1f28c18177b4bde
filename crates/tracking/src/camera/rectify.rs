//! Resampling a distorted picture once to the ideal pinhole grid.
//!
//! On that grid a picture's rays are (x, y, 1), which is what the renderers' rows rely on. Pixels that the
//! lens never saw have no data.

use glam::DVec2;
use image::{Rgb, RgbImage};

use super::Camera;

/// Where each ideal pixel lies in the distorted picture: made once a camera, used for every frame.
#[derive(Debug, Clone)]
pub struct Rectification {
    width: usize,
    height: usize,
    /// Per ideal pixel its place in the distorted picture; NaN where there is none. Empty for no distortion.
    sources: Vec<[f32; 2]>,
}

impl Rectification {
    /// For a camera's picture size and lens.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let (width, height) = (camera.width(), camera.height());
        let mut sources = Vec::new();
        if !camera.distortion().is_none() {
            let limit = DVec2::new(width as f64 - 1.0, height as f64 - 1.0);
            let lens = camera.distortion();
            sources.reserve(width * height);
            for y in 0..height {
                for x in 0..width {
                    let plane = camera.intrinsics().plane_from_pixel(DVec2::new(x as f64, y as f64));
                    let bent = lens.distort(plane);
                    let source = camera.intrinsics().pixel_from_plane(bent);
                    // Where the lens model folds over, the way back leads elsewhere.
                    let honest = lens.undistort(bent).is_some_and(|back| back.distance(plane) < 1e-6);
                    let inside = source.cmpge(DVec2::splat(-0.5)).all() && source.cmple(limit + 0.5).all();
                    let source = source.clamp(DVec2::ZERO, limit);
                    sources.push(if honest && inside {
                        [source.x as f32, source.y as f32]
                    } else {
                        [f32::NAN; 2]
                    });
                }
            }
        }
        Self { width, height, sources }
    }

    /// Whether pictures pass unchanged.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        self.sources.is_empty()
    }

    /// Whether the ideal pixel x, y has data.
    #[must_use]
    pub fn has_data(&self, x: usize, y: usize) -> bool {
        self.sources.get(y * self.width + x).is_none_or(|source| !source[0].is_nan())
    }

    /// The picture on the ideal grid, bilinear; black where there is no data.
    ///
    /// `None` if the picture is not of the camera's size.
    #[must_use]
    pub fn rectify(&self, image: &RgbImage) -> Option<RgbImage> {
        if image.width() as usize != self.width || image.height() as usize != self.height {
            return None;
        }
        if self.is_identity() {
            return Some(image.clone());
        }
        let mut out = RgbImage::new(image.width(), image.height());
        for (pixel, source) in out.pixels_mut().zip(&self.sources) {
            if !source[0].is_nan() {
                *pixel = bilinear(image, source[0], source[1]);
            }
        }
        Some(out)
    }
}

fn bilinear(image: &RgbImage, x: f32, y: f32) -> Rgb<u8> {
    let (x0, y0) = (x as u32, y as u32);
    let (x1, y1) = ((x0 + 1).min(image.width() - 1), (y0 + 1).min(image.height() - 1));
    let (fx, fy) = (x - x0 as f32, y - y0 as f32);
    let mut out = [0; 3];
    for (channel, value) in out.iter_mut().enumerate() {
        let at = |x, y| f32::from(image.get_pixel(x, y)[channel]);
        let top = at(x0, y0) * (1.0 - fx) + at(x1, y0) * fx;
        let bottom = at(x0, y1) * (1.0 - fx) + at(x1, y1) * fx;
        *value = (top * (1.0 - fy) + bottom * fy + 0.5) as u8;
    }
    Rgb(out)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::camera::{CameraFromWorld, Distortion, Intrinsics};

    #[test]
    fn a_rectified_picture_shows_points_where_the_pinhole_does() {
        let lens = Distortion::OpenCv { k1: -0.2, k2: 0.05, p1: 1e-3, p2: -1e-3, k3: 0.0 };
        let place = CameraFromWorld::looking_at(DVec3::ZERO, DVec3::Z, DVec3::NEG_Y);
        let intrinsics = Intrinsics { fx: 80.0, fy: 82.0, cx: 47.0, cy: 30.0 };
        let camera = Camera::new("c", [96, 64], intrinsics, lens, place).unwrap();
        let mut picture = RgbImage::new(96, 64);
        // A picture whose grey levels say where they come from on the ideal plane.
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            if let Some(ray) = camera.ray_in_camera(DVec2::new(f64::from(x), f64::from(y))) {
                let value = 128.0 + 100.0 * ray.x / ray.z;
                *pixel = Rgb([value as u8; 3]);
            }
        }
        let rectification = Rectification::new(&camera);
        let ideal = rectification.rectify(&picture).unwrap();
        for (x, y, pixel) in ideal.enumerate_pixels() {
            if rectification.has_data(x as usize, y as usize) {
                let expected = 128.0 + 100.0 * (f64::from(x) - 47.0) / 80.0;
                assert!((f64::from(pixel[0]) - expected).abs() < 2.5, "{x} {y}: {} {expected}", pixel[0]);
            }
        }
        assert_eq!(rectification.rectify(&RgbImage::new(10, 10)), None);
    }
}
