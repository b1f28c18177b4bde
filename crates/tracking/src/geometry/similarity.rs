//! The similarity that lays points over others (S. Umeyama, IEEE PAMI 13(4), 1991).

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, Vector3};

/// p ↦ to + scale · rotation · (p − from).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// Above 0.
    pub scale: f64,
    /// Without reflection.
    pub rotation: DMat3,
    /// Centroid of the points.
    pub from: DVec3,
    /// Centroid of the target.
    pub to: DVec3,
}

impl Similarity {
    /// Where a point goes.
    pub fn apply(&self, point: DVec3) -> DVec3 {
        self.to + self.scale * (self.rotation * (point - self.from))
    }
}

/// The similarity with the least Σ |target − similarity(point)|². `None` where the points have no extent.
pub fn umeyama(points: &[DVec3], target: &[DVec3]) -> Option<Similarity> {
    let count = points.len() as f64;
    let centroid = |points: &[DVec3]| points.iter().sum::<DVec3>() / count;
    let (from, to) = (centroid(points), centroid(target));
    let (mut covariance, mut spread) = (Matrix3::zeros(), 0.0);
    for (point, target) in points.iter().zip(target) {
        let (a, b) = (*point - from, *target - to);
        covariance += Vector3::from(b.to_array()) * Vector3::from(a.to_array()).transpose();
        spread += a.length_squared();
    }
    let svd = covariance.svd(true, true);
    let (u, vt) = (svd.u?, svd.v_t?);
    let mirror = if (u * vt).determinant() < 0.0 { -1.0 } else { 1.0 };
    let signs = Vector3::new(1.0, 1.0, mirror);
    let rotation = u * Matrix3::from_diagonal(&signs) * vt;
    let scale = svd.singular_values.dot(&signs) / spread;
    let rotation = DMat3::from_cols_slice(rotation.as_slice());
    (scale.is_finite() && scale > 0.0).then_some(Similarity { scale, rotation, from, to })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rotation::exp;

    #[test]
    fn a_similarity_is_found_again() {
        let rotation = DMat3::from_quat(exp(DVec3::new(0.3, -1.0, 0.4)));
        let points: Vec<DVec3> =
            (0..9).map(|k| DVec3::new((k as f64).sin(), (2.0 * k as f64).cos(), 0.3 * k as f64)).collect();
        let target: Vec<DVec3> = points.iter().map(|&p| 1.7 * (rotation * p) + DVec3::ONE).collect();
        let found = umeyama(&points, &target).unwrap();
        assert!((found.scale - 1.7).abs() < 1e-12 && found.rotation.abs_diff_eq(rotation, 1e-12));
        let moved = |(&point, target): (&_, &DVec3)| found.apply(point).distance(*target) < 1e-12;
        assert!(points.iter().zip(&target).all(moved));
        assert_eq!(umeyama(&[DVec3::ONE; 3], &[DVec3::X; 3]), None);
    }
}
