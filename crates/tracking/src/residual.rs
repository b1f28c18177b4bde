//! What pulls on a pose: each file is one kind of residual and adds itself to the normal equations. One of your own is a
//! [`Residual`].
//!
//! | file | residual ρ |
//! |---|---|
//! | [`silhouette`] | D − Λ of every pixel (4.10, 4.16) |
//! | [`pose_prior`] | stay near the pose that the fit began with, untwisted, within the joints' limits |
//! | `body_size` | D − Λ again, with columns for the body's lengths and radii |
//! | `proportion_prior`, its choices are [`Proportions`] | how far lengths and radii are from a scaled body's |
//! | [`interpenetration`] | how deep two limbs lie inside each other |
//! | [`Loss`] | how large residuals are held back: Huber, Cauchy, Tukey |
//! | [`motion_prior`] | stay near what the motion so far predicts |
//! | [`learnt_prior`] | how unlikely poses and steps are, by what motion files say |
//! | [`cue`] | where keypoints, flow, edges and stereo saw a limb − where it is |
//! | [`point`] | target − position of a joint, for posing by hand and for reference keypoints |

#[doc(inline)]
pub use crate::prior;

use std::fmt;

use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::optimize::NormalEquations;

pub(crate) mod body_size;
mod composite;
pub mod cue;
pub mod interpenetration;
pub mod learnt_prior;
mod loss;
pub mod motion_prior;
pub mod point;
pub mod pose_prior;
pub(crate) mod proportion_prior;
pub mod silhouette;
mod state_map;

pub use loss::Loss;
pub use proportion_prior::Proportions;

/// A residual of one's own, which [`Fit::with_residual`](crate::fit::Fit::with_residual) adds to a fit.
///
/// With ρ = datum − prediction and J = ∂prediction/∂X it adds w ρ² to the cost, w JᵀJ and w Jᵀρ.
/// [`check_gradient`](crate::optimize::gradient_check::check_gradient) compares its derivatives with differences.
pub trait Residual: fmt::Debug + Send + Sync {
    /// Adds itself at a pose.
    fn add(&self, at: &ResidualPoint<'_>, equations: &mut NormalEquations);
}

/// Where a [`Residual`] is evaluated.
#[derive(Debug, Clone, Copy)]
pub struct ResidualPoint<'a> {
    /// The body.
    pub model: &'a Model,
    /// Its pose.
    pub pose: &'a Pose,
    /// Where the pose puts its joints, and how the state moves them.
    pub kinematics: &'a Kinematics,
    /// The state's columns.
    pub parameters: Parameters,
    /// Squared grey levels of a weight of 1, as priors have them, at the stage's stride.
    pub unit: f64,
}
