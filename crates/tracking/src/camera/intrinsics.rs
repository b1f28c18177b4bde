//! The pinhole: focal lengths and principal point, in pixels.

use glam::{DVec2, DVec3};

/// `x_px = fx X/Z + cx`, `y_px = fy Y/Z + cy`, with pixel centres at integers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    /// Focal length across, pixels.
    pub fx: f64,
    /// Focal length down, pixels.
    pub fy: f64,
    /// Principal point across, pixels.
    pub cx: f64,
    /// Principal point down, pixels.
    pub cy: f64,
}

impl Intrinsics {
    /// Pixel of a point on the plane Z = 1.
    pub fn pixel_from_plane(&self, plane: DVec2) -> DVec2 {
        DVec2::new(self.fx * plane.x + self.cx, self.fy * plane.y + self.cy)
    }

    /// Point on the plane Z = 1 of a pixel.
    pub fn plane_from_pixel(&self, pixel: DVec2) -> DVec2 {
        DVec2::new((pixel.x - self.cx) / self.fx, (pixel.y - self.cy) / self.fy)
    }

    /// Unit ray of a pixel in camera axes.
    pub fn ray(&self, pixel: DVec2) -> DVec3 {
        self.plane_from_pixel(pixel).extend(1.0).normalize()
    }

    /// One focal length for sizes: the geometric mean.
    pub fn mean_focal_px(&self) -> f64 {
        (self.fx * self.fy).sqrt()
    }
}
