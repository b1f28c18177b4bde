//! Lens distortion, after OpenCV's models.
//!
//! With r² = x² + y² on the plane Z = 1, radial and tangential (`calib3d`, `projectPoints`):
//! x' = x s + 2 p1 x y + p2 (r² + 2x²),
//! y' = y s + p1 (r² + 2y²) + 2 p2 x y, where
//!
//! | lens | s |
//! |---|---|
//! | `OpenCv` | 1 + k1 r² + k2 r⁴ + k3 r⁶ |
//! | `Rational` | (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶) |
//! | `Fisheye` | θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) / r with θ = atan r, no tangential part |
//!
//! The fisheye is that of Kannala and Brandt, "A generic camera model and calibration method", 2006, eq. 6, with the
//! factor of θ set to 1 as in `cv::fisheye`.

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
    /// OpenCV's eight coefficients.
    Rational {
        /// Radial above the line, r².
        k1: f64,
        /// Radial above the line, r⁴.
        k2: f64,
        /// Tangential.
        p1: f64,
        /// Tangential.
        p2: f64,
        /// Radial above the line, r⁶.
        k3: f64,
        /// Radial below the line, r².
        k4: f64,
        /// Radial below the line, r⁴.
        k5: f64,
        /// Radial below the line, r⁶.
        k6: f64,
    },
    /// Kannala and Brandt's fisheye.
    Fisheye {
        /// Of θ³.
        k1: f64,
        /// Of θ⁵.
        k2: f64,
        /// Of θ⁷.
        k3: f64,
        /// Of θ⁹.
        k4: f64,
    },
}

/// Newton steps of [`Distortion::undistort`]; real lenses need three or four.
const UNDISTORT_STEPS: usize = 20;
/// Steps of the search for a fisheye's angle, from the axis to a right angle.
const ANGLE_STEPS: u32 = 64;
/// Halvings of the angle's bracket at most; Newton's steps need five or so.
const ANGLE_HALVINGS: usize = 60;

impl Distortion {
    /// Whether the picture is an ideal pinhole's.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// The coefficients with their names, in OpenCV's order.
    pub fn coefficients(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::None => Vec::new(),
            Self::OpenCv { k1, k2, p1, p2, k3 } => {
                vec![("k1", k1), ("k2", k2), ("p1", p1), ("p2", p2), ("k3", k3)]
            }
            Self::Rational { k1, k2, p1, p2, k3, k4, k5, k6 } => vec![
                ("k1", k1),
                ("k2", k2),
                ("p1", p1),
                ("p2", p2),
                ("k3", k3),
                ("k4", k4),
                ("k5", k5),
                ("k6", k6),
            ],
            Self::Fisheye { k1, k2, k3, k4 } => vec![("k1", k1), ("k2", k2), ("k3", k3), ("k4", k4)],
        }
    }

    /// Where the lens puts a point of the plane Z = 1.
    pub fn distort(&self, plane: DVec2) -> DVec2 {
        let DVec2 { x, y } = plane;
        let r2 = x * x + y * y;
        let (radial, p1, p2) = match *self {
            Self::None => return plane,
            Self::Fisheye { .. } => return plane * self.radial(r2)[0],
            Self::OpenCv { p1, p2, .. } | Self::Rational { p1, p2, .. } => (self.radial(r2)[0], p1, p2),
        };
        DVec2::new(
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }

    /// The factor s, and `slope` with ds/dx = slope · x, at the squared radius.
    fn radial(&self, r2: f64) -> [f64; 2] {
        match *self {
            Self::None => [1.0, 0.0],
            Self::OpenCv { k1, k2, k3, .. } => {
                [1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3))]
            }
            Self::Rational { k1, k2, k3, k4, k5, k6, .. } => {
                let above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
                let below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
                let above_slope = 2.0 * (k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3));
                let below_slope = 2.0 * (k4 + r2 * (2.0 * k5 + 3.0 * r2 * k6));
                let radial = above / below;
                [radial, (above_slope - radial * below_slope) / below]
            }
            Self::Fisheye { k1, .. } => {
                // So near the axis the quotients below lose their digits; the series has them.
                if r2 < 1e-10 {
                    let second = k1 - 1.0 / 3.0;
                    return [1.0 + r2 * second, 2.0 * second];
                }
                let r = r2.sqrt();
                let [bent, bent_slope] = self.bent_angle(r.atan());
                let radial = bent / r;
                [radial, (bent_slope / (1.0 + r2) - radial) / r2]
            }
        }
    }

    /// A fisheye's θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) and its derivative.
    fn bent_angle(&self, angle: f64) -> [f64; 2] {
        let Self::Fisheye { k1, k2, k3, k4 } = *self else { return [angle, 1.0] };
        let t = angle * angle;
        [
            angle * (1.0 + t * (k1 + t * (k2 + t * (k3 + t * k4)))),
            1.0 + t * (3.0 * k1 + t * (5.0 * k2 + t * (7.0 * k3 + t * 9.0 * k4))),
        ]
    }

    fn jacobian(&self, plane: DVec2) -> DMat2 {
        let (p1, p2) = match *self {
            Self::None => return DMat2::IDENTITY,
            Self::Fisheye { .. } => (0.0, 0.0),
            Self::OpenCv { p1, p2, .. } | Self::Rational { p1, p2, .. } => (p1, p2),
        };
        let DVec2 { x, y } = plane;
        let [radial, slope] = self.radial(x * x + y * y);
        let cross = x * y * slope + 2.0 * (p1 * x + p2 * y);
        DMat2::from_cols(
            DVec2::new(radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, cross),
            DVec2::new(cross, radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x),
        )
    }

    /// The point of the plane that the lens puts at `distorted`, by Newton's method.
    ///
    /// `None` where the model folds over and has no inverse: far outside any calibrated picture.
    pub fn undistort(&self, distorted: DVec2) -> Option<DVec2> {
        match self {
            Self::None => return Some(distorted),
            Self::Fisheye { .. } => return self.unbend(distorted),
            Self::OpenCv { .. } | Self::Rational { .. } => {}
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

    /// [`undistort`](Self::undistort) of a fisheye: the smallest angle that is bent to this one. `None` where the
    /// bent angle has stopped growing before, and at right angles and beyond.
    fn unbend(&self, distorted: DVec2) -> Option<DVec2> {
        let wanted = distorted.length();
        if !wanted.is_finite() {
            return None;
        }
        if wanted < 1e-8 {
            return Some(distorted);
        }
        let step = std::f64::consts::FRAC_PI_2 / f64::from(ANGLE_STEPS);
        let (mut low, mut high) = (0.0, None);
        for index in 1..=ANGLE_STEPS {
            let angle = f64::from(index) * step;
            let [bent, slope] = self.bent_angle(angle);
            if bent >= wanted {
                high = Some(angle);
                break;
            }
            if slope <= 0.0 {
                return None;
            }
            low = angle;
        }
        let mut high = high?;
        let mut angle = 0.5 * (low + high);
        for _ in 0..ANGLE_HALVINGS {
            let [bent, slope] = self.bent_angle(angle);
            if bent < wanted {
                low = angle;
            } else {
                high = angle;
            }
            let newton = angle - (bent - wanted) / slope;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let change = (next - angle).abs();
            angle = next;
            if change < 1e-16 {
                break;
            }
        }
        let [bent, slope] = self.bent_angle(angle);
        let is_good = (bent - wanted).abs() < 1e-12 && slope > 1e-6 && angle < std::f64::consts::FRAC_PI_2;
        is_good.then(|| distorted * (angle.tan() / wanted))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENS: Distortion = Distortion::OpenCv { k1: -0.28, k2: 0.09, p1: 6e-4, p2: -7e-4, k3: -0.012 };
    const RATIONAL: Distortion =
        Distortion::Rational { k1: 3.2, k2: 1.4, p1: 6e-4, p2: -7e-4, k3: 0.05, k4: 3.5, k5: 2.3, k6: 0.3 };
    const FISHEYE: Distortion = Distortion::Fisheye { k1: -0.06, k2: 0.011, k3: -0.004, k4: 3e-4 };

    #[test]
    fn undistort_undoes_distort() {
        for lens in [LENS, RATIONAL, FISHEYE] {
            for i in -8..=8 {
                for j in -8..=8 {
                    let plane = DVec2::new(f64::from(i), f64::from(j)) * 0.08;
                    let again = lens.undistort(lens.distort(plane)).unwrap();
                    assert!((again - plane).length() < 1e-10, "{lens:?}: {plane} {again}");
                }
            }
        }
    }

    #[test]
    fn a_fisheye_sees_nearly_sideways() {
        for degrees in [0.0_f64, 1e-7, 1e-3, 20.0, 60.0, 80.0, 88.0] {
            let plane = DVec2::from_angle(0.7) * degrees.to_radians().tan();
            let again = FISHEYE.undistort(FISHEYE.distort(plane)).unwrap();
            assert!((again - plane).length() < 1e-9 * (1.0 + plane.length_squared()), "{degrees}°: {again}");
        }
        // Beyond a right angle, and beyond the fold of a lens that has one.
        assert!(FISHEYE.undistort(DVec2::new(1.5, 0.0)).is_none());
        let folds = Distortion::Fisheye { k1: -0.5, k2: 0.0, k3: 0.0, k4: 0.0 };
        assert!(folds.undistort(DVec2::new(0.5, 0.0)).is_some());
        assert!(folds.undistort(DVec2::new(0.56, 0.0)).is_none());
        assert!(folds.undistort(DVec2::NAN).is_none());
    }

    #[test]
    fn a_rational_lens_without_a_denominator_is_the_plain_one() {
        let plain = Distortion::Rational {
            k1: -0.28,
            k2: 0.09,
            p1: 6e-4,
            p2: -7e-4,
            k3: -0.012,
            k4: 0.0,
            k5: 0.0,
            k6: 0.0,
        };
        let at = DVec2::new(0.41, -0.3);
        assert_eq!(plain.distort(at), LENS.distort(at));
    }

    #[test]
    fn jacobian_matches_differences() {
        let h = 1e-6;
        for lens in [LENS, RATIONAL, FISHEYE] {
            for at in [DVec2::new(0.4, -0.3), DVec2::new(1e-7, 2e-6), DVec2::new(-0.9, 0.8)] {
                for e in [DVec2::X, DVec2::Y] {
                    let numeric = (lens.distort(at + e * h) - lens.distort(at - e * h)) / (2.0 * h);
                    let error = (numeric - lens.jacobian(at) * e).length();
                    assert!(error < 1e-8, "{lens:?} at {at}: {error:e}");
                }
            }
        }
    }
}
