//! D − Λ of every pixel (4.10, 4.16), summed as wrench blocks per limb.
//!
//! Pixels that no limb comes near have Λ = 255 and no gradient: their cost is a constant of the data,
//! corrected over the spans that limbs touch. The work grows with the area of the limbs, not with the picture.

use std::ops::Range;

use glam::{DMat3, DVec3};
use nalgebra::SVector;
use pulp::{Simd, WithSimd};

use super::RowSums;
use super::composite::{Composite, JointSums};
use super::loss::Loss;
pub use super::state_map::StateMap;
use crate::body::Kinematics;
use crate::camera::Camera;
use crate::processor::run_in_four_f64s;
use crate::render::wrench::{Wrench, WrenchBlock};
use crate::render::{BACKGROUND, Lanes, PixelGrid, Primitive, RowWinners, View, prediction};
use crate::silhouette::Measurement;

/// One camera's data on a grid of every `stride`-th pixel.
#[derive(Debug, Clone)]
pub struct SampledData {
    grid: PixelGrid,
    /// Σ w (D − 255)² over the grid.
    empty_cost: f64,
    /// Σ w over the sampled pixels: what the cost is divided by for a mean.
    pub total_weight: f64,
}

impl SampledData {
    /// Takes every `stride`-th pixel, from the middle of the first block.
    pub fn new(measurement: &Measurement, stride: usize) -> Self {
        let grid = PixelGrid::new(measurement.width(), measurement.values(), measurement.weights(), stride);
        Self::of(grid)
    }

    /// The same of a picture of a width and a height whose rows are worked out: `fill` hears which pixels a row has, and
    /// writes their D and their weights. Rows without samples are never asked for.
    pub(crate) fn of_rows(
        size: [usize; 2],
        stride: usize,
        fill: impl Fn(Range<usize>, &mut [f32], &mut [f32]),
    ) -> Self {
        Self::of(PixelGrid::of_rows(size, stride, fill))
    }

    /// The same with pixels doubted whose residual at a pose is too large to be believed: weights times c′(ρ²), in
    /// grey levels.
    ///
    /// Weights stay as they are until this is called again: the outer loop of iteratively reweighted least
    /// squares.
    pub fn doubted(&self, view: &View, loss: Loss) -> Self {
        let (width, levels) = (view.size[0], prediction::levels(view));
        Self::of(self.grid.reweighted(|x, y, value, weight| {
            let residual = f64::from(value) - levels[y * width + x];
            weight * loss.weight(residual * residual) as f32
        }))
    }

    fn of(grid: PixelGrid) -> Self {
        // Several sums side by side do not wait for one another. What pads a row weighs nothing.
        const LANES: usize = 8;
        let (mut costs, mut weights) = ([0.0; LANES], [0.0; LANES]);
        for tile_row in 0..grid.tile_rows() {
            let [values, row_weights] = grid.tile_row(tile_row).map(|data| data.as_chunks::<LANES>().0);
            for (values, row_weights) in values.iter().zip(row_weights) {
                for lane in 0..LANES {
                    let weight = f64::from(row_weights[lane]);
                    let from_background = f64::from(values[lane]) - BACKGROUND;
                    costs[lane] += weight * (from_background * from_background);
                    weights[lane] += weight;
                }
            }
        }
        Self { grid, empty_cost: costs.iter().sum(), total_weight: weights.iter().sum() }
    }

    /// Cost Σ w (D − Λ)², and the wrench block of every limb (camera axes), by the fastest kernel that can.
    ///
    /// `blocks` has one entry per limb and comes cleared.
    pub fn accumulate(&self, view: &View, memory: &mut KernelMemory, blocks: &mut [WrenchBlock]) -> f64 {
        if view.suits_lanes() {
            (self.empty_cost + memory.lanes.accumulate(view, &self.grid, Some(blocks))).max(0.0)
        } else {
            self.accumulate_scalar(view, memory, blocks)
        }
    }

    /// The cost alone, by the same kernel: to the bit what [`accumulate`](Self::accumulate) returns.
    pub fn cost(&self, view: &View, memory: &mut KernelMemory) -> f64 {
        if view.suits_lanes() {
            (self.empty_cost + memory.lanes.accumulate(view, &self.grid, None)).max(0.0)
        } else {
            self.pull_scalar(view, &mut memory.row, |_, _, _, _| {})
        }
    }

    /// The same by the reference kernel, in f64, one pixel at a time.
    pub fn accumulate_scalar(
        &self,
        view: &View,
        memory: &mut KernelMemory,
        blocks: &mut [WrenchBlock],
    ) -> f64 {
        self.pull_scalar(view, &mut memory.row, |primitive, ray, weight, residual| {
            if let Some(wrench) = primitive.sample(ray).wrench {
                blocks[primitive.limb].add(wrench, weight, residual);
            }
        })
    }

    /// Cost of the reference kernel; `pull` hears of every pixel that is not clipped: its winner, its ray, its
    /// weight and its residual.
    fn pull_scalar(
        &self,
        view: &View,
        row: &mut RowWinners,
        mut pull: impl FnMut(&Primitive, DVec3, f64, f64),
    ) -> f64 {
        let PixelGrid { rows, columns, stride, offset, .. } = self.grid;
        // Summed again row by row: the order of the tiles depends on the vectors.
        let mut cost = 0.0;
        for grid_row in 0..rows {
            cost += (0..columns)
                .map(|column| {
                    let (data, weight) = self.grid.at(grid_row, column);
                    f64::from(weight) * (f64::from(data) - BACKGROUND).powi(2)
                })
                .sum::<f64>();
            let y = self.grid.pixel(grid_row);
            row.find(view, y, stride, offset);
            let mut row_cost = 0.0;
            for x in row.touched().step_by(stride) {
                let Some(winner) = row.winner(x) else { continue };
                let (data, weight) = self.grid.at(grid_row, (x - offset) / stride);
                let (data, weight) = (f64::from(data), f64::from(weight));
                if weight == 0.0 {
                    continue;
                }
                let residual = data - BACKGROUND * row.level(x).clamp(0.0, 1.0);
                row_cost += weight * (residual * residual - (data - BACKGROUND).powi(2));
                if row.level(x) > 0.0 {
                    pull(&view.primitives[winner], view.ray(x, y), weight, residual);
                }
            }
            cost += row_cost;
        }
        cost.max(0.0)
    }
}

/// Memory of the kernels, one per camera, reused from evaluation to evaluation.
#[derive(Debug, Clone, Default)]
pub struct KernelMemory {
    lanes: Lanes,
    row: RowWinners,
}

/// Sums of all limbs over all cameras, in world axes.
#[derive(Debug, Clone)]
pub struct WorldBlocks {
    joints: Vec<JointSums>,
    /// Of limbs whose pull is not all at their joints.
    wrenches: Vec<Option<RowSums<7>>>,
}

impl WorldBlocks {
    /// Nothing yet.
    pub fn new(limbs: usize) -> Self {
        Self { joints: vec![JointSums::default(); limbs], wrenches: vec![None; limbs] }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.joints.fill(JointSums::default());
        self.wrenches.fill(None);
    }

    /// Whether no pixel of any camera pulls at any limb: the body is out of every picture.
    pub fn is_empty(&self) -> bool {
        let no_wrench = |sums: &Option<RowSums<7>>| sums.as_ref().is_none_or(RowSums::is_empty);
        self.joints.iter().all(JointSums::is_empty) && self.wrenches.iter().all(no_wrench)
    }

    /// Adds one camera's blocks with the camera's weight.
    pub fn add(&mut self, camera: &Camera, blocks: &[WrenchBlock], weight: f64) {
        let camera_from_world = camera.camera_from_world().rotation;
        run_in_four_f64s(AddJoints { sums: &mut self.joints, blocks, camera_from_world, weight });
        for (limb, block) in blocks.iter().enumerate() {
            if block.pixels > 0 {
                let (products, forces) = block.in_world(camera_from_world);
                let sums = self.wrenches[limb].get_or_insert_with(Default::default);
                sums.products += products * weight;
                sums.forces += forces * weight;
            }
        }
    }

    /// Adds one row: a wrench in world axes with its weight and its residual.
    pub(crate) fn add_wrench(&mut self, limb: usize, wrench: Wrench, weight: f64, residual: f64) {
        let sums = self.wrenches[limb].get_or_insert_with(Default::default);
        sums.add(&SVector::from(wrench.to_array()), weight, residual);
    }

    /// All that pulls at a limb, about its first joint.
    #[inline(always)]
    pub(super) fn of_limb<S: Simd>(
        &self,
        simd: S,
        limb: usize,
        kinematics: &Kinematics,
        composite: &mut Composite,
    ) {
        let axis = kinematics.ends()[limb] - kinematics.starts()[limb];
        *composite = self.joints[limb].composite(simd, axis);
        if let Some(sums) = &self.wrenches[limb] {
            composite.add(simd, &Composite::of_wrenches(sums));
        }
    }
}

/// Adds one camera's forces at joints.
struct AddJoints<'a> {
    sums: &'a mut [JointSums],
    blocks: &'a [WrenchBlock],
    camera_from_world: DMat3,
    weight: f64,
}

impl WithSimd for AddJoints<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for (sums, block) in self.sums.iter_mut().zip(self.blocks) {
            if !block.joints.is_empty() {
                sums.add(simd, &block.joints, self.camera_from_world, self.weight);
            }
        }
    }
}
