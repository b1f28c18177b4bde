//! From forces at a limb's two joints to the state: JᵀJ += KᵀMK and Jᵀρ += Kᵀm, with K the limb's kinematic map.
//!
//! A column of the state moves the limb's first joint by v and its axis a by u = ω × a + σ a: six numbers, of which a
//! limb's columns keep one after the other for lanes. Where a limb has n columns and M is 6 × 6, M K costs 36 n products
//! and Kᵀ(MK) 3 n²; both are done for as many columns at once as there are lanes.

use glam::DVec3;
use nalgebra::Matrix3;
use pulp::{Simd, WithSimd};

use crate::body::MovingColumn;
use crate::optimize::NormalEquations;
use crate::processor::run_in_four_f64s;
use crate::render::JointBlock;

/// Columns are padded to a multiple of this: lanes are never wider.
const PADDING: usize = 8;
/// v and u.
const RATES: usize = 6;

/// Memory of the map, used again from limb to limb and from evaluation to evaluation.
#[derive(Debug, Clone, Default)]
pub struct StateMap {
    /// The columns that move the limb at hand.
    pub(crate) columns: Vec<MovingColumn>,
    /// K and M K, 6 × columns, row by row; then one row of KᵀMK.
    rates: Vec<f64>,
    pushed: Vec<f64>,
    products: Vec<f64>,
}

impl StateMap {
    /// Adds the forces of a limb with axis a = p1 − p0, world axes, whose columns are [`columns`](Self::columns).
    pub(crate) fn add(&mut self, block: &JointBlock, axis: DVec3, equations: &mut NormalEquations) {
        run_in_four_f64s(Add { map: self, block, axis, equations });
    }
}

struct Add<'a> {
    map: &'a mut StateMap,
    block: &'a JointBlock,
    axis: DVec3,
    equations: &'a mut NormalEquations,
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { map: StateMap { columns, rates, pushed, products }, block, axis, equations } = self;
        let pitch = columns.len().next_multiple_of(PADDING);
        for numbers in [&mut *rates, &mut *pushed] {
            numbers.resize(RATES * pitch, 0.0);
        }
        products.resize(pitch, 0.0);
        for (index, column) in columns.iter().enumerate() {
            let [vx, vy, vz, wx, wy, wz, scaling] = column.motion;
            let u = DVec3::new(wx, wy, wz).cross(axis) + axis * scaling;
            for (row, rate) in [vx, vy, vz, u.x, u.y, u.z].into_iter().enumerate() {
                rates[row * pitch + index] = rate;
            }
        }
        for row in 0..RATES {
            rates[row * pitch + columns.len()..(row + 1) * pitch].fill(0.0);
        }
        let (rates, _) = S::as_simd_f64s(rates);
        let (vectors, lanes) = (pitch / S::F64_LANES, S::F64_LANES);
        push(simd, block, rates, S::as_mut_simd_f64s(pushed).0, vectors);
        let forces = [block.f.x, block.f.y, block.f.z, block.g.x, block.g.y, block.g.z];
        let rows = equations.jtj.nrows();
        let (jtj, jtr) = (equations.jtj.as_mut_slice(), equations.jtr.as_mut_slice());
        for (first, a) in columns.iter().enumerate() {
            let mut mine = [simd.splat_f64s(0.0); RATES];
            for (row, mine) in mine.iter_mut().enumerate() {
                *mine = simd.splat_f64s(pushed[row * pitch + first]);
            }
            let (sums, _) = S::as_mut_simd_f64s(products);
            for vector in first / lanes..vectors {
                let mut sum = simd.splat_f64s(0.0);
                for (row, &mine) in mine.iter().enumerate() {
                    sum = simd.mul_add_e_f64s(mine, rates[row * vectors + vector], sum);
                }
                sums[vector] = sum;
            }
            for (b, &sum) in columns[first..].iter().zip(&products[first..]) {
                jtj[a.index * rows + b.index] += sum;
                if a.index != b.index {
                    jtj[b.index * rows + a.index] += sum;
                }
            }
        }
        for vector in 0..vectors {
            let mut sum = simd.splat_f64s(0.0);
            for (row, force) in forces.into_iter().enumerate() {
                sum = simd.mul_add_e_f64s(simd.splat_f64s(force), rates[row * vectors + vector], sum);
            }
            S::as_mut_simd_f64s(products).0[vector] = sum;
        }
        for (column, sum) in columns.iter().zip(products) {
            jtr[column.index] += *sum;
        }
    }
}

/// M K.
#[inline(always)]
fn push<S: Simd>(simd: S, block: &JointBlock, rates: &[S::f64s], pushed: &mut [S::f64s], vectors: usize) {
    let transposed = block.fg.transpose();
    let halves: [[&Matrix3<f64>; 2]; 2] = [[&block.ff, &block.fg], [&transposed, &block.gg]];
    for (half, matrices) in halves.into_iter().enumerate() {
        for row in 0..3 {
            let mut factors = [simd.splat_f64s(0.0); RATES];
            for (k, factor) in factors.iter_mut().enumerate() {
                *factor = simd.splat_f64s(matrices[k / 3][(row, k % 3)]);
            }
            for vector in 0..vectors {
                let mut sum = simd.splat_f64s(0.0);
                for (k, &factor) in factors.iter().enumerate() {
                    sum = simd.mul_add_e_f64s(factor, rates[k * vectors + vector], sum);
                }
                pushed[(3 * half + row) * vectors + vector] = sum;
            }
        }
    }
}
