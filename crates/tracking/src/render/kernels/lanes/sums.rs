//! A solid's sums over one camera, as what they pull at its limb.

use glam::DVec3;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::solid::{LaneSolid, Shape};
use crate::render::joint_forces::JointBlock;
use crate::render::wrench::{Wrench, WrenchBlock};

/// First of the eight sums with c = ∂λ/∂z: Σ c f, Σ c t f, Σ c², Σ c ρ.
pub(super) const DEPTH: usize = 24;
/// First of the thirty sums of flat caps: Σ f Gᵀ, Σ t f Gᵀ, Σ G Gᵀ, Σ ρ G, Σ c G.
pub(super) const CAPS: usize = 32;
/// Sums of one solid; the first 24 are Σ f fᵀ, Σ t f fᵀ, Σ t² f fᵀ (upper triangles), Σ ρ f, Σ t ρ f.
pub(super) const SUMS: usize = 62;

fn vector(sums: &[f64], factor: f64) -> Vector3<f64> {
    Vector3::new(sums[0], sums[1], sums[2]) * factor
}

fn symmetric(s: &[f64], factor: f64) -> Matrix3<f64> {
    Matrix3::new(s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]) * factor
}

impl LaneSolid {
    /// Adds the solid's sums to its limb's block, camera axes.
    pub(super) fn add_to(&self, sums: &[f64; SUMS], block: &mut WrenchBlock) {
        let nothing = sums[0] + sums[3] + sums[5] + sums[DEPTH + 6] == 0.0;
        if nothing {
            return;
        }
        match self.anchor {
            None => block.add_joints(&self.joint_block(sums)),
            Some(anchor) => {
                let (products, forces) = self.wrench_sums(sums, anchor.arm, anchor.limb_axis);
                block.add_sums(&products, &forces);
            }
        }
    }

    /// Forces at the limb's joints: g₁ = t f + G, and half the depth's force at each.
    fn joint_block(&self, s: &[f64; SUMS]) -> JointBlock {
        let factor = self.ramp.factor;
        let square = factor * factor;
        let mut block = JointBlock {
            ff: symmetric(&s[..6], square),
            fg: symmetric(&s[6..12], square),
            gg: symmetric(&s[12..18], square),
            f: vector(&s[18..21], factor),
            g: vector(&s[21..24], factor),
        };
        let mut by_depth = [vector(&s[DEPTH..DEPTH + 3], factor), vector(&s[DEPTH + 3..DEPTH + 6], factor)];
        if matches!(self.shape, Shape::Cylinder { .. }) {
            let general = |from: usize| Matrix3::from_row_slice(&s[from..from + 9]) * square;
            let mixed_t = general(CAPS + 9);
            block.fg += general(CAPS);
            block.gg += mixed_t + mixed_t.transpose() + symmetric(&s[CAPS + 18..CAPS + 24], square);
            block.g += vector(&s[CAPS + 24..CAPS + 27], factor);
            by_depth[1] += vector(&s[CAPS + 27..CAPS + 30], factor);
        }
        if self.ramp.by_depth.is_some() {
            block.add_depth(by_depth, s[DEPTH + 6], s[DEPTH + 7]);
        }
        block
    }

    /// A sphere fixed in the limb at `arm` from its first joint: h = A f + c d, with A f the wrench of f there
    /// and d that of the depth, half at each joint.
    fn wrench_sums(
        &self,
        s: &[f64; SUMS],
        arm: DVec3,
        limb_axis: DVec3,
    ) -> (SMatrix<f64, 7, 7>, SVector<f64, 7>) {
        let factor = self.ramp.factor;
        let mut wrench_of = SMatrix::<f64, 7, 3>::zeros();
        for (column, axis) in DVec3::AXES.into_iter().enumerate() {
            wrench_of.column_mut(column).copy_from_slice(&Wrench::at(axis, arm).to_array());
        }
        let mut products = wrench_of * symmetric(&s[..6], factor * factor) * wrench_of.transpose();
        let mut forces = wrench_of * vector(&s[18..21], factor);
        if self.ramp.by_depth.is_some() {
            let mut depth = Wrench::at(DVec3::Z * 0.5, limb_axis);
            depth.force += DVec3::Z * 0.5;
            let depth = SVector::from(depth.to_array());
            let with = wrench_of * vector(&s[DEPTH..DEPTH + 3], factor);
            products += with * depth.transpose()
                + depth * with.transpose()
                + depth * depth.transpose() * s[DEPTH + 6];
            forces += depth * s[DEPTH + 7];
        }
        (products, forces)
    }
}
