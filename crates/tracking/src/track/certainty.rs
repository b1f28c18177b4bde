//! How sure a Kalman filter may be: R of a frame, Q of joints, and what is known of every pose.
//!
//! **R.** Pixels err together over whole edges. With σ² and κ of a frame's residuals ([`observability`](crate::observability)) and
//! a fit that looks at every s-th pixel across and down, its pose errs as if independent pixels had the variance
//!
//! R = c σ² max(κ, s²):
//!
//! pixels that are skipped say nothing of their own, and those that are looked at no more than κ lets them. c is what the fit takes
//! off its own residuals beyond the degrees of freedom, as it was measured on pictures of known poses.
//!
//! **What is known of poses**, by the prior of poses, if it pulls, and by how far limbs twist, counts once
//! ([`count_once`](crate::filter::count_once)) and never as a measurement; limits bound the pose and say nothing of its covariance.

use super::motion::{ConditionedPrediction, KalmanOptions, Motion, MotionModel};
use super::tracker::Tracker;
use crate::body::{Kinematics, Parameters, Pose};
use crate::cancel::CancelToken;
use crate::filter::FilterError;
use crate::fit::{Fit, FitView};
use crate::observability::{FrameInformation, Noise};
use crate::optimize::NormalEquations;
use crate::residual::learnt_prior::{BoundPrior, LearntPrior};
use crate::residual::pose_prior;

/// c.
const OWN_SHARE: f64 = 1.7;
/// √R where residuals say nothing, and the least that is believed of them, grey levels.
const USUAL_DEVIATION: f64 = 100.0;
const LEAST_DEVIATION: f64 = 10.0;
/// Standard deviation of a limb's twist, radians.
const TWIST: f64 = 0.5;

impl Tracker {
    /// How the body's joints move by its filter's noise; `None` without a filter.
    #[must_use]
    pub fn motion_model(&self) -> Option<MotionModel> {
        let Motion::Kalman(noise) = self.motion else { return None };
        let learnt = self.pulling_prior().and_then(|prior| prior.statistics.accelerations.as_ref());
        Some(MotionModel::new(noise, &self.model, learnt))
    }

    fn pulling_prior(&self) -> Option<&LearntPrior> {
        self.options.prior.as_ref().filter(|prior| prior.pose_weight > 0.0)
    }

    /// R of a frame by what its fit leaves, squared grey levels.
    pub(super) fn variance(&self, options: &KalmanOptions, fit: &Fit, views: &[FitView]) -> f64 {
        match options.measurement_deviation {
            Some(deviation) => deviation * deviation,
            None => self.left_variance(fit, views),
        }
    }

    fn left_variance(&self, fit: &Fit, views: &[FitView]) -> f64 {
        let views: Vec<_> = views.iter().map(|view| (view.weight > 0.0).then(|| view.clone())).collect();
        let seen = FrameInformation::new(&self.model, &views, &fit.options, fit.pose());
        let stride = fit.options.stages.last().map_or(1, |stage| stage.stride) as f64;
        match seen.map(|seen| seen.noise_of_all()) {
            Ok(Noise { pixel_deviation, together }) if pixel_deviation > 0.0 => {
                let variance = OWN_SHARE * pixel_deviation.powi(2) * together.max(stride * stride);
                variance.max(LEAST_DEVIATION.powi(2))
            }
            _ => USUAL_DEVIATION.powi(2),
        }
    }

    /// Weighs a frame's fit against what was predicted of it, and gives R: `variance` first, and then what the residuals leave that are
    /// without the pull of priors.
    pub(super) fn weigh(
        &self,
        fit: &mut Fit,
        prediction: &ConditionedPrediction,
        variance: f64,
        views: &[FitView],
        cancel: &CancelToken,
    ) -> Result<f64, FilterError> {
        fit.go_on_with(prediction.prior(variance)?);
        fit.run(cancel, |_| {});
        let Motion::Kalman(KalmanOptions { measurement_deviation: None, .. }) = &self.motion else {
            return Ok(variance);
        };
        let variance = self.left_variance(fit, views);
        fit.go_on_with(prediction.prior(variance)?);
        fit.run(cancel, |_| {});
        Ok(variance)
    }

    /// Information on every pose, and its pull at one, in tangent columns.
    pub(super) fn known(&self, pose: &Pose) -> NormalEquations {
        let (model, tangent) = (&*self.model, Parameters::Tangent);
        let mut known = NormalEquations::zeros(tangent.columns(model.rotation_count()));
        pose_prior::add_rest(&mut known, tangent, model, pose, TWIST.powi(-2));
        if let Some(prior) = self.pulling_prior() {
            // E is −2 ln of a density: its own unit is that of a covariance.
            let prior =
                LearntPrior { pose_weight: 1.0, step_weight: 0.0, step_seconds: None, ..prior.clone() };
            if let Some(bound) = BoundPrior::new(&prior, model, pose) {
                bound.add(&mut known, tangent, model, &Kinematics::new(model, pose), 1.0);
            }
        }
        known
    }
}
