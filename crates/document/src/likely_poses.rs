//! Likely poses: the prior that comes with the program, as a choice of the fit that a number says.

use backlit_formats::prior_file;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::residual::learnt_prior::LearntPrior;

/// The prior, with its usual weight.
pub fn people() -> LearntPrior {
    LearntPrior::new(prior_file::people())
}

/// Its weight in a fit, if the fit has it.
pub fn weight(options: &FitOptions) -> Option<f64> {
    options.prior.as_ref().map(|prior| prior.pose_weight)
}

/// Gives it this weight in a fit; 0 takes it out.
pub fn set_weight(options: &mut FitOptions, weight: f64) {
    options.prior = (weight != 0.0).then(|| LearntPrior { pose_weight: weight, ..people() });
}
