//! What a measurement adds to a belief, in information form, by Joseph's formula.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector};

use super::Belief;
use super::FilterError;
use super::tangent;

/// A direction counts as seen where the measurement takes this share of its predicted variance off.
const SEEN: f64 = 0.1;

/// The normalised innovation squared, or a sum of such, and its degrees of freedom: χ² of as many degrees as directions are seen, if belief
/// and errors are of one model. ν is what a measurement adds to what was predicted, S its covariance.
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

/// The belief after a measurement, about the pose that the step leads to, and how the measurement agreed with what was predicted, over
/// the directions that it sees.
///
/// `step` leads from the predicted mean pose to the pose that minimises ‖D − Λ‖²/R + δᵀ Pₓₓ⁻¹ δ, n numbers;
/// `products` is JᵀJ there, n × n, without any prior; `variance` is R, squared grey levels. The velocity
/// follows by what it has to do with the pose, v + Pᵥₓ Pₓₓ⁻¹ δ.
///
/// The covariance is that of steps from the new mean ([`tangent::reset`]): P ← G P Gᵀ first, then Joseph's
/// (I − K H) P (I − K H)ᵀ + K R Kᵀ, which stays symmetric and positive whatever the rounding. With Pₓₓ = L Lᵀ and
/// M = Lᵀ JᵀJ L / R its K is P₍.,ₓ₎ L⁻ᵀ (I + M)⁻¹ Lᵀ Jᵀ/R: no inverse of what may be singular.
///
/// # Errors
/// The prior is certain of the pose in some direction, or the numbers ran out of range.
pub fn update(
    prior: &Belief,
    step: &DVector<f64>,
    products: &DMatrix<f64>,
    variance: f64,
) -> Result<(Belief, Innovation), FilterError> {
    let n = prior.columns();
    let cross = prior.covariance.view((n, 0), (n, n));
    let weighted = prior.pose_covariance().cholesky().ok_or(FilterError::Certain)?.solve(step);
    let velocity = &prior.velocity + cross * weighted;

    let prior = prior.about(&tangent::reset(step));
    let information = products / variance;
    let factor = prior.pose_covariance().cholesky().ok_or(FilterError::Certain)?.unpack();
    // Over the prior's own units: what it predicts has the unit covariance.
    let whitened = factor.solve_lower_triangular(step).ok_or(FilterError::Certain)?;
    let seen = factor.tr_mul(&information) * &factor;
    if seen.iter().any(|value| !value.is_finite()) {
        return Err(FilterError::NotFinite);
    }
    let seen = seen.symmetric_eigen();
    let innovation = innovation(&seen.eigenvectors.tr_mul(&whitened), &seen.eigenvalues);

    let mut shrunk = seen.eigenvectors.clone();
    for (mut column, value) in shrunk.column_iter_mut().zip(seen.eigenvalues.iter()) {
        column /= 1.0 + value.max(0.0);
    }
    // P₍.,ₓ₎ L⁻ᵀ, of which the pose's rows are L.
    let mut spread = DMatrix::zeros(2 * n, n);
    spread.rows_mut(0, n).copy_from(&factor);
    let of_velocity = factor
        .solve_lower_triangular(&prior.covariance.view((0, n), (n, n)).into_owned())
        .ok_or(FilterError::Certain)?;
    spread.rows_mut(n, n).copy_from(&of_velocity.transpose());
    let gain = spread * (shrunk * seen.eigenvectors.transpose()) * factor.transpose();
    let gained = &gain * &information;
    let mut kept = DMatrix::identity(2 * n, 2 * n);
    let mut pose_columns = kept.columns_mut(0, n);
    pose_columns -= &gained;
    let covariance = &kept * &prior.covariance * kept.transpose() + gained * gain.transpose();
    let covariance = (&covariance + covariance.transpose()) * 0.5;
    if velocity.iter().chain(covariance.iter()).all(|value| value.is_finite()) {
        Ok((Belief { velocity, covariance }, innovation))
    } else {
        Err(FilterError::NotFinite)
    }
}

/// With w the whitened step along an eigenvector of M and d its eigenvalue, the model says E w² = d/(1 + d).
fn innovation(whitened: &DVector<f64>, seen: &DVector<f64>) -> Innovation {
    let mut sum = Innovation::default();
    for (along, value) in whitened.iter().zip(seen.iter()) {
        let share = value / (1.0 + value);
        if share > SEEN {
            sum.squared += along * along / share;
            sum.directions += 1;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::ConstantVelocity;
    use crate::optimize::NormalEquations;

    fn prior() -> Belief {
        let model = ConstantVelocity { acceleration: DVector::from_element(3, 1.5), memory: 0.5 };
        let start = Belief::at_rest(&DVector::from_element(3, 0.2), &DVector::from_element(3, 0.9));
        model.predict(&start, 0.1).1
    }

    fn jacobian() -> DMatrix<f64> {
        // The product keeps the columns apart: sines of one frequency span no more than two directions.
        DMatrix::from_fn(5, 3, |i, j| ((3 * i + 7 * j + i * j) as f64).sin())
    }

    /// The equations of ‖ρ − J δ‖² + R δᵀ Pₓₓ⁻¹ δ about δ = 0.
    fn equations(residual: &DVector<f64>, information: &DMatrix<f64>, variance: f64) -> NormalEquations {
        let mut equations = NormalEquations::zeros(3);
        equations.jtj = jacobian().tr_mul(&jacobian()) + information * variance;
        equations.jtr = jacobian().tr_mul(residual);
        equations
    }

    /// A linear measurement: the step and the update are the textbook's Kalman filter.
    #[test]
    fn a_linear_update_is_kalmans() {
        let (prior, jacobian, variance) = (prior(), jacobian(), 0.4);
        let residual = DVector::from_fn(5, |i, _| (i as f64).cos());
        let step = equations(&residual, &prior.pose_information().unwrap(), variance).step(0.0);
        let (found, _) = update(&prior, &step, &jacobian.tr_mul(&jacobian), variance).unwrap();
        let mut observed = DMatrix::zeros(5, 6);
        observed.columns_mut(0, 3).copy_from(&jacobian);
        let innovation =
            &observed * &prior.covariance * observed.transpose() + DMatrix::identity(5, 5) * variance;
        let gain = &prior.covariance * observed.transpose() * innovation.try_inverse().unwrap();
        let mean = &gain * &residual;
        let covariance = (DMatrix::identity(6, 6) - gain * observed) * &prior.covariance;
        assert!((mean.rows(0, 3) - step).amax() < 1e-10);
        assert!((mean.rows(3, 3) + &prior.velocity - found.velocity).amax() < 1e-10);
        assert!((covariance - found.covariance).amax() < 1e-10);
    }

    /// The innovation is the textbook's νᵀ S⁻¹ ν over the three directions that five numbers tell of well.
    #[test]
    fn the_innovation_is_kalmans() {
        let (prior, jacobian, variance) = (prior(), jacobian(), 1e-4);
        let residual = DVector::from_fn(5, |i, _| (i as f64).cos());
        let step = equations(&residual, &prior.pose_information().unwrap(), variance).step(0.0);
        let found = update(&prior, &step, &jacobian.tr_mul(&jacobian), variance).unwrap().1;
        let pseudo_inverse = jacobian.pseudo_inverse(1e-12).unwrap();
        let seen = &pseudo_inverse * residual;
        let spread = prior.pose_covariance() + &pseudo_inverse * pseudo_inverse.transpose() * variance;
        let expected = seen.dot(&(spread.try_inverse().unwrap() * &seen));
        assert_eq!(found.directions, 3);
        assert!((found.squared / expected - 1.0).abs() < 1e-6, "{found:?} {expected}");
    }

    /// As R → 0 the filter's step is Gauss-Newton's, and the pose is as certain as the measurement.
    #[test]
    fn without_measurement_noise_it_is_gauss_newton() {
        let prior = prior();
        let residual = DVector::from_fn(5, |i, _| (i as f64 * 1.3).sin());
        let information = prior.pose_information().unwrap();
        let plain = equations(&residual, &DMatrix::zeros(3, 3), 0.0).step(0.0);
        let mut last = f64::INFINITY;
        for variance in [1e-2, 1e-4, 1e-6, 1e-8] {
            let step = equations(&residual, &information, variance).step(0.0);
            let difference = (&step - &plain).norm();
            assert!(difference < 0.02 * last, "{variance}: {difference}, {last} before");
            last = difference;
            let products = jacobian().tr_mul(&jacobian());
            let found = update(&prior, &step, &products, variance).unwrap().0.pose_covariance();
            let measured = products.try_inverse().unwrap() * variance;
            // (A + Λ)⁻¹ = A⁻¹ − A⁻¹ Λ A⁻¹ + …, and rounding of the difference of two numbers near one.
            let second_order = information.norm() * measured.norm_squared();
            assert!((found - &measured).norm() <= second_order + 1e-13, "{variance}");
        }
        assert!(last < 1e-6 * plain.norm());
    }

    /// Directions that no pixel sees keep the prior's variance: no division by nothing.
    #[test]
    fn what_is_not_seen_stays_uncertain() {
        let prior = prior();
        let mut products = DMatrix::zeros(3, 3);
        products[(0, 0)] = 100.0;
        let (found, _) = update(&prior, &DVector::zeros(3), &products, 1.0).unwrap();
        assert!(found.covariance[(0, 0)] < 0.5 * prior.covariance[(0, 0)]);
        assert!((found.covariance[(1, 1)] - prior.covariance[(1, 1)]).abs() < 1e-15);
    }
}
