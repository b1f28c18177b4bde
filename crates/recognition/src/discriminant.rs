//! Fisher's discriminants, kept from knowing single people too well.
//!
//! Each number x of a row is first made z = 3 tanh((x − x̄)/3σ). A *cell* is what one subject does of one class; each cell of a class counts
//! the same, so that a person with many recordings does not become the class. Two scatters say what does not make a class: W, the mean over
//! all classes of the scatter within cells, and B, that of people: Σ (m − m̄)(m − m̄)ᵀ/Σ (n − 1) with m the mean of a cell and m̄ of the n cells of its
//! class. Each is shrunk towards a sphere, S' = (1 − κ) S + κ tr(S)/d I, and what a stranger adds counts λ times: N = W' + λ B'.
//! In the coordinates in which N is the unit matrix ([`Nuisance::whitening`]) the principal components of the classes' means (of which there are one less
//! than classes) are the axes. (Fisher 1936; shrinkage: Friedman, "Regularized Discriminant Analysis", 1989; the scatter of people: Hatch,
//! Kajarekar and Stolcke, "Within-class covariance normalization for SVM-based speaker recognition", 2006.)

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::principal;

/// Numbers this many deviations from their mean are pressed together.
const REACH: f64 = 3.0;
/// Deviation below which a number is taken for constant.
const LEAST_DEVIATION: f64 = 1e-6;
/// Variance of what does not make a class, at least, so that nothing is divided by 0.
const LEAST_VARIANCE: f64 = 1e-12;

/// Axes that tell classes apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Discriminant {
    /// Mean of each number.
    pub mean: Vec<f64>,
    /// Deviation of each number.
    pub deviation: Vec<f64>,
    /// Axes, strongest first.
    pub axes: Vec<Vec<f64>>,
    /// Where zero of each axis lies.
    pub origin: Vec<f64>,
}

/// A row that is learnt from.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Its numbers.
    pub row: Vec<f64>,
    /// The number of its class.
    pub class: usize,
    /// The number of its subject.
    pub subject: usize,
}

/// How much each sample counts: classes count the same, subjects within a class count the same, samples of a subject in a class count the same. The
/// sum is the number of samples.
#[must_use]
pub fn balanced_weights(samples: &[Sample]) -> Vec<f64> {
    let mut counts: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for sample in samples {
        *counts.entry((sample.class, sample.subject)).or_default() += 1.0;
    }
    let mut subjects: BTreeMap<usize, f64> = BTreeMap::new();
    for (class, _) in counts.keys() {
        *subjects.entry(*class).or_default() += 1.0;
    }
    let each = samples.len() as f64 / subjects.len().max(1) as f64;
    let weight = |one: &Sample| each / (subjects[&one.class] * counts[&(one.class, one.subject)]);
    samples.iter().map(weight).collect()
}

/// How axes are learnt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxesOptions {
    /// κ: how far scatters are shrunk towards a sphere, 0 to 1.
    pub shrinkage: f64,
    /// λ: how much the scatter of people counts beside that within a person's motions; 0 and more.
    pub strangers: f64,
}

impl Default for AxesOptions {
    fn default() -> Self {
        Self { shrinkage: 0.1, strangers: 3.0 }
    }
}

/// Axes, and what they were found from.
#[derive(Debug, Clone)]
pub struct Learnt {
    /// The axes.
    pub discriminant: Discriminant,
    /// What does not make a class, and what does.
    pub nuisance: Nuisance,
    /// What the samples scatter by.
    pub cells: Cells,
}

/// Scatter of a cell about its mean, and the mean, of standardised numbers.
type Moments = (DMatrix<f64>, DVector<f64>);

/// What each subject does of each class.
#[derive(Debug, Clone)]
pub struct Cells {
    moments: BTreeMap<(usize, usize), Moments>,
    dimension: usize,
}

/// What does not make a class, and what does.
#[derive(Debug, Clone)]
pub struct Nuisance {
    /// Turns standardised numbers into coordinates in which what does not make a class is the unit matrix.
    pub whitening: DMatrix<f64>,
    /// The number of each class that has a cell, and its mean.
    pub means: Vec<(usize, DVector<f64>)>,
}

impl Cells {
    fn of(axes: &Discriminant, samples: &[Sample]) -> Self {
        let dimension = axes.mean.len();
        let mut rows: BTreeMap<(usize, usize), Vec<DVector<f64>>> = BTreeMap::new();
        for sample in samples {
            let row = DVector::from_vec(axes.standardised(&sample.row));
            rows.entry((sample.class, sample.subject)).or_default().push(row);
        }
        let moments = rows.into_iter().map(|(cell, rows)| {
            let scale = 1.0 / rows.len() as f64;
            let mean = rows.iter().fold(DVector::zeros(dimension), |a, b| a + b) * scale;
            let centred: Vec<DVector<f64>> = rows.iter().map(|row| row - &mean).collect();
            let all = DMatrix::from_columns(&centred);
            (cell, (&all * all.transpose() * scale, mean))
        });
        Self { moments: moments.collect(), dimension }
    }

    /// What is left where one subject is left out, or none.
    #[must_use]
    pub fn without(&self, subject: Option<usize>, options: AxesOptions) -> Nuisance {
        let mut classes: BTreeMap<usize, Vec<&Moments>> = BTreeMap::new();
        for ((class, of), moments) in &self.moments {
            if Some(*of) != subject {
                classes.entry(*class).or_default().push(moments);
            }
        }
        let zero: DMatrix<f64> = DMatrix::zeros(self.dimension, self.dimension);
        let (mut within, mut people, mut freedom) = (zero.clone(), zero, 0);
        let mut means = Vec::new();
        for (&class, cells) in &classes {
            let scale = 1.0 / cells.len() as f64;
            let mean = cells.iter().fold(DVector::zeros(self.dimension), |sum, (_, cell)| sum + cell * scale);
            for (scatter, cell) in cells {
                within += scatter * (scale / classes.len() as f64);
                let off = cell - &mean;
                people.syger(1.0, &off, &off, 1.0);
            }
            freedom += cells.len() - 1;
            means.push((class, mean));
        }
        people.fill_upper_triangle_with_lower_triangle();
        people /= freedom.max(1) as f64;
        let nuisance =
            shrunk(&within, options.shrinkage) + shrunk(&people, options.shrinkage) * options.strangers;
        let (values, vectors) = principal::eigen(nuisance);
        let whitening = DMatrix::from_fn(self.dimension, self.dimension, |row, column| {
            vectors[row][column] / values[row].max(LEAST_VARIANCE).sqrt()
        });
        Nuisance { whitening, means }
    }
}

/// A matrix, part of the way to the sphere of its trace.
fn shrunk(matrix: &DMatrix<f64>, shrinkage: f64) -> DMatrix<f64> {
    let dimension = matrix.nrows();
    let sphere = matrix.trace() / dimension.max(1) as f64;
    matrix * (1.0 - shrinkage) + DMatrix::identity(dimension, dimension) * (shrinkage * sphere)
}

impl Discriminant {
    /// Learns axes from samples, of which there is one at least.
    #[must_use]
    pub fn learn(samples: &[Sample], options: AxesOptions) -> Learnt {
        let dimension = samples.first().map_or(0, |sample| sample.row.len());
        let count = samples.len().max(1) as f64;
        let column = |index: usize| samples.iter().map(move |sample| sample.row[index]);
        let mean: Vec<f64> = (0..dimension).map(|index| column(index).sum::<f64>() / count).collect();
        let deviation = (0..dimension).map(|index| {
            let variance = column(index).map(|x| (x - mean[index]).powi(2)).sum::<f64>() / count;
            variance.sqrt().max(LEAST_DEVIATION)
        });
        let mut found = Self { deviation: deviation.collect(), mean, axes: Vec::new(), origin: Vec::new() };
        let cells = Cells::of(&found, samples);
        let nuisance = cells.without(None, options);
        let whitening = &nuisance.whitening;
        let means: Vec<&DVector<f64>> = nuisance.means.iter().map(|(_, mean)| mean).collect();
        let centre = means.iter().fold(DVector::zeros(dimension), |a, b| a + *b) / means.len().max(1) as f64;
        let mut between = DMatrix::zeros(dimension, dimension);
        for &mean in &means {
            let white = whitening * (mean - &centre);
            between.syger(1.0, &white, &white, 1.0);
        }
        between.fill_upper_triangle_with_lower_triangle();
        let (_, directions) = principal::eigen(between);
        for direction in directions.into_iter().take(means.len().saturating_sub(1)) {
            let axis = whitening.tr_mul(&DVector::from_vec(direction));
            found.origin.push(axis.dot(&centre));
            found.axes.push(axis.as_slice().to_vec());
        }
        Learnt { discriminant: found, nuisance, cells }
    }

    /// A row's numbers in deviations from their means, pressed together where they are far away.
    #[must_use]
    pub fn standardised(&self, row: &[f64]) -> Vec<f64> {
        let spread = self.mean.iter().zip(&self.deviation);
        row.iter().zip(spread).map(|(x, (mean, s))| REACH * ((x - mean) / (REACH * s)).tanh()).collect()
    }

    /// A row's coordinates along the axes; classes have about unit spread along each.
    #[must_use]
    pub fn project(&self, row: &[f64]) -> Vec<f64> {
        let z = self.standardised(row);
        let along = |axis: &Vec<f64>| axis.iter().zip(&z).map(|(a, z)| a * z).sum::<f64>();
        self.axes.iter().zip(&self.origin).map(|(axis, origin)| along(axis) - origin).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_where_classes_differ_and_not_where_they_spread() {
        let sample = |index: usize| {
            let (class, subject) = (index % 2, index % 3);
            let noise = (index as f64 * 1.7).sin();
            let row = vec![class as f64 + 0.2 * noise, 10.0 * (index as f64 * 0.9).cos(), 3.0];
            Sample { row, class, subject }
        };
        let samples: Vec<Sample> = (0..120).map(sample).collect();
        let found =
            Discriminant::learn(&samples, AxesOptions { shrinkage: 0.3, strangers: 1.0 }).discriminant;
        assert_eq!(found.axes.len(), 1);
        let places: Vec<f64> = samples.iter().map(|sample| found.project(&sample.row)[0]).collect();
        let side = |place: f64, class: usize| (place > 0.0) == (class == 1);
        let flipped = !side(places[1], 1);
        assert!(places.iter().zip(&samples).all(|(place, sample)| side(*place, sample.class) != flipped));
    }

    /// Classes lie apart along the first and the second number; people scatter along the second only.
    #[test]
    fn what_people_differ_by_makes_no_class() {
        let sample = |index: usize| {
            let (class, subject) = (index % 2, index / 2 % 4);
            let [a, b] = [1.7, 0.9].map(|f| 0.2 * (index as f64 * f).sin());
            let person = [1.5, -1.5, 0.6, -0.6][subject];
            Sample { row: vec![class as f64 + a, class as f64 + person + b], class, subject }
        };
        let samples: Vec<Sample> = (0..240).map(sample).collect();
        let weight = |strangers: f64| {
            let axes =
                Discriminant::learn(&samples, AxesOptions { shrinkage: 0.01, strangers }).discriminant.axes;
            (axes[0][1] / axes[0][0]).abs()
        };
        assert!(weight(0.0) > 0.5 && weight(3.0) < 0.1, "{} and {}", weight(0.0), weight(3.0));
        let learnt = Discriminant::learn(&samples, AxesOptions::default());
        let all = &learnt.nuisance;
        let some = learnt.cells.without(Some(0), AxesOptions::default());
        // Who is left out draws no mean.
        assert!(some.means[0].1[1] < all.means[0].1[1] - 0.1, "{:?} {:?}", some.means, all.means);
    }

    #[test]
    fn subjects_with_many_samples_count_as_one() {
        let cells = [(0, 0), (0, 0), (0, 0), (0, 1), (1, 0)];
        let weights =
            balanced_weights(&cells.map(|(class, subject)| Sample { row: Vec::new(), class, subject }));
        let expected = [5.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 5.0 / 4.0, 5.0 / 2.0];
        assert!(weights.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{weights:?}");
    }
}
