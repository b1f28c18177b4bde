//! A pixel's gradient as a wrench on its limb, and sums of them.
//!
//! λ depends on a limb only through points fixed in it. A force k at a point q of the limb changes λ by
//! k·(v + ω × (q − p0) + σ (q − p0)) when the limb moves by (v, ω, σ), so the pixel's row of the Jacobian is
//! h = [k, (q − p0) × k, (q − p0)·k] times the limb's 7 × n kinematic map. The seventh component is the
//! scaling of raw quaternions (4.15). Summing h hᵀ and h ρ per limb first gives exactly Gauss-Newton's JᵀJ and
//! Jᵀρ, at a cost per pixel that does not depend on the size of the state.
//!
//! A pixel's gradient as forces at its limb's two joints, and sums of them.
//!
//! The distance of a ray to a capsule, a cylinder or a row of equal spheres depends on the limb's two joints
//! and on nothing else: ∂λ = g₀·∂p0 + g₁·∂p1. With f = g₀ + g₁ that is f·∂p0 + g₁·∂a, a = p1 − p0, and since a
//! turns with the limb, ∂a = ω × a + σ a. Six numbers a pixel, [f, g₁], against the seven of a
//! [`Wrench`], which serves points anywhere in the limb.

use std::ops::AddAssign;

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// A force with its moment and stretch about the limb's first joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wrench {
    /// k, grey levels per metre.
    pub force: DVec3,
    /// (q − p0) × k, grey levels per radian.
    pub moment: DVec3,
    /// (q − p0)·k, grey levels per unit of scaling.
    pub stretch: f64,
}

impl Wrench {
    /// A force at a point given relative to the limb's first joint.
    #[inline]
    pub fn at(force: DVec3, arm: DVec3) -> Self {
        Self { force, moment: arm.cross(force), stretch: arm.dot(force) }
    }

    /// The seven numbers: force, moment, stretch.
    #[inline]
    pub fn to_array(self) -> [f64; 7] {
        let (k, m) = (self.force, self.moment);
        [k.x, k.y, k.z, m.x, m.y, m.z, self.stretch]
    }

    /// The same in other axes.
    pub fn rotated(self, rotation: DMat3) -> Self {
        Self { force: rotation * self.force, moment: rotation * self.moment, stretch: self.stretch }
    }
}

impl AddAssign for Wrench {
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.moment += other.moment;
        self.stretch += other.stretch;
    }
}

/// What the pixels of one limb pull: Σ w h hᵀ (upper triangle) and Σ w h ρ, and beside it the part that is
/// known as forces at the limb's joints.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WrenchBlock {
    products: [f64; 28],
    forces: [f64; 7],
    /// How many times anything was added but forces at joints.
    pub(crate) pixels: usize,
    /// What was added as forces at the limb's joints, camera axes.
    pub(crate) joints: JointBlock,
}

impl WrenchBlock {
    /// Adds a pixel with weight w and residual ρ = D − Λ.
    #[inline]
    pub(crate) fn add(&mut self, wrench: Wrench, weight: f64, residual: f64) {
        let h = wrench.to_array();
        let mut slot = 0;
        for i in 0..7 {
            let weighted = weight * h[i];
            self.forces[i] += weighted * residual;
            for &other in &h[i..] {
                self.products[slot] += weighted * other;
                slot += 1;
            }
        }
        self.pixels += 1;
    }

    /// Adds sums made elsewhere: M = Σ w h hᵀ (symmetric) and m = Σ w h ρ.
    pub(crate) fn add_sums(&mut self, products: &SMatrix<f64, 7, 7>, forces: &SVector<f64, 7>) {
        let mut slot = 0;
        for i in 0..7 {
            self.forces[i] += forces[i];
            for j in i..7 {
                self.products[slot] += products[(i, j)];
                slot += 1;
            }
        }
        self.pixels += 1;
    }

    /// M = Σ w h hᵀ and m = Σ w h ρ of all but the forces at joints, turned from camera to world axes.
    pub(crate) fn in_world(&self, camera_from_world: DMat3) -> (SMatrix<f64, 7, 7>, SVector<f64, 7>) {
        // Force and moment turn, each with itself and with the other; the stretch is a number.
        let c = camera_from_world.to_cols_array();
        let world_from_camera = Matrix3::from_row_slice(&c);
        let camera_from_world = world_from_camera.transpose();
        let mut products = SMatrix::<f64, 7, 7>::zeros();
        let mut slot = 0;
        for i in 0..7 {
            for j in i..7 {
                products[(i, j)] = self.products[slot];
                products[(j, i)] = self.products[slot];
                slot += 1;
            }
        }
        for (i, j) in [(0, 0), (0, 3), (3, 3)] {
            let block: Matrix3<f64> = products.fixed_view::<3, 3>(i, j).into_owned();
            let turned = world_from_camera * block * camera_from_world;
            products.fixed_view_mut::<3, 3>(i, j).copy_from(&turned);
            products.fixed_view_mut::<3, 3>(j, i).copy_from(&turned.transpose());
        }
        let mut forces = SVector::from(self.forces);
        for i in [0, 3] {
            let stretch = world_from_camera * products.fixed_view::<3, 1>(i, 6);
            products.fixed_view_mut::<3, 1>(i, 6).copy_from(&stretch);
            products.fixed_view_mut::<1, 3>(6, i).copy_from(&stretch.transpose());
            let turned = world_from_camera * forces.fixed_rows::<3>(i);
            forces.fixed_rows_mut::<3>(i).copy_from(&turned);
        }
        (products, forces)
    }
}

/// Σ w h hᵀ and Σ w h ρ of h = [f, g₁] over the pixels of one limb.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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

impl JointBlock {
    /// Whether nothing pulls.
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
