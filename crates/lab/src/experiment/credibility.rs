//! Whether a Kalman filter errs as it says: NIS and NEES of a track whose true poses are known.
//!
//! With ν and S the innovation and its covariance, p and p̂ a joint's true and believed place, and C = K P Kᵀ what the belief makes
//! of the joint (∂p/∂δ = K, 3 × n),
//!
//! | | | degrees of freedom |
//! |---|---|---|
//! | NIS | Σ νᵀ S⁻¹ ν, by frame | directions that are seen |
//! | NEES | Σ (p − p̂)ᵀ C⁻¹ (p − p̂), by frame and joint | three a joint |
//!
//! and each divided by its degrees is 1 if the filter is honest, above 1 if it believes too much (Y. Bar-Shalom, X. R. Li,
//! T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section 5.4). Errors are those of joints and not
//! of the state: along a limb's twist nothing is seen, so that there e Pᵀ e tells of what was assumed, while a joint moves only by
//! what silhouettes can tell. Joints of a frame err together; that widens the mean's spread and leaves its expectation
//! (X. R. Li, Z. Zhao, "Measuring estimator's credibility: noncredibility index", 2006).

use std::ops::AddAssign;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::filter::Innovation;
use backlit_tracking::observability::believed_joints;
use backlit_tracking::track::FrameEstimate;

/// Sums over frames; one that was lost, or where a filter began, says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Credibility {
    /// νᵀ S⁻¹ ν over the directions that are seen.
    pub innovation: Innovation,
    /// The same sum of joints' errors, over three directions a joint.
    pub error: Innovation,
}

impl Credibility {
    /// Of one frame with this true pose.
    #[must_use]
    pub fn of_frame(model: &Model, estimate: &FrameEstimate, truth: &Pose) -> Self {
        let Some(belief) = estimate.belief.as_ref().filter(|_| !estimate.is_lost()) else {
            return Self::default();
        };
        let Some(innovation) = belief.innovation else { return Self::default() };
        let truth_at = Kinematics::new(model, truth);
        let mut error = Innovation::default();
        for joint in believed_joints(model, &estimate.pose, &belief.belief.pose_covariance()) {
            let place = joint.limb.map_or(truth.root, |limb| truth_at.ends()[limb]);
            if let Some(squared) = joint.error_squared(place) {
                error += Innovation { squared, directions: 3 };
            }
        }
        Self { innovation, error }
    }

    /// The normalised innovation squared.
    #[must_use]
    pub fn nis(self) -> Option<f64> {
        self.innovation.ratio()
    }

    /// The normalised estimation error squared.
    #[must_use]
    pub fn nees(self) -> Option<f64> {
        self.error.ratio()
    }
}

impl AddAssign for Credibility {
    fn add_assign(&mut self, other: Self) {
        self.innovation += other.innovation;
        self.error += other.error;
    }
}
