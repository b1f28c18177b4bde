//! Poses over time: constant velocity, the iterated extended Kalman filter (6.1) and the smoother.
//!
//! The state is the pose and its velocity, x = (X, v). X lives on a manifold, so beliefs are Gaussians over
//! (δ, v) with δ a step in tangent coordinates from the mean pose, n numbers each:
//!
//! | | |
//! |---|---|
//! | predict | X ← X ⊞ v Δ, v ← v, P ← F P Fᵀ + Q, Q from white accelerations |
//! | update | X minimises ‖D − Λ(X)‖²/R + δᵀ Pₓₓ⁻¹ δ, by the same steps as any fit; P⁻¹ ← (G P Gᵀ)⁻¹ + JᵀJ/R |
//! | once | P⁻¹ ← max(P⁻¹, B): what is always known of poses, B, adds what P⁻¹ lacks of it ([`count_once`]) |
//! | smooth | Rauch, Tung and Striebel: backwards, C = P Fᵀ (P⁻)⁻¹, x ← x + C (xˢ − x⁻) |
//!
//! The update is the iterated extended Kalman filter in information form: its maximum is found by Gauss-Newton
//! (B. M. Bell, F. W. Cathey, "The iterated Kalman filter update as a Gauss-Newton method", 1993), so as R → 0
//! it is the plain fit, as the report derives. Nothing here knows of bodies: how a pose takes a step is the
//! caller's. F and G are the Jacobians of steps on the manifold ([`tangent`]).

mod constant_velocity;
mod once;
pub mod smoother;
pub mod tangent;
pub mod update;

use thiserror::Error;

pub use constant_velocity::{Belief, ConstantVelocity};
pub use once::count_once;
pub use update::Innovation;

/// Why a filter cannot go on from what it believes.
#[derive(Debug, Error, Clone, Copy, PartialEq, Eq)]
pub enum FilterError {
    /// A covariance has no variance left in some direction.
    #[error("the filter is certain of a direction: its covariance is not positive")]
    Certain,
    /// Infinite or not a number.
    #[error("the filter's numbers ran out of range")]
    NotFinite,
}
