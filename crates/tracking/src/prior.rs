//! What motion files say of people: a distribution of poses, and of steps from pose to pose (end of 6.1 of the report).
//!
//! A pose is looked at as directions of limbs in the frame of pelvis or chest ([`BodyDirection`]): cameras see directions, while a
//! limb's twist about itself shows nowhere. Directions come in parts of the body that know nothing of each other (trunk, each
//! arm, each leg), so that what one part does oddly is no reason to doubt the others.
//!
//! With x the directions of a part, D numbers, its distribution is a mixture of Student's t:
//!
//! p(x) = Σ πₖ cₖ (1 + mₖ/ν)^(−(ν + D)/2),  mₖ = (x − μₖ)ᵀ Σₖ⁻¹ (x − μₖ),
//!
//! and its energy is E(x) = −2 ln(p(x) / Σ πₖ cₖ) ≥ 0. Near a mean that is the squared distance of a Gaussian; far away it grows
//! with the logarithm only, so its pull falls off as 1/distance and what the silhouettes see wins: people do what nobody
//! recorded. A step is how far a pose is from where the motion led; it has one such distribution of mean zero, which is wider the
//! longer the step took. And how much joints' velocities change tells a filter what to expect ([`Accelerations`]).
//!
//! Sources: D. Peel and G. J. `McLachlan`, "Robust mixture modelling using the t distribution" (2000), for the training;
//! E. Olson and P. Agarwal, "Inference on networks of mixtures for robust robot mapping" (2013), for mixtures as residuals.

mod accelerations;
mod direction;
mod mixture;
mod statistics;
mod train;

pub use accelerations::Accelerations;
pub use direction::{BodyDirection, BodyPoints, TrunkFrame};
pub use mixture::{Pull, StudentComponent, StudentMixture};
pub use statistics::{PosePrior, PriorError, PriorPart, StepStatistics};
pub use train::{Clip, TrainError, TrainOptions, train};
