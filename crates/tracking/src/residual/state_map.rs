//! From sums over limbs to the state: JᵀJ += KᵀMK and Jᵀρ += Kᵀm, with K the limbs' kinematic maps.
//!
//! A pixel pulls at its limb by a force F on the limb's first joint and by τ = [moment, stretch] about it. What the
//! rotation k carries is a branch of the body that turns and scales about a pivot pₖ, so all that matters of the branch is
//! its [`Composite`], Σ w [F, τ][F, τ]ᵀ about pₖ: its limbs' sums and those of the branches that it carries, moved there
//! (R. Featherstone, "Rigid body dynamics algorithms", 2008, chapter 6: the composite-rigid-body algorithm). A rotation j
//! that carries k turns the branch about another point, τ about pⱼ = τ about pₖ + L(pₖ − pⱼ) F with L(d) F = [d × F, d·F].
//! With Rₖ the rates of turn and scaling of k's columns, 4 × columns,
//!
//! | block of JᵀJ | |
//! |---|---|
//! | root, k | A = ⟨F τᵀ⟩ Rₖ |
//! | j, k | Rⱼᵀ (⟨τ τᵀ⟩ Rₖ + L(pₖ − pⱼ) A) |
//!
//! and what neither carries the other has no product. The work is some twenty products of four numbers for each pair of a
//! rotation and one that carries it, however many limbs there are. Where rotations do not carry whole branches (see
//! [`Branches`]) every limb meets its own columns.

#![expect(clippy::needless_range_loop, reason = "blocks are written by their rows and columns")]

use glam::DVec3;
use nalgebra::SVector;
use pulp::{Simd, WithSimd};

use super::composite::{Composite, Quad, add_combined, add_lifted};
use super::silhouette::WorldBlocks;
use crate::body::{Branches, Kinematics, MovingColumn, Parameters};
use crate::optimize::NormalEquations;
use crate::processor::run_in_four_f64s;

/// Memory of the map, used again from evaluation to evaluation.
#[derive(Debug, Clone, Default)]
pub struct StateMap {
    /// The columns that move a limb.
    pub(crate) columns: Vec<MovingColumn>,
    /// By limb, its sums about its first joint.
    limbs: Vec<Composite>,
    /// By rotation, the sums of what it carries about its pivot.
    carried: Vec<Composite>,
    /// By rotation, R: rows turn and scaling, a number a column.
    rates: Vec<[Quad; 4]>,
}

impl WorldBlocks {
    /// Maps the sums to the state: JᵀJ += KᵀMK, Jᵀρ += Kᵀm, over the columns that move each limb.
    pub fn add_to(
        &self,
        kinematics: &Kinematics,
        parameters: Parameters,
        map: &mut StateMap,
        equations: &mut NormalEquations,
    ) {
        map.limbs.resize(kinematics.limb_count(), Composite::default());
        run_in_four_f64s(Add { map, blocks: self, kinematics, parameters, equations });
    }
}

struct Add<'a> {
    map: &'a mut StateMap,
    blocks: &'a WorldBlocks,
    kinematics: &'a Kinematics,
    parameters: Parameters,
    equations: &'a mut NormalEquations,
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { map, blocks, kinematics, parameters, equations } = self;
        for (limb, composite) in map.limbs.iter_mut().enumerate() {
            blocks.of_limb(simd, limb, kinematics, composite);
        }
        let Some(branches) = kinematics.branches() else {
            for (limb, composite) in map.limbs.iter().enumerate() {
                if !composite.is_empty() {
                    kinematics.moving_columns_into(limb, parameters, &mut map.columns);
                    let columns =
                        map.columns.iter().map(|column| (column.index, SVector::from(column.motion)));
                    composite.as_matrix().add_to(columns, 1.0, equations);
                }
            }
            return;
        };
        map.prepare(kinematics, branches, parameters);
        map.carry(simd, kinematics, branches, equations);
        match parameters {
            Parameters::Raw => map.add_couplings::<S, 4>(simd, kinematics, branches, equations),
            Parameters::Tangent => map.add_couplings::<S, 3>(simd, kinematics, branches, equations),
        }
    }
}

impl StateMap {
    #[inline(always)]
    fn prepare(&mut self, kinematics: &Kinematics, branches: &Branches, parameters: Parameters) {
        let count = branches.parents.len();
        self.carried.clear();
        self.carried.resize(count, Composite::default());
        self.rates.resize(count, [Quad::default(); 4]);
        for (rotation, rows) in self.rates.iter_mut().enumerate() {
            for column in 0..4 {
                // Tangent steps have no fourth column.
                let (turn, scaling) = if column < parameters.per_rotation() {
                    kinematics.rate(rotation, column, parameters)
                } else {
                    (DVec3::ZERO, 0.0)
                };
                rows[0][column] = turn.x;
                rows[1][column] = turn.y;
                rows[2][column] = turn.z;
                rows[3][column] = scaling;
            }
        }
    }

    /// Sums what every rotation carries, and the root's own block.
    #[inline(always)]
    fn carry<S: Simd>(
        &mut self,
        simd: S,
        kinematics: &Kinematics,
        branches: &Branches,
        equations: &mut NormalEquations,
    ) {
        let starts = kinematics.starts();
        for (limb, own) in self.limbs.iter().enumerate() {
            let rotation = branches.rotations[limb];
            let root = branches.roots[rotation];
            if own.is_empty() {
                continue;
            }
            if limb == root {
                self.carried[rotation].add(simd, own);
            } else {
                self.carried[rotation].add_at(simd, starts[limb] - starts[root], own);
            }
        }
        for &rotation in &branches.leaves_first {
            let composite = self.carried[rotation];
            if composite.is_empty() {
                continue;
            }
            if let Some(parent) = branches.parents[rotation] {
                let arm = starts[branches.roots[rotation]] - starts[branches.roots[parent]];
                self.carried[parent].add_at(simd, arm, &composite);
            } else {
                for i in 0..3 {
                    equations.jtr[i] += composite.f[i];
                    for j in 0..3 {
                        equations.jtj[(i, j)] += composite.ff[i.min(j)][i.max(j)];
                    }
                }
            }
        }
    }

    /// Adds the blocks of every rotation with the root, with itself and with all that carry it.
    #[inline(always)]
    fn add_couplings<S: Simd, const COLUMNS: usize>(
        &self,
        simd: S,
        kinematics: &Kinematics,
        branches: &Branches,
        equations: &mut NormalEquations,
    ) {
        let starts = kinematics.starts();
        for (rotation, composite) in self.carried.iter().enumerate() {
            if composite.is_empty() {
                continue;
            }
            let (rates, first) = (&self.rates[rotation], 3 + COLUMNS * rotation);
            let (mut with_root, mut turned) = ([Quad::default(); 3], [Quad::default(); 4]);
            for i in 0..3 {
                add_combined(simd, &mut with_root[i], &composite.ft[i], rates);
            }
            for i in 0..4 {
                add_combined(simd, &mut turned[i], &composite.tt[i], rates);
            }
            let mut forces = Quad::default();
            add_combined(simd, &mut forces, &composite.t, rates);
            for column in 0..COLUMNS {
                equations.jtr[first + column] += forces[column];
            }
            add_block::<3, COLUMNS>(equations, [0, first], &with_root);
            let own = against(simd, rates, &turned);
            for i in 0..COLUMNS {
                equations.jtj[(first + i, first + i)] += own[i][i];
                for j in i + 1..COLUMNS {
                    equations.jtj[(first + i, first + j)] += own[i][j];
                    equations.jtj[(first + j, first + i)] += own[i][j];
                }
            }
            let pivot = starts[branches.roots[rotation]];
            let mut next = branches.parents[rotation];
            while let Some(carrier) = next {
                let mut about_carrier = turned;
                let arm = pivot - starts[branches.roots[carrier]];
                add_lifted(simd, &mut about_carrier, arm, &with_root);
                let block = against(simd, &self.rates[carrier], &about_carrier);
                add_block::<COLUMNS, COLUMNS>(equations, [3 + COLUMNS * carrier, first], &block);
                next = branches.parents[carrier];
            }
        }
    }
}

/// Rᵀ X.
#[inline(always)]
fn against<S: Simd>(simd: S, rates: &[Quad; 4], rows: &[Quad; 4]) -> [Quad; 4] {
    let mut block = [Quad::default(); 4];
    for i in 0..4 {
        add_combined(simd, &mut block[i], &[rates[0][i], rates[1][i], rates[2][i], rates[3][i]], rows);
    }
    block
}

/// Adds a block off the diagonal, and its mirror image.
#[inline(always)]
fn add_block<const ROWS: usize, const COLUMNS: usize>(
    equations: &mut NormalEquations,
    [row, column]: [usize; 2],
    block: &[Quad],
) {
    let pitch = equations.jtj.nrows();
    let entries = equations.jtj.as_mut_slice();
    for i in 0..ROWS {
        let mirrored = &mut entries[(row + i) * pitch + column..][..COLUMNS];
        for j in 0..COLUMNS {
            mirrored[j] += block[i][j];
        }
    }
    for j in 0..COLUMNS {
        let entries = &mut entries[(column + j) * pitch + row..][..ROWS];
        for i in 0..ROWS {
            entries[i] += block[i][j];
        }
    }
}
