//! What is known of every pose, counted once and not in every frame again.
//!
//! A prior of poses says the same in every frame: as a measurement of each it would make a belief ever more certain. What it says
//! and what is believed have that much in common that of each direction the surer one counts. With Pₓₓ = L Lᵀ, the prior's
//! information B and its pull b = −½∇E at the mean pose, and the eigenvectors U and eigenvalues d of Lᵀ B L,
//!
//! Pₓₓ⁻¹ ← L⁻ᵀ U max(1, d) Uᵀ L⁻¹,  δ = L U ((d − 1)⁺/d²) Uᵀ Lᵀ b:
//!
//! the ellipsoidal intersection of the two (J. Sijs, M. Lazar, "State fusion with unknown correlation", 2012). Counting it again
//! changes nothing.

use nalgebra::{DMatrix, DVector};

use super::Belief;
use super::FilterError;
use super::update::update;

/// The belief with what it lacked of a prior, and the step that its mean pose takes, n numbers. `information` is n × n, positive
/// or zero in every direction, `pull` n numbers.
///
/// # Errors
/// The belief is certain of the pose in some direction, or the numbers ran out of range.
pub fn count_once(
    belief: &Belief,
    information: &DMatrix<f64>,
    pull: &DVector<f64>,
) -> Result<(DVector<f64>, Belief), FilterError> {
    let factor = belief.pose_covariance().cholesky().ok_or(FilterError::Certain)?.unpack();
    let whitened = factor.tr_mul(information) * &factor;
    if whitened.iter().any(|value| !value.is_finite()) {
        return Err(FilterError::NotFinite);
    }
    let known = whitened.symmetric_eigen();
    let lacks = known.eigenvalues.map(|value| (value - 1.0).max(0.0));
    let mut along = known.eigenvectors.tr_mul(&factor.tr_mul(pull));
    along.iter_mut().zip(&known.eigenvalues).zip(&lacks).for_each(|((along, value), lack)| {
        *along *= if *lack > 0.0 { lack / (value * value) } else { 0.0 };
    });
    let step = &factor * &known.eigenvectors * along;
    // Rows of U √(d − 1)⁺ Uᵀ L⁻¹: a measurement of unit variance with what is lacking.
    let rows = factor
        .transpose()
        .solve_upper_triangular(&(known.eigenvectors * DMatrix::from_diagonal(&lacks.map(f64::sqrt))))
        .ok_or(FilterError::Certain)?;
    let (belief, _) = update(belief, &step, &(&rows * rows.transpose()), 1.0)?;
    Ok((step, belief))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn belief() -> Belief {
        let mut belief =
            Belief::at_rest(&DVector::from_vec(vec![0.1, 2.0, 0.5]), &DVector::from_element(3, 1.0));
        (belief.covariance[(0, 1)], belief.covariance[(1, 0)]) = (0.05, 0.05);
        belief
    }

    /// Directions that are known better than the prior stay, the others get its variance and its mean; and a second time changes
    /// nothing.
    #[test]
    fn a_prior_counts_once() {
        // Variances 4 and 0.04 on the last two, of nothing on the first; means 0.9 and −0.3 away.
        let information = DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, 0.01, 25.0]));
        let pull = DVector::from_vec(vec![0.0, 0.01 * 0.9, 25.0 * -0.3]);
        let (step, once) = count_once(&belief(), &information, &pull).unwrap();
        assert!((once.covariance[(2, 2)] - 0.04).abs() < 1e-9, "{}", once.covariance);
        assert!((once.covariance[(1, 1)] - 4.0).abs() < 1e-6 && step[1].abs() < 1e-9, "{step}");
        // Of the mean as much as of the variance: (d − 1)/d with d = 25 · 0.25.
        assert!((step[2] + 0.3 * (6.25 - 1.0) / 6.25).abs() < 1e-9, "{step}");
        let left = DVector::from_vec(vec![0.0, 0.0, pull[2] - 25.0 * step[2]]);
        let (again, twice) = count_once(&once, &information, &left).unwrap();
        assert!(again.norm() < 1e-9 && (twice.covariance - once.covariance).amax() < 1e-6);
    }

    #[test]
    fn numbers_out_of_range_are_an_error() {
        let none = DVector::zeros(3);
        let information = DMatrix::from_element(3, 3, f64::INFINITY);
        assert_eq!(count_once(&belief(), &information, &none).unwrap_err(), FilterError::NotFinite);
    }
}
