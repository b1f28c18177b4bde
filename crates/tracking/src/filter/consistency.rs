//! Does a filter err as it says? Sums of squares in its own units, against the chi-square law.
//!
//! If belief and errors are of one model, then with ν what a measurement adds to what was predicted and S its covariance,
//! and with e the error of the state against the truth and P its covariance,
//!
//! | | | |
//! |---|---|---|
//! | NIS, normalised innovation squared | νᵀ S⁻¹ ν | χ² of as many degrees as directions are seen |
//! | NEES, normalised estimation error squared | eᵀ P⁻¹ e | χ² of as many degrees as the state has columns |
//!
//! and so are their sums over frames (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking
//! and Navigation", 2001, section 5.4). A sum above the bounds is a filter that is too sure of itself.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};

/// A sum of squares and its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Innovation {
    /// νᵀ S⁻¹ ν.
    pub squared: f64,
    /// Directions that are seen.
    pub directions: usize,
}

impl Innovation {
    /// The mean square: 1 where errors are as the model says. `None` where nothing is seen.
    pub fn ratio(self) -> Option<f64> {
        (self.directions > 0).then(|| self.squared / self.directions as f64)
    }
}

impl AddAssign for Innovation {
    fn add_assign(&mut self, other: Self) {
        self.squared += other.squared;
        self.directions += other.directions;
    }
}

/// eᵀ P⁻¹ e. `None` if the covariance is certain in some direction.
pub fn normalised_square(error: &DVector<f64>, covariance: &DMatrix<f64>) -> Option<f64> {
    Some(error.dot(&covariance.clone().cholesky()?.solve(error)))
}

/// Between these 95 of 100 sums of `degrees` squares of unit normal numbers lie, divided by `degrees`
/// (E. B. Wilson, M. M. Hilferty, 1931: within 1 % from twenty degrees on).
pub fn chi_square_bounds(degrees: usize) -> [f64; 2] {
    let spread = 2.0 / (9.0 * degrees.max(1) as f64);
    [-1.959_964, 1.959_964].map(|z: f64| (1.0 - spread + z * spread.sqrt()).powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounds_are_the_tables() {
        // From tables of the chi-square distribution: 2.5 % and 97.5 %.
        for (degrees, table) in [(20, [9.591, 34.170]), (100, [74.222, 129.561])] {
            for (found, expected) in chi_square_bounds(degrees).into_iter().zip(table) {
                assert!(
                    (found * degrees as f64 / expected - 1.0).abs() < 0.01,
                    "{degrees}: {found} {expected}"
                );
            }
        }
    }
}
