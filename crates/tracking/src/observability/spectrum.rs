//! Eigenvalues of a set of cameras' scaled JᵀJ, and which of them are null.

use nalgebra::DMatrix;

use super::information::FrameInformation;

/// Eigenvalues of the scaled JᵀJ, largest first, with their vectors as columns, and how many are not null.
pub(super) struct Spectrum {
    pub(super) values: Vec<f64>,
    pub(super) vectors: DMatrix<f64>,
    pub(super) rank: usize,
    pub(super) null_below: f64,
}

impl FrameInformation {
    /// The scaled JᵀJ's eigenvalues and what of them is null.
    pub(super) fn spectrum(&self, cameras: &[usize]) -> Spectrum {
        let mut scaled = self.equations(cameras).jtj;
        for axis in 0..3 {
            scaled.row_mut(axis).scale_mut(self.lever);
            scaled.column_mut(axis).scale_mut(self.lever);
        }
        let columns = scaled.nrows();
        let pixels: usize = self.parts(cameras).map(|part| part.ramp_pixels).sum();
        let eigen = scaled.symmetric_eigen();
        let mut order: Vec<usize> = (0..columns).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let values: Vec<f64> = order.iter().map(|&index| eigen.eigenvalues[index].max(0.0)).collect();
        let null_below = f64::EPSILON * (columns + pixels) as f64;
        let rank = values.iter().take_while(|value| **value > null_below * values[0]).count();
        Spectrum { vectors: eigen.eigenvectors.select_columns(&order), values, rank, null_below }
    }
}
