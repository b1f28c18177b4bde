//! A pixel's gradient as forces at its limb's two joints, and sums of them.
//!
//! The distance of a ray to a capsule, a cylinder or a row of equal spheres depends on the limb's two joints
//! and on nothing else: ∂λ = g₀·∂p0 + g₁·∂p1. With f = g₀ + g₁ that is f·∂p0 + g₁·∂a, a = p1 − p0, and since a
//! turns with the limb, ∂a = ω × a + σ a. Six numbers a pixel, [f, g₁], against the seven of a
//! [`Wrench`](super::wrench::Wrench), which serves points anywhere in the limb.

use std::ops::AddAssign;

use nalgebra::{Matrix3, Vector3};

/// Σ w h hᵀ and Σ w h ρ of h = [f, g₁] over the pixels of one limb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointBlock {
    /// Σ w f fᵀ.
    pub ff: Matrix3<f64>,
    /// Σ w f g₁ᵀ.
    pub fg: Matrix3<f64>,
    /// Σ w g₁ g₁ᵀ.
    pub gg: Matrix3<f64>,
    /// Σ w f ρ.
    pub f: Vector3<f64>,
    /// Σ w g₁ ρ.
    pub g: Vector3<f64>,
}

impl Default for JointBlock {
    fn default() -> Self {
        let (matrix, vector) = (Matrix3::zeros(), Vector3::zeros());
        Self { ff: matrix, fg: matrix, gg: matrix, f: vector, g: vector }
    }
}

impl JointBlock {
    /// Whether nothing pulls.
    #[must_use]
    pub(crate) fn is_empty(&self) -> bool {
        self.ff.trace() == 0.0 && self.gg.trace() == 0.0
    }

    /// Adds to every pixel's f the force c ẑ and to its g₁ half of it, given Σ w c f, Σ w c g₁, Σ w c² and
    /// Σ w c ρ: half the pull of the limb's middle depth at each joint. Camera axes.
    pub(crate) fn add_depth(&mut self, [cf, cg]: [Vector3<f64>; 2], cc: f64, c_residual: f64) {
        let z = Vector3::z();
        let zz = z * z.transpose() * cc;
        self.ff += cf * z.transpose() + z * cf.transpose() + zz;
        self.fg += cf * z.transpose() * 0.5 + z * cg.transpose() + zz * 0.5;
        self.gg += (cg * z.transpose() + z * cg.transpose()) * 0.5 + zz * 0.25;
        self.f += z * c_residual;
        self.g += z * (0.5 * c_residual);
    }
}

impl AddAssign for JointBlock {
    fn add_assign(&mut self, other: Self) {
        self.ff += other.ff;
        self.fg += other.fg;
        self.gg += other.gg;
        self.f += other.f;
        self.g += other.g;
    }
}
