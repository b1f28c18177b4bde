//! Lens distortion, after OpenCV's rational-free model: k1 k2 k3 radial, p1 p2 tangential.
//!
//! With r² = x² + y² on the plane Z = 1:
//! x' = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2x²),
//! y' = y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2y²) + 2 p2 x y.

use glam::{DMat2, DVec2};

/// What the lens does to the ideal picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Distortion {
    /// An ideal pinhole.
    #[default]
    None,
    /// OpenCV's five coefficients.
    OpenCv {
        /// Radial, r².
        k1: f64,
        /// Radial, r⁴.
        k2: f64,
        /// Tangential.
        p1: f64,
        /// Tangential.
        p2: f64,
        /// Radial, r⁶.
        k3: f64,
    },
}

/// Newton steps of [`Distortion::undistort`]; real lenses need three or four.
const UNDISTORT_STEPS: usize = 20;

impl Distortion {
    /// Whether the picture is an ideal pinhole's.
    #[must_use]
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Where the lens puts a point of the plane Z = 1.
    #[must_use]
    pub fn distort(&self, plane: DVec2) -> DVec2 {
        let Self::OpenCv { k1, k2, p1, p2, k3 } = *self else { return plane };
        let DVec2 { x, y } = plane;
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        DVec2::new(
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }

    fn jacobian(&self, plane: DVec2) -> DMat2 {
        let Self::OpenCv { k1, k2, p1, p2, k3 } = *self else { return DMat2::IDENTITY };
        let DVec2 { x, y } = plane;
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3)); // d radial/dx = slope·x
        let cross = x * y * slope + 2.0 * (p1 * x + p2 * y);
        DMat2::from_cols(
            DVec2::new(radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, cross),
            DVec2::new(cross, radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x),
        )
    }

    /// The point of the plane that the lens puts at `distorted`, by Newton's method.
    ///
    /// `None` where the model folds over and has no inverse: far outside any calibrated picture.
    #[must_use]
    pub fn undistort(&self, distorted: DVec2) -> Option<DVec2> {
        if self.is_none() {
            return Some(distorted);
        }
        let mut plane = distorted;
        for _ in 0..UNDISTORT_STEPS {
            let jacobian = self.jacobian(plane);
            if jacobian.determinant() < 1e-3 {
                return None;
            }
            let step = jacobian.inverse() * (distorted - self.distort(plane));
            plane += step;
            if step.length_squared() < 1e-24 {
                break;
            }
        }
        let worst = (self.distort(plane) - distorted).length();
        (worst < 1e-9 && self.jacobian(plane).determinant() > 1e-3).then_some(plane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENS: Distortion = Distortion::OpenCv { k1: -0.28, k2: 0.09, p1: 6e-4, p2: -7e-4, k3: -0.012 };

    #[test]
    fn undistort_undoes_distort() {
        for i in -8..=8 {
            for j in -8..=8 {
                let plane = DVec2::new(f64::from(i), f64::from(j)) * 0.08;
                let again = LENS.undistort(LENS.distort(plane)).unwrap();
                assert!((again - plane).length() < 1e-10, "{plane} {again}");
            }
        }
    }

    #[test]
    fn jacobian_matches_differences() {
        let (at, h) = (DVec2::new(0.4, -0.3), 1e-6);
        for e in [DVec2::X, DVec2::Y] {
            let numeric = (LENS.distort(at + e * h) - LENS.distort(at - e * h)) / (2.0 * h);
            assert!((numeric - LENS.jacobian(at) * e).length() < 1e-9);
        }
    }
}
