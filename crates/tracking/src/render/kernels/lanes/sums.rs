//! A solid's sums over one camera, as what they pull at its limb.

use glam::DVec3;
use nalgebra::{Matrix2, Matrix3, Matrix3x2, SMatrix, SVector, Vector2, Vector3};

use super::solid::{Anchor, AxisSight, LaneSolid, Outline, Shape};
use crate::render::wrench::{JointBlock, Wrench, WrenchBlock};

/// Sums of an axis with f = [S, T]: Σ f fᵀ, Σ t f fᵀ, Σ t² f fᵀ (upper triangles), Σ ρ f, Σ t ρ f, and with c = ∂λ/∂z
/// Σ c f, Σ c t f, Σ c², Σ c ρ.
pub(super) const AXIS_SUMS: usize = 19;
/// Sums of a ball: Σ f fᵀ (upper triangle), Σ ρ f, Σ c f, Σ c², Σ c ρ.
pub(super) const BALL_SUMS: usize = 14;
/// First of a whole solid's eight sums with c = ∂λ/∂z: Σ c f, Σ c t f, Σ c², Σ c ρ.
pub(super) const DEPTH: usize = 24;
/// First of the thirty sums of flat caps: Σ f Gᵀ, Σ t f Gᵀ, Σ G Gᵀ, Σ ρ G, Σ c G.
pub(super) const CAPS: usize = 32;
/// Sums of a whole solid; the first 24 are Σ f fᵀ, Σ t f fᵀ, Σ t² f fᵀ (upper triangles), Σ ρ f, Σ t ρ f.
pub(super) const SUMS: usize = 62;

/// Sums of a solid's parts.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolidSums {
    pub axis: [f64; AXIS_SUMS],
    pub balls: [[f64; BALL_SUMS]; 2],
    pub whole: [f64; SUMS],
}

impl Default for SolidSums {
    fn default() -> Self {
        Self { axis: [0.0; AXIS_SUMS], balls: [[0.0; BALL_SUMS]; 2], whole: [0.0; SUMS] }
    }
}

fn vector(sums: &[f64], factor: f64) -> Vector3<f64> {
    Vector3::new(sums[0], sums[1], sums[2]) * factor
}

fn symmetric(s: &[f64], factor: f64) -> Matrix3<f64> {
    Matrix3::new(s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]) * factor
}

impl LaneSolid {
    /// Adds the solid's sums to its limb's block, camera axes.
    pub(super) fn add_to(&self, sums: &SolidSums, block: &mut WrenchBlock) {
        match (self.anchor, &self.outline) {
            (Some(anchor), _) => {
                if !is_nothing(&sums.balls[0][..6], sums.balls[0][12]) {
                    let (products, forces) = self.wrench_sums(&sums.balls[0], &anchor);
                    block.add_sums(&products, &forces);
                }
            }
            (None, Outline::Whole(_)) => {
                if !is_nothing(&sums.whole[..6], sums.whole[DEPTH + 6]) {
                    block.joints += self.joint_block(&sums.whole);
                }
            }
            (None, _) => {
                if let Some(sight) =
                    self.sight.as_ref().filter(|_| sums.axis[0] + sums.axis[2] + sums.axis[17] != 0.0)
                {
                    block.joints += self.axis_block(sight, &sums.axis);
                }
                for (end, sums) in sums.balls.iter().enumerate() {
                    if !is_nothing(&sums[..6], sums[12]) {
                        block.joints += self.ball_block(end, sums);
                    }
                }
            }
        }
    }

    /// The axis's forces, f = S (−D w) + T (D v) and g₁ = t f.
    fn axis_block(&self, sight: &AxisSight, s: &[f64; AXIS_SUMS]) -> JointBlock {
        let basis = sight.basis.map(|b| Vector3::from((b * self.ramp.factor).to_array()));
        let basis = Matrix3x2::from_columns(&basis);
        let products = |s: &[f64]| basis * Matrix2::new(s[0], s[1], s[1], s[2]) * basis.transpose();
        let vector = |s: &[f64]| basis * Vector2::new(s[0], s[1]);
        let mut block = JointBlock {
            ff: products(&s[..3]),
            fg: products(&s[3..6]),
            gg: products(&s[6..9]),
            f: vector(&s[9..11]),
            g: vector(&s[11..13]),
        };
        if self.ramp.by_depth.is_some() {
            block.add_depth([vector(&s[13..15]), vector(&s[15..17])], s[17], s[18]);
        }
        block
    }

    /// The forces of a ball about a joint: g₁ is none of f or all.
    fn ball_block(&self, end: usize, s: &[f64; BALL_SUMS]) -> JointBlock {
        let factor = self.ramp.factor;
        let (products, force) = (symmetric(&s[..6], factor * factor), vector(&s[6..9], factor));
        let depth = vector(&s[9..12], factor);
        let share = end as f64;
        let mut block = JointBlock {
            ff: products,
            fg: products * share,
            gg: products * share,
            f: force,
            g: force * share,
        };
        if self.ramp.by_depth.is_some() {
            block.add_depth([depth, depth * share], s[12], s[13]);
        }
        block
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
        s: &[f64; BALL_SUMS],
        &Anchor { arm, limb_axis }: &Anchor,
    ) -> (SMatrix<f64, 7, 7>, SVector<f64, 7>) {
        let factor = self.ramp.factor;
        let mut wrench_of = SMatrix::<f64, 7, 3>::zeros();
        for (column, axis) in DVec3::AXES.into_iter().enumerate() {
            wrench_of.column_mut(column).copy_from_slice(&Wrench::at(axis, arm).to_array());
        }
        let mut products = wrench_of * symmetric(&s[..6], factor * factor) * wrench_of.transpose();
        let mut forces = wrench_of * vector(&s[6..9], factor);
        if self.ramp.by_depth.is_some() {
            let mut depth = Wrench::at(DVec3::Z * 0.5, limb_axis);
            depth.force += DVec3::Z * 0.5;
            let depth = SVector::from(depth.to_array());
            let with = wrench_of * vector(&s[9..12], factor);
            products +=
                with * depth.transpose() + depth * with.transpose() + depth * depth.transpose() * s[12];
            forces += depth * s[13];
        }
        (products, forces)
    }
}

/// Whether nothing has pulled, by Σ f fᵀ and Σ c².
fn is_nothing(products: &[f64], depth: f64) -> bool {
    products[0] + products[3] + products[5] + depth == 0.0
}
