//! Motion goes on as it was, but for white accelerations, and fades.
//!
//! dv = −v dt/τ + q dw: each velocity is an Ornstein-Uhlenbeck process, so that it is no larger after a long time unseen
//! than bodies are fast, q √(τ/2) in a second as in an hour. With f = e^(−Δ/τ), for each column of the pose,
//!
//! | | | for Δ ≪ τ |
//! |---|---|---|
//! | step | τ (1 − f) v | Δ v |
//! | velocity | f v | v |
//! | Q of the step | q² τ² (Δ − 2 τ (1 − f) + τ (1 − f²)/2) | q² Δ³/3 |
//! | Q of both | q² τ² (1 − f)²/2 | q² Δ²/2 |
//! | Q of the velocity | q² τ (1 − f²)/2 | q² Δ |
//!
//! Backwards in time the motion fades as well: Δ is the time's length, steps and the covariance of both change their sign.

use nalgebra::{DMatrix, DVector};

use super::tangent;

/// Times of less than this share of τ: series, where the closed forms would lose their digits.
const SHORT: f64 = 1e-3;

/// The motion model.
#[derive(Debug, Clone, PartialEq)]
pub struct ConstantVelocity {
    /// q of each column: tangent units per s^1.5. After one second of it a velocity that was certain has about the
    /// standard deviation q.
    pub acceleration: DVector<f64>,
    /// τ, seconds: after it 1/e is left of a velocity. Infinite: it never fades.
    pub memory: f64,
}

/// What a time does to one column.
struct Span {
    /// Step per velocity, seconds, with the time's sign.
    reach: f64,
    /// Share of the velocity that is left.
    left: f64,
    /// Q of step, of both and of velocity, per q².
    noise: [f64; 3],
}

impl ConstantVelocity {
    fn span(&self, seconds: f64) -> Span {
        let (tau, span) = (self.memory, seconds.abs());
        let share = span / tau;
        let sign = if seconds < 0.0 { -1.0 } else { 1.0 };
        if share < SHORT {
            return Span {
                reach: seconds * (1.0 - share / 2.0 + share * share / 6.0),
                left: (-share).exp(),
                noise: [
                    span.powi(3) * (1.0 / 3.0 - share / 4.0 + 7.0 * share * share / 60.0),
                    sign * span.powi(2) * (0.5 - share / 2.0 + 7.0 * share * share / 24.0),
                    span * (1.0 - share + 2.0 * share * share / 3.0),
                ],
            };
        }
        let (lost, lost_twice) = (-(-share).exp_m1(), -(-2.0 * share).exp_m1());
        Span {
            reach: sign * tau * lost,
            left: 1.0 - lost,
            noise: [
                tau * tau * (span - 2.0 * tau * lost + 0.5 * tau * lost_twice),
                sign * 0.5 * (tau * lost).powi(2),
                0.5 * tau * lost_twice,
            ],
        }
    }

    /// F of a motion with this velocity for a time in seconds, negative backwards: 2n × 2n.
    pub fn transition(&self, velocity: &DVector<f64>, seconds: f64) -> DMatrix<f64> {
        let n = velocity.len();
        let span = self.span(seconds);
        let mut transition = tangent::transition(velocity, span.reach);
        (n..2 * n).for_each(|column| transition[(column, column)] = span.left);
        transition
    }

    /// The belief after a time in seconds, negative backwards, and the step that the mean pose takes.
    ///
    /// Accelerations are alike in all directions of a rotation, so the turn of the tangent space leaves Q as it is.
    pub fn predict(&self, belief: &Belief, seconds: f64) -> (DVector<f64>, Belief) {
        let n = belief.columns();
        let transition = self.transition(&belief.velocity, seconds);
        let mut covariance = &transition * &belief.covariance * transition.transpose();
        let Span { reach, left, noise: [of_step, of_both, of_velocity] } = self.span(seconds);
        for (column, density) in self.acceleration.iter().enumerate() {
            let variance = density * density;
            covariance[(column, column)] += variance * of_step;
            covariance[(n + column, n + column)] += variance * of_velocity;
            covariance[(column, n + column)] += variance * of_both;
            covariance[(n + column, column)] += variance * of_both;
        }
        (&belief.velocity * reach, Belief { velocity: &belief.velocity * left, covariance })
    }
}

/// What is believed of a pose and its velocity; the mean pose itself is kept by whoever knows poses.
#[derive(Debug, Clone, PartialEq)]
pub struct Belief {
    /// Mean velocity, n numbers: tangent units per second.
    pub velocity: DVector<f64>,
    /// Covariance of (δ, v), 2n × 2n.
    pub covariance: DMatrix<f64>,
}

impl Belief {
    /// At rest, with independent standard deviations of the pose and of the velocity, n numbers each.
    ///
    /// # Panics
    /// If the two differ in length.
    pub fn at_rest(pose_deviation: &DVector<f64>, velocity_deviation: &DVector<f64>) -> Self {
        let n = pose_deviation.len();
        assert_eq!(n, velocity_deviation.len(), "one velocity for every column of the pose");
        let deviations = pose_deviation.iter().chain(velocity_deviation.iter());
        let variances = DVector::from_iterator(2 * n, deviations.map(|deviation| deviation * deviation));
        Self { velocity: DVector::zeros(n), covariance: DMatrix::from_diagonal(&variances) }
    }

    /// n velocities and the covariance's 4 n² numbers, column after column; `None` if the counts do not agree.
    pub fn from_numbers(velocity: Vec<f64>, covariance: Vec<f64>) -> Option<Self> {
        let size = 2 * velocity.len();
        (covariance.len() == size * size).then(|| Self {
            velocity: DVector::from_vec(velocity),
            covariance: DMatrix::from_vec(size, size, covariance),
        })
    }

    /// The numbers that [`from_numbers`](Self::from_numbers) takes.
    pub fn numbers(&self) -> (&[f64], &[f64]) {
        (self.velocity.as_slice(), self.covariance.as_slice())
    }

    /// n: columns of the pose.
    pub fn columns(&self) -> usize {
        self.velocity.len()
    }

    /// Covariance of the pose alone, n × n.
    pub fn pose_covariance(&self) -> DMatrix<f64> {
        let n = self.columns();
        self.covariance.view((0, 0), (n, n)).into_owned()
    }

    /// The same belief about another mean pose: G P Gᵀ, with G (n × n) what becomes of a step of the pose.
    pub fn about(&self, reset: &DMatrix<f64>) -> Self {
        let n = self.columns();
        let mut covariance = self.covariance.clone();
        let of_pose = reset * covariance.rows(0, n);
        covariance.rows_mut(0, n).copy_from(&of_pose);
        let of_pose = covariance.columns(0, n) * reset.transpose();
        covariance.columns_mut(0, n).copy_from(&of_pose);
        Self { velocity: self.velocity.clone(), covariance }
    }

    /// Pₓₓ⁻¹, n × n: the information on the pose alone. `None` if the pose is certain in some direction.
    pub fn pose_information(&self) -> Option<DMatrix<f64>> {
        self.pose_covariance().cholesky().map(|factor| factor.inverse())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_short_steps_are_one_long_one() {
        for memory in [0.3, 12.0, 1e4, f64::INFINITY] {
            let model = ConstantVelocity { acceleration: DVector::from_vec(vec![0.7, 2.0]), memory };
            let mut belief =
                Belief::at_rest(&DVector::from_vec(vec![0.1, 0.2]), &DVector::from_vec(vec![1.0, 0.5]));
            belief.velocity = DVector::from_vec(vec![0.3, -0.4]);
            for seconds in [0.2, -0.2] {
                let (first, half) = model.predict(&belief, seconds / 2.0);
                let (second, twice) = model.predict(&half, seconds / 2.0);
                let (step, once) = model.predict(&belief, seconds);
                assert!((first + second - step).norm() < 1e-9, "{memory}");
                assert!((twice.velocity - once.velocity).norm() < 1e-9, "{memory}");
                assert!((twice.covariance - once.covariance).amax() < 1e-7, "{memory}");
            }
        }
    }

    /// Unseen for a minute: the velocity is as uncertain as any body's, and is expected to be none.
    #[test]
    fn what_is_not_seen_does_not_grow_faster_for_ever() {
        let model = ConstantVelocity { acceleration: DVector::from_element(1, 4.0), memory: 0.5 };
        let mut belief = Belief::at_rest(&DVector::from_element(1, 0.1), &DVector::from_element(1, 3.0));
        belief.velocity[0] = 2.0;
        let (step, after) = model.predict(&belief, 60.0);
        assert!((step[0] - 1.0).abs() < 1e-9, "no farther than v τ");
        assert!(after.velocity[0].abs() < 1e-12);
        assert!((after.covariance[(1, 1)].sqrt() - 2.0).abs() < 1e-9, "q √(τ/2)");
    }
}
