//! Mixtures of Student's t, as energies with the pull of each component.
//!
//! E(x) = −2 ln(p(x)/Σ πₖ cₖ), with the responsibilities rₖ = πₖ pₖ(x)/p(x) and uₖ = (ν + D)/(ν + mₖ):
//!
//! ½ ∇E = Σ rₖ uₖ Σₖ⁻¹ (x − μₖ),
//!
//! exactly. Σ rₖ uₖ Σₖ⁻¹ stands for the curvature: the quadratic with this gradient and this curvature lies nowhere below E (it
//! is the bound that expectation maximisation steps on), so a damped step on it goes downhill.

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::statistics::log_sum_exp;

/// Components that are responsible for less than this are not looked at.
const LEAST_RESPONSIBLE: f64 = 1e-6;

/// One component.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudentComponent {
    /// π: its share of the whole, more than 0.
    pub share: f64,
    /// μ, D numbers.
    pub mean: Vec<f64>,
    /// Σ, the lower triangle row after row: D (D + 1)/2 numbers.
    pub covariance: Vec<f64>,
}

/// A mixture, ready to be asked. Made by [`StudentMixture::new`], which is also what checks it.
#[derive(Debug, Clone, PartialEq)]
pub struct StudentMixture {
    /// The components, as they were given.
    pub components: Vec<StudentComponent>,
    /// ν.
    pub degrees: f64,
    ready: Vec<Ready>,
}

/// What is worked out of a component once.
#[derive(Debug, Clone, PartialEq)]
struct Ready {
    mean: DVector<f64>,
    /// Σ⁻¹.
    precision: DMatrix<f64>,
    /// ln(π c/Σ π c), but for what all components have in common.
    log_height: f64,
}

/// A component as a point sees it.
struct ComponentTerm {
    /// Σₖ⁻¹ (μₖ − x).
    pushed: DVector<f64>,
    /// mₖ.
    squared: f64,
    /// ln(πₖ pₖ(x)/Σ πₖ cₖ).
    log_part: f64,
}

/// Energy at a point, with the force −½ ∇E and a curvature.
#[derive(Debug, Clone, PartialEq)]
pub struct Pull {
    /// E, 0 or more.
    pub energy: f64,
    /// −½ ∇E, D numbers.
    pub force: DVector<f64>,
    /// Σ rₖ uₖ Σₖ⁻¹, D × D, positive definite.
    pub curvature: DMatrix<f64>,
}

impl StudentMixture {
    /// Works out the inverses. `None` if there is no component, sizes differ, a number is not finite, a share is not above
    /// 0, ν is not above 0, or a covariance has no inverse.
    pub fn new(components: Vec<StudentComponent>, degrees: f64) -> Option<Self> {
        let size = components.first()?.mean.len();
        if !(degrees.is_finite() && degrees > 0.0) || size == 0 {
            return None;
        }
        let mut ready = Vec::with_capacity(components.len());
        for StudentComponent { share, mean, covariance } in &components {
            let fits = mean.len() == size && covariance.len() == size * (size + 1) / 2;
            let are_numbers = mean.iter().chain(covariance).all(|number| number.is_finite());
            if !(fits && are_numbers && share.is_finite() && *share > 0.0) {
                return None;
            }
            let decomposed = Cholesky::new(symmetric(covariance, size))?;
            let log_height = share.ln() - 0.5 * decomposed.ln_determinant();
            let precision = decomposed.inverse();
            if !(log_height.is_finite() && precision.iter().all(|number| number.is_finite())) {
                return None;
            }
            ready.push(Ready { mean: DVector::from_column_slice(mean), precision, log_height });
        }
        let whole = log_sum_exp(ready.iter().map(|one| one.log_height));
        ready.iter_mut().for_each(|one| one.log_height -= whole);
        Some(Self { components, degrees, ready })
    }

    /// D.
    pub fn size(&self) -> usize {
        self.ready[0].mean.len()
    }

    /// E and its pull at x, D numbers.
    pub fn pull(&self, x: &DVector<f64>) -> Pull {
        let (terms, log_density) = self.components_at(x);
        let mut force = DVector::zeros(self.size());
        let mut curvature = DMatrix::zeros(self.size(), self.size());
        for (term, one) in terms.iter().zip(&self.ready) {
            let responsible = (term.log_part - log_density).exp();
            if responsible < LEAST_RESPONSIBLE {
                continue;
            }
            let weight = responsible * self.believed(term.squared);
            force.axpy(weight, &term.pushed, 1.0);
            curvature.zip_apply(&one.precision, |sum, number| *sum += weight * number);
        }
        Pull { energy: (-2.0 * log_density).max(0.0), force, curvature }
    }

    /// rₖ and uₖ of every component.
    pub(super) fn weights(&self, x: &DVector<f64>) -> Vec<[f64; 2]> {
        let (terms, log_density) = self.components_at(x);
        terms.iter().map(|term| [(term.log_part - log_density).exp(), self.believed(term.squared)]).collect()
    }

    /// u = (ν + D)/(ν + m).
    fn believed(&self, squared: f64) -> f64 {
        (self.degrees + self.size() as f64) / (self.degrees + squared)
    }

    /// Every component at x, and ln(p(x)/Σ πₖ cₖ).
    fn components_at(&self, x: &DVector<f64>) -> (Vec<ComponentTerm>, f64) {
        let by_distance = 0.5 * (self.degrees + self.size() as f64);
        let term = |one: &Ready| {
            let off = &one.mean - x;
            let pushed = &one.precision * &off;
            let squared = pushed.dot(&off);
            let log_part = one.log_height - by_distance * (squared / self.degrees).ln_1p();
            ComponentTerm { pushed, squared, log_part }
        };
        let terms: Vec<ComponentTerm> = self.ready.iter().map(term).collect();
        let log_density = log_sum_exp(terms.iter().map(|term| term.log_part));
        (terms, log_density)
    }

    /// ln p(x), normalised: what trainings are compared by.
    pub fn log_density(&self, x: &DVector<f64>) -> f64 {
        let d = self.size() as f64;
        let shares = self.components.iter().map(|component| component.share).sum::<f64>();
        let peaks = log_sum_exp(self.components.iter().zip(&self.ready).map(|(component, one)| {
            let half_log_determinant = Cholesky::new(one.precision.clone())
                .map_or(f64::NEG_INFINITY, |decomposed| 0.5 * decomposed.ln_determinant());
            (component.share / shares).ln() + half_log_determinant
        }));
        let normal = ln_gamma(0.5 * (self.degrees + d))
            - ln_gamma(0.5 * self.degrees)
            - 0.5 * d * (self.degrees * std::f64::consts::PI).ln();
        normal + peaks - 0.5 * self.pull(x).energy
    }
}

/// A symmetric matrix of its lower triangle.
pub(super) fn symmetric(lower: &[f64], size: usize) -> DMatrix<f64> {
    DMatrix::from_fn(size, size, |i, j| {
        let (row, column) = (i.max(j), i.min(j));
        lower[row * (row + 1) / 2 + column]
    })
}

/// The lower triangle of a symmetric matrix.
pub(super) fn lower_triangle(matrix: &DMatrix<f64>) -> Vec<f64> {
    (0..matrix.nrows()).flat_map(|row| (0..=row).map(move |column| matrix[(row, column)])).collect()
}

/// ln Γ for arguments above 0 (Lanczos, g = 7, nine terms).
fn ln_gamma(x: f64) -> f64 {
    const TERMS: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let sum = (1..9).fold(TERMS[0], |sum, i| sum + TERMS[i] / (x + i as f64));
    let t = x + 7.5;
    0.5 * std::f64::consts::TAU.ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> StudentMixture {
        let component = |share, mean: [f64; 2], covariance: [f64; 3]| StudentComponent {
            share,
            mean: mean.to_vec(),
            covariance: covariance.to_vec(),
        };
        let all = vec![
            component(0.7, [0.0, 0.0], [0.04, 0.01, 0.09]),
            component(0.3, [1.0, 0.5], [0.02, -0.005, 0.03]),
        ];
        StudentMixture::new(all, 4.0).unwrap()
    }

    #[test]
    fn the_force_is_the_energys_and_the_bound_lies_above_it() {
        let mixture = two();
        for at in [[0.1, 0.0], [0.5, 0.3], [0.9, 0.6], [-3.0, 4.0], [0.55, 0.26]] {
            let x = DVector::from_column_slice(&at);
            let here = mixture.pull(&x);
            assert!(here.energy >= 0.0);
            for axis in 0..2 {
                let h = 1e-6;
                let moved = |sign: f64| {
                    let mut x = x.clone();
                    x[axis] += sign * h;
                    mixture.pull(&x).energy
                };
                let numeric = (moved(1.0) - moved(-1.0)) / (2.0 * h);
                let worst = (numeric + 2.0 * here.force[axis]).abs();
                assert!(worst < 1e-6 * (1.0 + numeric.abs()), "{at:?}: {numeric}, {}", here.force);
            }
            for (dx, dy) in [(0.3, 0.0), (-0.2, 0.4), (1.0, -1.0), (0.01, 0.02)] {
                let step = DVector::from_column_slice(&[dx, dy]);
                let bound = here.energy - 2.0 * here.force.dot(&step) + step.dot(&(&here.curvature * &step));
                let energy = mixture.pull(&(&x + &step)).energy;
                assert!(energy <= bound + 1e-9, "{at:?} + {dx}, {dy}: {energy} above {bound}");
            }
        }
    }

    /// It yields: far away the pull falls off as 1/distance.
    #[test]
    fn what_is_far_off_is_hardly_pulled() {
        let mixture = two();
        let force = |x: f64| mixture.pull(&DVector::from_column_slice(&[x, 0.0])).force.norm();
        assert!(force(20.0) < 0.55 * force(10.0), "{} {}", force(20.0), force(10.0));
        assert!(force(10.0) < 0.2 * force(-0.2), "{} {}", force(10.0), force(-0.2));
    }

    #[test]
    fn densities_sum_to_one() {
        let mixture = two();
        let (cells, width) = (600, 12.0);
        let cell: f64 = width / f64::from(cells);
        let mut sum = 0.0;
        for i in 0..cells {
            for j in 0..cells {
                let at = |index: i32| (f64::from(index) + 0.5) * cell - 0.5 * width;
                sum += mixture.log_density(&DVector::from_column_slice(&[at(i), at(j)])).exp();
            }
        }
        assert!((sum * cell * cell - 1.0).abs() < 0.01, "{}", sum * cell * cell);
    }

    #[test]
    fn what_is_no_mixture_is_none() {
        let good = two().components;
        let with = |change: fn(&mut Vec<StudentComponent>)| {
            let mut components = good.clone();
            change(&mut components);
            StudentMixture::new(components, 4.0)
        };
        assert!(with(|_| ()).is_some());
        assert_eq!(with(Vec::clear), None);
        assert_eq!(with(|all| all[1].covariance[1] = 1.0), None);
        assert_eq!(with(|all| all[1].share = 0.0), None);
        assert_eq!(with(|all| all[0].mean[0] = f64::NAN), None);
        assert_eq!(with(|all| all[0].mean.push(1.0)), None);
        assert_eq!(StudentMixture::new(good.clone(), 0.0), None);
    }
}
