//! What a limb or a branch of the body pulls: Σ w [F, τ][F, τ]ᵀ and Σ w [F, τ] ρ about a point, world axes.
//!
//! F is the force and τ = [moment, stretch] what turning and scaling about the point feel of it. A force at d from there
//! has τ = L(d) F = [d × F, d·F]. Sums are kept as rows of four numbers, a vector each: those of F want three.
//! Closures of iterators and of arrays are not always inlined into code for wider vectors; plain loops are.

#![expect(clippy::needless_range_loop, reason = "blocks are written by their rows and columns")]

use std::array::from_fn;

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use pulp::Simd;

use super::RowSums;
use crate::render::JointBlock;

/// Four numbers that are worked on at once.
pub(super) type Quad = [f64; 4];

/// Sums about a point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Composite {
    /// Σ w F Fᵀ.
    pub(super) ff: [Quad; 3],
    /// Σ w F τᵀ.
    pub(super) ft: [Quad; 3],
    /// Σ w τ τᵀ.
    pub(super) tt: [Quad; 4],
    /// Σ w F ρ.
    pub(super) f: Quad,
    /// Σ w τ ρ.
    pub(super) t: Quad,
}

impl Composite {
    /// Of wrenches about the same point.
    pub(super) fn of_wrenches(sums: &RowSums<7>) -> Self {
        let RowSums { products, forces } = sums;
        Self {
            ff: from_fn(|i| [products[(i, 0)], products[(i, 1)], products[(i, 2)], 0.0]),
            ft: from_fn(|i| from_fn(|j| products[(i, 3 + j)])),
            tt: from_fn(|i| from_fn(|j| products[(3 + i, 3 + j)])),
            f: [forces[0], forces[1], forces[2], 0.0],
            t: from_fn(|i| forces[3 + i]),
        }
    }

    /// Whether nothing pulls.
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        let forces = self.ff[0][0] + self.ff[1][1] + self.ff[2][2];
        forces + self.tt[0][0] + self.tt[1][1] + self.tt[2][2] + self.tt[3][3] == 0.0
    }

    /// Adds sums about a point at `arm` from this one.
    #[inline(always)]
    pub(super) fn add_at<S: Simd>(&mut self, simd: S, arm: DVec3, other: &Self) {
        let lever = lever(arm);
        let mut ft = other.ft;
        for i in 0..3 {
            add_combined(simd, &mut ft[i], &other.ff[i], &lever);
        }
        // ⟨τ τᵀ⟩ + L ⟨F τᵀ⟩ about both points, one of them transposed.
        let mut before = [Quad::default(); 4];
        add_lifted(simd, &mut before, arm, &other.ft);
        add_lifted(simd, &mut self.tt, arm, &ft);
        for i in 0..4 {
            add_row(simd, &mut self.tt[i], &other.tt[i]);
            add_row(simd, &mut self.tt[i], &[before[0][i], before[1][i], before[2][i], before[3][i]]);
        }
        for i in 0..3 {
            add_row(simd, &mut self.ff[i], &other.ff[i]);
            add_row(simd, &mut self.ft[i], &ft[i]);
        }
        add_row(simd, &mut self.f, &other.f);
        add_row(simd, &mut self.t, &other.t);
        add_combined(simd, &mut self.t, &other.f, &lever);
    }

    /// Adds sums about the same point.
    #[inline(always)]
    pub(super) fn add<S: Simd>(&mut self, simd: S, other: &Self) {
        for i in 0..3 {
            add_row(simd, &mut self.ff[i], &other.ff[i]);
            add_row(simd, &mut self.ft[i], &other.ft[i]);
        }
        for i in 0..4 {
            add_row(simd, &mut self.tt[i], &other.tt[i]);
        }
        add_row(simd, &mut self.f, &other.f);
        add_row(simd, &mut self.t, &other.t);
    }

    /// The sums as a matrix and a vector of force, moment and stretch.
    pub(super) fn as_matrix(&self) -> RowSums<7> {
        let products = SMatrix::from_fn(|i, j| match (i.min(j), i.max(j)) {
            (i, j) if j < 3 => self.ff[i][j],
            (i, j) if i < 3 => self.ft[i][j - 3],
            (i, j) => self.tt[i - 3][j - 3],
        });
        let forces = SVector::from_fn(|i, _| if i < 3 { self.f[i] } else { self.t[i - 3] });
        RowSums { products, forces }
    }
}

/// Forces at a limb's two joints, as a [`JointBlock`] has them, summed over cameras in world axes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct JointSums {
    ff: [Quad; 3],
    fg: [Quad; 3],
    gg: [Quad; 3],
    f: Quad,
    g: Quad,
}

impl JointSums {
    /// Whether nothing pulls.
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        let forces = self.ff[0][0] + self.ff[1][1] + self.ff[2][2];
        forces + self.gg[0][0] + self.gg[1][1] + self.gg[2][2] == 0.0
    }

    /// Adds a camera's, turned to the world and weighted.
    #[inline(always)]
    pub(super) fn add<S: Simd>(
        &mut self,
        simd: S,
        block: &JointBlock,
        camera_from_world: DMat3,
        weight: f64,
    ) {
        // Rows of the rotation to camera axes, and of that to the world.
        let [x, y, z] = camera_from_world.to_cols_array_2d();
        let to_camera = [[x[0], y[0], z[0], 0.0], [x[1], y[1], z[1], 0.0], [x[2], y[2], z[2], 0.0]];
        let to_world = [x, y, z];
        turn(simd, &block.ff, &to_camera, to_world, weight, &mut self.ff);
        turn(simd, &block.fg, &to_camera, to_world, weight, &mut self.fg);
        turn(simd, &block.gg, &to_camera, to_world, weight, &mut self.gg);
        add_combined(simd, &mut self.f, &row_of(&block.f, weight), &to_camera);
        add_combined(simd, &mut self.g, &row_of(&block.g, weight), &to_camera);
    }

    /// The same about the limb's first joint; its axis is p1 − p0.
    #[inline(always)]
    pub(super) fn composite<S: Simd>(&self, simd: S, axis: DVec3) -> Composite {
        // F = f and τ = L(a) g₁.
        let lever = lever(axis);
        let mut composite = Composite { ff: self.ff, f: self.f, ..Composite::default() };
        let mut gt = [Quad::default(); 3];
        for i in 0..3 {
            add_combined(simd, &mut composite.ft[i], &self.fg[i], &lever);
            add_combined(simd, &mut gt[i], &self.gg[i], &lever);
        }
        add_lifted(simd, &mut composite.tt, axis, &gt);
        add_combined(simd, &mut composite.t, &self.g, &lever);
        composite
    }
}

/// Adds w Rᵀ M R, given R by its rows and by its columns.
#[inline(always)]
fn turn<S: Simd>(
    simd: S,
    matrix: &Matrix3<f64>,
    to_camera: &[Quad; 3],
    to_world: [[f64; 3]; 3],
    weight: f64,
    sums: &mut [Quad; 3],
) {
    let mut half = [Quad::default(); 3];
    for i in 0..3 {
        let row = [matrix[(i, 0)] * weight, matrix[(i, 1)] * weight, matrix[(i, 2)] * weight, 0.0];
        add_combined(simd, &mut half[i], &row, to_camera);
    }
    for i in 0..3 {
        let [x, y, z] = to_world[i];
        add_combined(simd, &mut sums[i], &[x, y, z, 0.0], &half);
    }
}

/// target += row.
#[inline(always)]
pub(super) fn add_row<S: Simd>(simd: S, target: &mut Quad, row: &Quad) {
    let (target, row) = (S::as_mut_simd_f64s(target).0, S::as_simd_f64s(row).0);
    for (target, &row) in target.iter_mut().zip(row) {
        *target = simd.add_f64s(*target, row);
    }
}

/// target += Σ factors · rows.
#[inline(always)]
pub(super) fn add_combined<S: Simd, const N: usize>(
    simd: S,
    target: &mut Quad,
    factors: &Quad,
    rows: &[Quad; N],
) {
    let target = S::as_mut_simd_f64s(target).0;
    for k in 0..N {
        let factor = simd.splat_f64s(factors[k]);
        for (target, &row) in target.iter_mut().zip(S::as_simd_f64s(&rows[k]).0) {
            *target = simd.mul_add_e_f64s(factor, row, *target);
        }
    }
}

/// L(d)ᵀ: a row a component of the force.
#[inline(always)]
fn lever(d: DVec3) -> [Quad; 3] {
    [[0.0, d.z, -d.y, d.x], [-d.z, 0.0, d.x, d.y], [d.y, -d.x, 0.0, d.z]]
}

/// Adds L(d) X, for rows X.
#[inline(always)]
pub(super) fn add_lifted<S: Simd>(simd: S, target: &mut [Quad; 4], d: DVec3, rows: &[Quad; 3]) {
    let [x, y, z] = [d.x, d.y, d.z];
    let factors = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0], [x, y, z]];
    for i in 0..4 {
        for k in 0..3 {
            if i == k {
                continue;
            }
            let factor = simd.splat_f64s(factors[i][k]);
            let row = S::as_simd_f64s(&rows[k]).0;
            for (target, &row) in S::as_mut_simd_f64s(&mut target[i]).0.iter_mut().zip(row) {
                *target = simd.mul_add_e_f64s(factor, row, *target);
            }
        }
    }
}

#[inline(always)]
fn row_of(vector: &Vector3<f64>, weight: f64) -> Quad {
    [vector.x * weight, vector.y * weight, vector.z * weight, 0.0]
}
