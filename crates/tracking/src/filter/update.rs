//! What a measurement adds to a belief, in information form.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;

/// The belief after a measurement.
///
/// `step` leads from the predicted mean pose to the pose that minimises ‖D − Λ‖²/R + δᵀ Pₓₓ⁻¹ δ, n numbers;
/// `products` is JᵀJ there, n × n, without any prior; `variance` is R, squared grey levels. The velocity
/// follows by what it has to do with the pose, v + Pᵥₓ Pₓₓ⁻¹ δ.
///
/// `None` if the prior is certain of the pose in some direction or the numbers ran out of range.
#[must_use]
pub fn update(prior: &Belief, step: &DVector<f64>, products: &DMatrix<f64>, variance: f64) -> Option<Belief> {
    let n = prior.columns();
    let covariance = &prior.covariance;
    let to_pose = covariance.columns(0, n);
    let pose = prior.pose_covariance();
    let weighted = pose.clone().cholesky()?.solve(step);
    let velocity = &prior.velocity + covariance.view((n, 0), (n, n)) * weighted;
    // P − P[.., x] (I + Λ P_xx)⁻¹ Λ P[x, ..], with Λ = JᵀJ/R: no inverse of a P that is nearly singular.
    let information = products / variance;
    let system = DMatrix::identity(n, n) + &information * &pose;
    let gain = system.lu().solve(&(information * to_pose.transpose()))?;
    let covariance = covariance - to_pose * gain;
    let covariance = (&covariance + covariance.transpose()) * 0.5;
    let is_finite = velocity.iter().chain(covariance.iter()).all(|value| value.is_finite());
    is_finite.then_some(Belief { velocity, covariance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::ConstantVelocity;
    use crate::optimize::NormalEquations;

    fn prior() -> Belief {
        let model = ConstantVelocity { acceleration: DVector::from_element(3, 1.5) };
        let start = Belief::at_rest(&DVector::from_element(3, 0.2), &DVector::from_element(3, 0.9));
        model.predict(&start, 0.1).1
    }

    fn jacobian() -> DMatrix<f64> {
        DMatrix::from_fn(5, 3, |i, j| ((3 * i + 7 * j) as f64).sin())
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
        let found = update(&prior, &step, &jacobian.tr_mul(&jacobian), variance).unwrap();
        let mut observed = DMatrix::zeros(5, 6);
        observed.columns_mut(0, 3).copy_from(&jacobian);
        let innovation =
            &observed * &prior.covariance * observed.transpose() + DMatrix::identity(5, 5) * variance;
        let gain = &prior.covariance * observed.transpose() * innovation.try_inverse().unwrap();
        let mean = &gain * residual;
        let covariance = (DMatrix::identity(6, 6) - gain * observed) * &prior.covariance;
        assert!((mean.rows(0, 3) - step).amax() < 1e-10);
        assert!((mean.rows(3, 3) + &prior.velocity - found.velocity).amax() < 1e-10);
        assert!((covariance - found.covariance).amax() < 1e-10);
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
            let found = update(&prior, &step, &products, variance).unwrap().pose_covariance();
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
        let found = update(&prior, &DVector::zeros(3), &products, 1.0).unwrap();
        assert!(found.covariance[(0, 0)] < 0.5 * prior.covariance[(0, 0)]);
        assert!((found.covariance[(1, 1)] - prior.covariance[(1, 1)]).abs() < 1e-15);
    }
}
