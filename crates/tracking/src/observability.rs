//! What the cameras see of a pose, and what they do not: the directions of the normal equations.
//!
//! # Equations
//!
//! Near a pose X the data of each camera are linear in a step δ of the tangent state, ρ ≈ ρ(X) − J δ, so all that a set
//! of cameras says of δ stands in
//!
//! ```text
//! H = Σ_c w_c J_cᵀJ_c            columns × columns, squared grey levels per rad² and m²
//! H = D⁻¹ U Λ Uᵀ D⁻¹             D = diag(L, L, L, 1, …, 1)
//! ```
//!
//! J is of the data alone, with the last stage's ramp and its view D of the mask, at every pixel whatever the stage's
//! stride: **priors, limits and pins are left out**, since they say nothing of what is seen. JᵀJ is summed in f64 by the
//! reference kernel, one camera at a time, so that any set of cameras is a sum and not a new rendering.
//!
//! **Metres against radians.** Singular values of a matrix of mixed units mean nothing. The root's metres are measured in
//! L, the root mean square distance, in the body's rest pose, of all joints from all the joints that turn them: moving
//! the root by L carries the joints as far as turning a joint by a radian does on average. Λ is then in squared grey
//! levels per rad², and Dδ is of unit length for each direction δ = D u.
//!
//! **Null.** Rounding gives a direction that no pixel sees a value of up to about ε·(columns + pixels)·λ₁ (one rounding
//! per addition, one per rotation of the eigenvalue iteration): what is not above that is null. Everything above is real,
//! however small; how little it helps is said by its standard deviation.
//!
//! **Noise.** σ² = Σ w ρ² / (Σ w − rank) over the pixels on a ramp, the only ones with a gradient. Model and silhouette err
//! together over whole edges, so pixels are not independent: with g = Jᵀρ of the pixels of a square cell and
//! S = Σ g gᵀ over the cells, errors are larger than those of white noise by κ = tr(H⁺S) / (rank σ²) in variance; less than
//! one is taken for one. [`Noise::deviation`] is σ√κ. Covariance of a joint p with ∂p = K δ: σ²κ · K H⁺ Kᵀ, and what it moves along null
//! directions is without any bound.

mod cause;
mod directions;
mod information;
pub mod plan;
mod subsets;
mod uncertainty;

pub use cause::{Cause, Share};
pub use directions::{Direction, Noise, Observability, Visibility};
pub use information::{CameraInformation, FrameInformation, LimbSight};
pub use subsets::{SubsetFigures, camera_subsets};
pub use uncertainty::{ImageEllipse, JointUncertainty, articulated_joints, believed_joints};
