//! D − Λ of every pixel (4.10, 4.16), summed as wrench blocks per limb.
//!
//! Pixels that no limb comes near have Λ = 255 and no gradient: their cost is a constant of the data,
//! corrected over the spans that limbs touch. The work grows with the area of the limbs, not with the picture.

use nalgebra::{SMatrix, SVector};

use crate::body::kinematics::MovingColumn;
use crate::body::{Kinematics, Parameters};
use crate::camera::Camera;
use crate::optimize::NormalEquations;
use crate::render::View;
use crate::render::kernels::lanes::{Grid, Lanes, PADDING};
use crate::render::kernels::scalar::RowWinners;
use crate::render::ramp::BACKGROUND;
use crate::render::wrench::WrenchBlock;
use crate::silhouette::Measurement;

/// One camera's data on a grid of every `stride`-th pixel.
#[derive(Debug, Clone)]
pub struct SampledData {
    grid: Grid,
    /// Σ w (D − 255)² and Σ w over the grid.
    empty_cost: f64,
    total_weight: f64,
}

impl SampledData {
    /// Takes every `stride`-th pixel, from the middle of the first block.
    #[must_use]
    pub fn new(measurement: &Measurement, stride: usize) -> Self {
        let stride = stride.max(1);
        let offset = stride / 2;
        let count = |side: usize| side.saturating_sub(offset).div_ceil(stride);
        let (columns, rows) = (count(measurement.width()), count(measurement.height()));
        let pitch = columns.next_multiple_of(PADDING);
        let mut grid = Grid {
            columns,
            rows,
            pitch,
            stride,
            offset,
            values: vec![BACKGROUND as f32; rows * pitch],
            weights: vec![0.0; rows * pitch],
        };
        let (mut empty_cost, mut total_weight) = (0.0, 0.0);
        for row in 0..rows {
            let from = (offset + row * stride) * measurement.width() + offset;
            for column in 0..columns {
                let (source, slot) = (from + column * stride, row * pitch + column);
                let (value, weight) = (measurement.values()[source], measurement.weights()[source]);
                grid.values[slot] = value;
                grid.weights[slot] = weight;
                empty_cost += f64::from(weight) * (f64::from(value) - BACKGROUND).powi(2);
                total_weight += f64::from(weight);
            }
        }
        Self { grid, empty_cost, total_weight }
    }

    /// Σ w over the sampled pixels: what the cost is divided by for a mean.
    #[must_use]
    pub fn total_weight(&self) -> f64 {
        self.total_weight
    }

    /// Cost Σ w (D − Λ)², and the wrench block of every limb (camera axes), by the fastest kernel that can.
    ///
    /// `blocks` has one entry per limb and comes cleared.
    pub fn accumulate(&self, view: &View, memory: &mut KernelMemory, blocks: &mut [WrenchBlock]) -> f64 {
        if Lanes::can_take(view) {
            (self.empty_cost + memory.lanes.accumulate(view, &self.grid, blocks)).max(0.0)
        } else {
            self.accumulate_scalar(view, &mut memory.row, blocks)
        }
    }

    /// The same by the reference kernel, in f64, one pixel at a time.
    pub fn accumulate_scalar(&self, view: &View, row: &mut RowWinners, blocks: &mut [WrenchBlock]) -> f64 {
        let Grid { rows, pitch, stride, offset, ref values, ref weights, .. } = self.grid;
        let mut cost = self.empty_cost;
        for grid_row in 0..rows {
            let y = offset + grid_row * stride;
            row.find(view, y, stride, offset);
            let mut row_cost = 0.0;
            for x in row.touched().step_by(stride) {
                let Some(winner) = row.winner(x) else { continue };
                let slot = grid_row * pitch + (x - offset) / stride;
                let weight = f64::from(weights[slot]);
                if weight == 0.0 {
                    continue;
                }
                let data = f64::from(values[slot]);
                let residual = data - BACKGROUND * row.level(x).clamp(0.0, 1.0);
                row_cost += weight * (residual * residual - (data - BACKGROUND).powi(2));
                if row.level(x) > 0.0 {
                    let primitive = &view.primitives()[winner];
                    if let Some(wrench) = primitive.sample(view.ray(x, y)).wrench {
                        blocks[primitive.limb].add(wrench, weight, residual);
                    }
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

/// Wrench sums of all limbs over all cameras, in world axes.
#[derive(Debug, Clone)]
pub struct WorldBlocks {
    products: Vec<SMatrix<f64, 7, 7>>,
    forces: Vec<SVector<f64, 7>>,
}

impl WorldBlocks {
    /// Nothing yet.
    #[must_use]
    pub fn new(limbs: usize) -> Self {
        Self { products: vec![SMatrix::zeros(); limbs], forces: vec![SVector::zeros(); limbs] }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.products.fill(SMatrix::zeros());
        self.forces.fill(SVector::zeros());
    }

    /// Whether no pixel of any camera pulls at any limb: the body is out of every picture.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.products.iter().all(|products| products.trace() == 0.0)
    }

    /// Adds one camera's blocks with the camera's weight.
    pub fn add(&mut self, camera: &Camera, blocks: &[WrenchBlock], weight: f64) {
        for (limb, block) in blocks.iter().enumerate().filter(|(_, block)| !block.is_empty()) {
            let (products, forces) = block.in_world(camera.camera_from_world().rotation);
            self.products[limb] += products * weight;
            self.forces[limb] += forces * weight;
        }
    }

    /// Maps the sums to the state: JᵀJ += KᵀMK, Jᵀρ += Kᵀm, over the columns that move each limb.
    pub fn add_to(
        &self,
        kinematics: &Kinematics,
        parameters: Parameters,
        columns: &mut Vec<MovingColumn>,
        equations: &mut NormalEquations,
    ) {
        for (limb, (products, forces)) in self.products.iter().zip(&self.forces).enumerate() {
            if products[(0, 0)] == 0.0 && products[(1, 1)] == 0.0 && products[(2, 2)] == 0.0 {
                continue;
            }
            kinematics.moving_columns_into(limb, parameters, columns);
            for (first, a) in columns.iter().enumerate() {
                let motion = SVector::from(a.motion);
                let pushed = products * motion;
                equations.jtr[a.index] += motion.dot(forces);
                for b in &columns[first..] {
                    let sum = pushed.dot(&SVector::from(b.motion));
                    equations.jtj[(a.index, b.index)] += sum;
                    if a.index != b.index {
                        equations.jtj[(b.index, a.index)] += sum;
                    }
                }
            }
        }
    }
}
