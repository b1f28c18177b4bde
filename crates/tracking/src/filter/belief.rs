//! A Gaussian over a pose and its velocity.

use nalgebra::{DMatrix, DVector};

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
    #[must_use]
    pub fn at_rest(pose_deviation: &DVector<f64>, velocity_deviation: &DVector<f64>) -> Self {
        let n = pose_deviation.len();
        assert_eq!(n, velocity_deviation.len(), "one velocity for every column of the pose");
        let deviations = pose_deviation.iter().chain(velocity_deviation.iter());
        let variances = DVector::from_iterator(2 * n, deviations.map(|deviation| deviation * deviation));
        Self { velocity: DVector::zeros(n), covariance: DMatrix::from_diagonal(&variances) }
    }

    /// n velocities and the covariance's 4 n² numbers, column after column; `None` where those are not so many.
    #[must_use]
    pub fn from_numbers(velocity: Vec<f64>, covariance: Vec<f64>) -> Option<Self> {
        let size = 2 * velocity.len();
        (covariance.len() == size * size).then(|| Self {
            velocity: DVector::from_vec(velocity),
            covariance: DMatrix::from_vec(size, size, covariance),
        })
    }

    /// The numbers that [`from_numbers`](Self::from_numbers) takes.
    #[must_use]
    pub fn numbers(&self) -> (&[f64], &[f64]) {
        (self.velocity.as_slice(), self.covariance.as_slice())
    }

    /// n: columns of the pose.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.velocity.len()
    }

    /// Covariance of the pose alone, n × n.
    #[must_use]
    pub fn pose_covariance(&self) -> DMatrix<f64> {
        let n = self.columns();
        self.covariance.view((0, 0), (n, n)).into_owned()
    }

    /// The same belief about another mean pose: G P Gᵀ, with G (n × n) what becomes of a step of the pose.
    #[must_use]
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
    #[must_use]
    pub fn pose_information(&self) -> Option<DMatrix<f64>> {
        self.pose_covariance().cholesky().map(|factor| factor.inverse())
    }
}
