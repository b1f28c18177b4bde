//! Linear support vector machines, one class against the rest.
//!
//! For each class, with y = ±1 and x with a last number 1: min ½ |w|² + Σ cᵢ max(0, 1 − yᵢ wᵀxᵢ)², by descent along one coordinate of the dual after the
//! other (Hsieh et al., "A Dual Coordinate Descent Method for Large-scale Linear SVM", 2008, algorithm 1 with the L2 loss).
//!
//! The crate `linfa-svm` 0.8 was looked at first. It has one weight for all positive and one for all negative samples, where each sample has its own
//! here (subjects count the same, however much they have recorded). And for linear machines too it fills the kernel's matrix of all pairs of samples
//! (`dense_from_fn` of `linfa-kernel` 0.8; the sparse kind keeps nearest neighbours only): 220 MB for the 5,300 windows that are learnt from here.

use nalgebra::{DMatrix, DVector};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

use crate::augment::unit;

/// Rounds through all samples, at most.
const ROUNDS: usize = 200;
/// No multiplier's gradient is farther from its optimum than this at the end.
const TOLERANCE: f64 = 1e-3;

/// A hyperplane a class.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SupportVectors {
    /// By class: a weight a number, and the offset last.
    pub planes: Vec<Vec<f64>>,
}

impl SupportVectors {
    /// Learns from rows of one length with the number of their class and what each costs. The same input gives the same planes.
    #[must_use]
    pub fn learn(rows: &[Vec<f64>], classes: &[usize], costs: &[f64], class_count: usize) -> Self {
        let planes = (0..class_count).map(|class| {
            let signs: Vec<f64> = classes.iter().map(|&c| if c == class { 1.0 } else { -1.0 }).collect();
            plane(rows, &signs, costs)
        });
        Self { planes: planes.collect() }
    }

    /// The planes in the coordinates x that a matrix T makes the own ones of: wᵀ(T x) = (Tᵀ w)ᵀ x.
    #[must_use]
    pub fn before(&self, matrix: &DMatrix<f64>) -> Self {
        let turned = |plane: &Vec<f64>| {
            let (weights, offset) = plane.split_at(matrix.nrows());
            let mut turned = matrix.tr_mul(&DVector::from_column_slice(weights)).as_slice().to_vec();
            turned.extend(offset);
            turned
        };
        Self { planes: self.planes.iter().map(turned).collect() }
    }

    /// How far a row is on each class's side; 1 and more is without doubt.
    #[must_use]
    pub fn margins(&self, row: &[f64]) -> Vec<f64> {
        self.planes.iter().map(|plane| value(plane, row)).collect()
    }
}

fn value(plane: &[f64], row: &[f64]) -> f64 {
    let offset = plane.last().copied().unwrap_or(0.0);
    plane.iter().zip(row).map(|(w, x)| w * x).sum::<f64>() + offset
}

fn plane(rows: &[Vec<f64>], signs: &[f64], costs: &[f64]) -> Vec<f64> {
    let mut plane = vec![0.0; rows.first().map_or(0, Vec::len) + 1];
    let mut multipliers = vec![0.0_f64; rows.len()];
    let squares: Vec<f64> = rows.iter().map(|row| 1.0 + row.iter().map(|x| x * x).sum::<f64>()).collect();
    let mut order: Vec<usize> = (0..rows.len()).collect();
    let mut random = Pcg64Mcg::seed_from_u64(1);
    for _ in 0..ROUNDS {
        for index in (1..order.len()).rev() {
            order.swap(index, (unit(&mut random) * (index + 1) as f64) as usize);
        }
        let mut worst = 0.0_f64;
        for &index in &order {
            let diagonal = 0.5 / costs[index];
            let (sign, before) = (signs[index], multipliers[index]);
            let gradient = sign * value(&plane, &rows[index]) - 1.0 + diagonal * before;
            let projected = if before > 0.0 { gradient } else { gradient.min(0.0) };
            worst = worst.max(projected.abs());
            if projected.abs() < 1e-12 {
                continue;
            }
            let after = (before - gradient / (squares[index] + diagonal)).max(0.0);
            multipliers[index] = after;
            let step = (after - before) * sign;
            for (w, x) in plane.iter_mut().zip(rows[index].iter().chain([&1.0])) {
                *w += step * x;
            }
        }
        if worst < TOLERANCE {
            break;
        }
    }
    plane
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The primal cost of a plane.
    fn cost(plane: &[f64], rows: &[Vec<f64>], signs: &[f64], costs: &[f64]) -> f64 {
        let loss = |i: usize| costs[i] * (1.0 - signs[i] * value(plane, &rows[i])).max(0.0).powi(2);
        0.5 * plane.iter().map(|w| w * w).sum::<f64>() + (0..rows.len()).map(loss).sum::<f64>()
    }

    #[test]
    fn no_plane_nearby_costs_less() {
        let wave = |i: i32, f: f64| (f64::from(i) * f).sin();
        let rows: Vec<Vec<f64>> = (0..60).map(|i| vec![wave(i, 1.1), wave(i, 2.3), wave(i, 0.4)]).collect();
        let sign = |row: &Vec<f64>| if row[0] + 0.5 * row[1] > 0.1 { 1.0 } else { -1.0 };
        let mut signs: Vec<f64> = rows.iter().map(sign).collect();
        signs[7] = -signs[7];
        let costs: Vec<f64> = (0..60).map(|i| 0.5 + f64::from(i % 3)).collect();
        let found = plane(&rows, &signs, &costs);
        let least = cost(&found, &rows, &signs, &costs);
        for axis in 0..4 {
            for step in [-0.02, 0.02] {
                let mut other = found.clone();
                other[axis] += step;
                let other = cost(&other, &rows, &signs, &costs);
                assert!(other > least, "axis {axis}: {other} and {least}");
            }
        }
    }

    #[test]
    fn classes_that_lie_apart_are_told_apart() {
        let rows: Vec<Vec<f64>> =
            (0..90).map(|i| vec![f64::from(i % 3 == 1), f64::from(i % 3 == 2)]).collect();
        let classes: Vec<usize> = (0..90).map(|i| i % 3).collect();
        let machine = SupportVectors::learn(&rows, &classes, &[10.0; 90], 3);
        for (row, class) in rows.iter().zip(classes) {
            let margins = machine.margins(row);
            assert!(margins[class] > 0.5, "{margins:?}");
            assert!((0..3).all(|other| other == class || margins[other] < -0.5), "{margins:?}");
        }
    }
}
