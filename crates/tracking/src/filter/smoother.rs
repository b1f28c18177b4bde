//! What later frames say of earlier ones (H. E. Rauch, F. Tung, C. T. Striebel, 1965).

use nalgebra::{DMatrix, DVector};

use super::Belief;
use super::FilterError;
use super::constant_velocity::ConstantVelocity;
use super::tangent;

/// Smooths a frame by the one after it: the step that its filtered mean pose takes, n numbers, and velocity and covariance given all
/// frames.
///
/// `filtered` is the belief at the frame, `predicted` what it predicted for the next one `seconds` later,
/// `next` what is believed there given all frames, and `difference` the step from the predicted to the smoothed
/// mean pose there; `model` predicted it. Covariances are of steps from their own mean pose ([`tangent`]).
///
/// # Errors
/// `predicted` is certain in some direction.
pub fn smooth(
    model: &ConstantVelocity,
    filtered: &Belief,
    predicted: &Belief,
    next: &Belief,
    difference: &DVector<f64>,
    seconds: f64,
) -> Result<(DVector<f64>, Belief), FilterError> {
    let n = filtered.columns();
    let transition = model.transition(&filtered.velocity, seconds);
    // Cᵀ = (P⁻)⁻¹ F P
    let factor = predicted.covariance.clone().cholesky().ok_or(FilterError::Certain)?;
    let gain_transposed = factor.solve(&(transition * &filtered.covariance));
    let gain: DMatrix<f64> = gain_transposed.transpose();
    let mut correction = DVector::zeros(2 * n);
    correction.rows_mut(0, n).copy_from(difference);
    correction.rows_mut(n, n).copy_from(&(&next.velocity - &predicted.velocity));
    let correction = &gain * correction;
    let next = next.about(&tangent::undo_reset(difference));
    let covariance =
        &filtered.covariance + &gain * (&next.covariance - &predicted.covariance) * gain_transposed;
    let covariance = (&covariance + covariance.transpose()) * 0.5;
    let velocity = &filtered.velocity + correction.rows(n, n);
    let step = correction.rows(0, n).into_owned();
    let belief = Belief { velocity, covariance }.about(&tangent::reset(&step));
    Ok((step, belief))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::update::update;

    /// One number seen in noise at five times: filter and smoother give what the joint least-squares problem
    /// over all states gives, mean and variance.
    #[test]
    fn the_smoother_is_the_joint_least_squares_solution() {
        let (seconds, variance, seen) = (0.1, 0.3, [0.2, 0.5, 0.1, 0.9, 1.4]);
        let model = ConstantVelocity { acceleration: DVector::from_element(1, 2.0), memory: 0.4 };
        let start = Belief::at_rest(&DVector::from_element(1, 1.0), &DVector::from_element(1, 3.0));
        let mut filtered: Vec<(f64, Belief)> = Vec::new();
        let mut predicted: Vec<(f64, Belief)> = Vec::new();
        for (frame, &value) in seen.iter().enumerate() {
            let (mean, belief) = match filtered.last() {
                None => (0.0, start.clone()),
                Some((mean, belief)) => {
                    let (step, belief) = model.predict(belief, seconds);
                    (mean + step[0], belief)
                }
            };
            predicted.push((mean, belief.clone()));
            let pose_variance = belief.pose_covariance()[(0, 0)];
            let step = (value - mean) * pose_variance / (pose_variance + variance);
            let products = DMatrix::from_element(1, 1, 1.0);
            let after = update(&belief, &DVector::from_element(1, step), &products, variance).unwrap().0;
            filtered.push((mean + step, after));
            assert_eq!(filtered.len(), frame + 1);
        }
        let mut smoothed = vec![filtered[4].clone()];
        for frame in (0..4).rev() {
            let (mean, belief) = &filtered[frame];
            let (predicted_mean, prior) = &predicted[frame + 1];
            let (next_mean, next) = smoothed.last().unwrap().clone();
            let difference = DVector::from_element(1, next_mean - predicted_mean);
            let (step, found) = smooth(&model, belief, prior, &next, &difference, seconds).unwrap();
            smoothed.push((mean + step[0], found));
        }
        smoothed.reverse();

        let size = 10;
        let (mut information, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let mut block = information.view_mut((0, 0), (2, 2));
        block += start.covariance.clone().try_inverse().unwrap();
        let none = Belief { velocity: DVector::zeros(1), covariance: DMatrix::zeros(2, 2) };
        let noise = model.predict(&none, seconds).1.covariance.try_inverse().unwrap();
        let transition = model.transition(&DVector::zeros(1), seconds);
        for frame in 0..4 {
            let mut difference = DMatrix::zeros(2, size);
            difference.view_mut((0, 2 * frame), (2, 2)).copy_from(&-&transition);
            difference.view_mut((0, 2 * frame + 2), (2, 2)).copy_from(&DMatrix::identity(2, 2));
            information += difference.transpose() * &noise * difference;
        }
        for (frame, value) in seen.into_iter().enumerate() {
            information[(2 * frame, 2 * frame)] += 1.0 / variance;
            right[2 * frame] += value / variance;
        }
        let covariance = information.try_inverse().unwrap();
        let mean = &covariance * right;
        for (frame, (pose, belief)) in smoothed.iter().enumerate() {
            assert!((pose - mean[2 * frame]).abs() < 1e-9, "{frame}");
            assert!((belief.velocity[0] - mean[2 * frame + 1]).abs() < 1e-8, "{frame}");
            let expected = covariance.view((2 * frame, 2 * frame), (2, 2));
            assert!((&belief.covariance - expected).amax() < 1e-8, "{frame}");
        }
    }
}
