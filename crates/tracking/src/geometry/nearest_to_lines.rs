//! The point that is nearest to several lines.

use glam::{DMat3, DVec3};

/// The point x that is nearest to lines through cᵢ along unit directions rᵢ, in the sense of least squares:
///
/// ```text
/// Σ wᵢ (I − rᵢ rᵢᵀ) x = Σ wᵢ (I − rᵢ rᵢᵀ) cᵢ
/// ```
#[derive(Debug, Clone, Copy)]
pub struct NearestToLines {
    matrix: DMat3,
    right: DVec3,
}

impl Default for NearestToLines {
    fn default() -> Self {
        Self { matrix: DMat3::ZERO, right: DVec3::ZERO }
    }
}

impl NearestToLines {
    /// Adds a line through a point, metres, along a unit direction.
    pub fn add(&mut self, through: DVec3, direction: DVec3, weight: f64) {
        let across = across(direction);
        self.matrix += across * weight;
        self.right += across * through * weight;
    }

    /// Pulls towards a point, which also keeps parallel lines solvable.
    pub fn pull(&mut self, towards: DVec3, weight: f64) {
        self.matrix += DMat3::IDENTITY * weight;
        self.right += towards * weight;
    }

    /// How well the lines determine the point: 0 where they are parallel.
    #[must_use]
    pub fn determinant(&self) -> f64 {
        self.matrix.determinant()
    }

    /// The point; `None` where the lines do not determine it.
    #[must_use]
    pub fn solve(&self) -> Option<DVec3> {
        Some(self.matrix.inverse() * self.right).filter(|point| point.is_finite())
    }
}

/// I − r rᵀ: what of a vector is across a unit direction.
#[must_use]
pub fn across(direction: DVec3) -> DMat3 {
    DMat3::IDENTITY
        - DMat3::from_cols(direction * direction.x, direction * direction.y, direction * direction.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lines: &[(DVec3, DVec3)]) -> NearestToLines {
        let mut nearest = NearestToLines::default();
        lines.iter().for_each(|(through, direction)| nearest.add(*through, direction.normalize(), 1.0));
        nearest
    }

    #[test]
    fn lines_that_meet_meet_there_and_skew_ones_between() {
        let (meeting, a, b) =
            (DVec3::new(0.3, -1.0, 2.0), DVec3::new(1.0, 2.0, 0.5), DVec3::new(-1.0, 0.4, 3.0));
        let found = of(&[(meeting + 3.0 * a, a), (meeting - 2.0 * b, b)]).solve().unwrap();
        assert!(found.distance(meeting) < 1e-12, "{found}");
        let between = of(&[(DVec3::ZERO, DVec3::X), (DVec3::new(0.0, 0.0, 2.0), DVec3::Y)]).solve().unwrap();
        assert!(between.distance(DVec3::Z) < 1e-12, "{between}");
    }

    #[test]
    fn parallel_lines_do_not_determine_a_point_until_it_is_pulled() {
        let mut parallel = of(&[(DVec3::ZERO, DVec3::X), (DVec3::Z, DVec3::X)]);
        assert_eq!((parallel.determinant(), parallel.solve()), (0.0, None));
        parallel.pull(DVec3::new(4.0, 0.0, 0.5), 1e-6);
        let found = parallel.solve().unwrap();
        assert!(found.distance(DVec3::new(4.0, 0.0, 0.5)) < 1e-6, "{found}");
    }
}
