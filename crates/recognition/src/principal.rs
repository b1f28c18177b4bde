//! Principal components: with x̄ the mean and C the covariance of all rows, the unit eigenvectors of C with the largest eigenvalues are
//! the rows of V, and a row x becomes V (x − x̄).

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Principal components of some rows of numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrincipalComponents {
    /// The mean of all rows.
    pub mean: Vec<f64>,
    /// Components, strongest first: unit vectors whose largest coefficient is positive.
    pub components: Vec<Vec<f64>>,
    /// The part of the rows' variance that each component has.
    pub shares: Vec<f64>,
}

impl PrincipalComponents {
    /// The strongest `count` components of rows of one length, of which there is one at least.
    #[must_use]
    pub fn of(rows: &[Vec<f64>], count: usize) -> Self {
        let dimension = rows.first().map_or(0, Vec::len);
        let scale = 1.0 / rows.len().max(1) as f64;
        let mut mean = DVector::zeros(dimension);
        for row in rows {
            mean += DVector::from_column_slice(row) * scale;
        }
        let mut covariance = DMatrix::zeros(dimension, dimension);
        for row in rows {
            let centred = DVector::from_column_slice(row) - &mean;
            covariance.syger(scale, &centred, &centred, 1.0);
        }
        covariance.fill_upper_triangle_with_lower_triangle();
        let total = covariance.trace();
        let (values, vectors) = eigen(covariance);
        let components: Vec<Vec<f64>> = vectors.into_iter().take(count).collect();
        let shares = values.iter().take(components.len());
        let shares = shares.map(|value| if total > 0.0 { value / total } else { 0.0 }).collect();
        Self { mean: mean.as_slice().to_vec(), components, shares }
    }

    /// A row's coordinates along the components.
    #[must_use]
    pub fn project(&self, row: &[f64]) -> Vec<f64> {
        let along = |axis: &Vec<f64>| {
            axis.iter().zip(row.iter().zip(&self.mean)).map(|(a, (x, mean))| a * (x - mean)).sum()
        };
        self.components.iter().map(along).collect()
    }
}

/// Eigenvalues and eigenvectors of a symmetric matrix, largest value first; the largest coefficient of a vector is positive.
pub(crate) fn eigen(matrix: DMatrix<f64>) -> (Vec<f64>, Vec<Vec<f64>>) {
    let found = matrix.symmetric_eigen();
    let mut order: Vec<usize> = (0..found.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| found.eigenvalues[b].total_cmp(&found.eigenvalues[a]));
    let vector = |&index: &usize| -> Vec<f64> {
        let column = found.eigenvectors.column(index);
        let sign = column[column.iamax()].signum();
        column.iter().map(|x| x * sign).collect()
    };
    (order.iter().map(|&index| found.eigenvalues[index]).collect(), order.iter().map(vector).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretched_cloud_has_its_axes() {
        let rows: Vec<Vec<f64>> = (0..200)
            .map(|index| {
                let (long, short) = (3.0 * f64::from(index).sin(), f64::from(index * 7).cos());
                vec![1.0 + 0.8 * long - 0.6 * short, 2.0 + 0.6 * long + 0.8 * short, 5.0]
            })
            .collect();
        let found = PrincipalComponents::of(&rows, 2);
        assert!((found.components[0][0] - 0.8).abs() < 0.02, "{:?}", found.components);
        assert!(found.components[1][2].abs() < 1e-9 && found.shares[0] > 0.85);
        assert!((found.shares[0] + found.shares[1] - 1.0).abs() < 1e-9);
        let [a, b]: [Vec<f64>; 2] = [found.project(&rows[3]), found.project(&rows[50])];
        let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        assert!((distance(&a, &b) - distance(&rows[3], &rows[50])).abs() < 1e-9);
    }
}
