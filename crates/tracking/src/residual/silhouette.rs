//! D − Λ of every pixel (4.10, 4.16), summed as wrench blocks per limb.
//!
//! Pixels that no limb comes near have Λ = 255 and no gradient: their cost is a constant of the data,
//! corrected over the spans that limbs touch. The work grows with the area of the limbs, not with the picture.

use nalgebra::{DMatrix, SMatrix, SVector};

use crate::body::{Kinematics, Parameters};
use crate::camera::Camera;
use crate::optimize::NormalEquations;
use crate::render::View;
use crate::render::kernels::scalar::RowWinners;
use crate::render::ramp::BACKGROUND;
use crate::render::wrench::WrenchBlock;
use crate::silhouette::Measurement;

/// One camera's data on a grid of every `stride`-th pixel.
#[derive(Debug, Clone)]
pub struct SampledData {
    width: usize,
    height: usize,
    stride: usize,
    /// D and weight of every pixel, row-major.
    values: Vec<f32>,
    weights: Vec<f32>,
    /// Σ w (D − 255)² and Σ w over the grid.
    empty_cost: f64,
    total_weight: f64,
}

impl SampledData {
    /// Takes every `stride`-th pixel, from the middle of the first block.
    #[must_use]
    pub fn new(measurement: &Measurement, stride: usize) -> Self {
        let mut this = Self {
            width: measurement.width(),
            height: measurement.height(),
            stride: stride.max(1),
            values: measurement.values().to_vec(),
            weights: measurement.weights().to_vec(),
            empty_cost: 0.0,
            total_weight: 0.0,
        };
        for y in this.rows() {
            for x in this.columns() {
                let slot = y * this.width + x;
                let weight = f64::from(this.weights[slot]);
                this.empty_cost += weight * (f64::from(this.values[slot]) - BACKGROUND).powi(2);
                this.total_weight += weight;
            }
        }
        this
    }

    fn offset(&self) -> usize {
        self.stride / 2
    }

    fn rows(&self) -> impl Iterator<Item = usize> + use<> {
        (self.offset()..self.height).step_by(self.stride)
    }

    fn columns(&self) -> impl Iterator<Item = usize> + use<> {
        (self.offset()..self.width).step_by(self.stride)
    }

    /// Σ w over the sampled pixels: what the cost is divided by for a mean.
    #[must_use]
    pub fn total_weight(&self) -> f64 {
        self.total_weight
    }

    /// Cost Σ w (D − Λ)², and the wrench block of every limb (camera axes).
    ///
    /// `blocks` has one entry per limb and comes cleared.
    pub fn accumulate(&self, view: &View, row: &mut RowWinners, blocks: &mut [WrenchBlock]) -> f64 {
        let mut cost = self.empty_cost;
        for y in self.rows() {
            row.find(view, y, self.stride, self.offset());
            let mut row_cost = 0.0;
            for x in row.touched().step_by(self.stride) {
                let Some(winner) = row.winner(x) else { continue };
                let slot = y * self.width + x;
                let weight = f64::from(self.weights[slot]);
                if weight == 0.0 {
                    continue;
                }
                let data = f64::from(self.values[slot]);
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
        map: &mut DMatrix<f64>,
        equations: &mut NormalEquations,
    ) {
        for (limb, (products, forces)) in self.products.iter().zip(&self.forces).enumerate() {
            if products[(0, 0)] == 0.0 && products[(1, 1)] == 0.0 && products[(2, 2)] == 0.0 {
                continue;
            }
            kinematics.fill_map(limb, parameters, map);
            let columns = kinematics.moving_columns(limb, parameters);
            for &i in &columns {
                let k_i: SVector<f64, 7> = map.column(i).fixed_rows::<7>(0).into_owned();
                let pushed = products * k_i;
                equations.jtr[i] += k_i.dot(forces);
                for &j in &columns {
                    let k_j = map.column(j);
                    let mut sum = 0.0;
                    for row in 0..7 {
                        sum += pushed[row] * k_j[row];
                    }
                    equations.jtj[(i, j)] += sum;
                }
            }
        }
    }
}
