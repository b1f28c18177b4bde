//! What pulls on a pose: each file is one kind of residual and adds itself to the normal equations.
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
