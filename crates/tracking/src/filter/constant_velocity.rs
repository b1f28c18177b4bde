//! Motion goes on as it was, but for white accelerations.

use nalgebra::{DMatrix, DVector};

use super::belief::Belief;

/// The motion model: Q = q² [|Δ|³/3, Δ|Δ|/2; Δ|Δ|/2, |Δ|] for each column of the pose.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstantVelocity {
    /// q of each column: tangent units per s^1.5. After one second of it a velocity that was certain has the
    /// standard deviation q.
    pub acceleration: DVector<f64>,
}

impl ConstantVelocity {
    /// F for a time in seconds, negative backwards: 2n × 2n.
    #[must_use]
    pub fn transition(columns: usize, seconds: f64) -> DMatrix<f64> {
        let mut transition = DMatrix::identity(2 * columns, 2 * columns);
        for column in 0..columns {
            transition[(column, columns + column)] = seconds;
        }
        transition
    }

    /// The belief after a time in seconds, negative backwards, and the step v Δ that the mean pose takes.
    #[must_use]
    pub fn predict(&self, belief: &Belief, seconds: f64) -> (DVector<f64>, Belief) {
        let n = belief.columns();
        let transition = Self::transition(n, seconds);
        let mut covariance = &transition * &belief.covariance * transition.transpose();
        let span = seconds.abs();
        for (column, density) in self.acceleration.iter().enumerate() {
            let variance = density * density;
            covariance[(column, column)] += variance * span.powi(3) / 3.0;
            covariance[(n + column, n + column)] += variance * span;
            covariance[(column, n + column)] += variance * seconds * span / 2.0;
            covariance[(n + column, column)] += variance * seconds * span / 2.0;
        }
        (&belief.velocity * seconds, Belief { velocity: belief.velocity.clone(), covariance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_short_steps_are_one_long_one() {
        let model = ConstantVelocity { acceleration: DVector::from_vec(vec![0.7, 2.0]) };
        let mut belief =
            Belief::at_rest(&DVector::from_vec(vec![0.1, 0.2]), &DVector::from_vec(vec![1.0, 0.5]));
        belief.velocity = DVector::from_vec(vec![0.3, -0.4]);
        for seconds in [0.2, -0.2] {
            let (first, half) = model.predict(&belief, seconds / 2.0);
            let (second, twice) = model.predict(&half, seconds / 2.0);
            let (step, once) = model.predict(&belief, seconds);
            assert!((first + second - step).norm() < 1e-15);
            assert!((twice.covariance - once.covariance).amax() < 1e-15);
        }
    }
}
