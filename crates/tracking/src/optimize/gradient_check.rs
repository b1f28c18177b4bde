//! Analytic derivatives against central differences: every mismatch by name, worst first.
//!
//! With f at −2h, −h, 0, h, 2h along one column, numeric = (f(h) − f(−h)) / 2h. The four slopes between
//! neighbours of a smooth function form an arithmetic progression up to h² f‴. Where they do not, the function
//! has a kink there (a pixel changes its winner, a ramp clips) and differences cannot tell the derivative:
//! such entries are skipped and counted. Only function values decide that, so a wrong derivative cannot hide.

use std::fmt;
use std::ops::AddAssign;

use nalgebra::DMatrix;

use super::{LeastSquares, NormalEquations};

/// Where a function is evaluated, in steps.
const STEPS: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
/// Most mismatches that the text of a [`GradientCheck`] lists.
const LISTED: usize = 50;

/// How derivatives are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferenceOptions {
    /// h, in the unit of the column.
    pub step: f64,
    /// Largest error, relative to the largest derivative of the same column (of all columns, for a gradient).
    pub tolerance: f64,
    /// Derivatives are never taken as smaller than this when an error is made relative.
    pub smallest_scale: f64,
}

impl Default for DifferenceOptions {
    fn default() -> Self {
        Self { step: 1e-6, tolerance: 1e-4, smallest_scale: 1.0 }
    }
}

/// A derivative both ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedDerivative {
    /// Row of the function; 0 for a gradient.
    pub row: usize,
    /// Column of the state.
    pub column: usize,
    /// What the program says.
    pub analytic: f64,
    /// What differences say.
    pub numeric: f64,
    /// Their difference over the scale of the column; infinite where one of them is not a number.
    pub relative_error: f64,
}

/// What a comparison found. `+=` puts several together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GradientCheck {
    /// Derivatives that were compared.
    pub compared: usize,
    /// Derivatives at a kink, where differences cannot tell.
    pub skipped: usize,
    /// The one that differs most, mismatch or not, the first of several, column by column; `None` if nothing was compared.
    pub worst: Option<ComparedDerivative>,
    /// Those that differ, worst first, each with what was compared: "right forearm, column 9, pixel (3, 4)".
    pub mismatches: Vec<(String, ComparedDerivative)>,
}

impl GradientCheck {
    /// Whether something was compared and nothing differs.
    pub fn passes(&self) -> bool {
        self.compared > 0 && self.mismatches.is_empty()
    }

    /// Share of the derivatives that could not be compared.
    pub fn skipped_share(&self) -> f64 {
        self.skipped as f64 / (self.compared + self.skipped).max(1) as f64
    }

    fn add(
        &mut self,
        [row, column]: [usize; 2],
        entry: Entry,
        scale: f64,
        tolerance: f64,
        name: impl FnOnce() -> String,
    ) {
        if entry.bend > tolerance * scale {
            self.skipped += 1;
            return;
        }
        self.compared += 1;
        let error = (entry.numeric - entry.analytic).abs() / scale;
        // NaN is a mismatch, and the worst one.
        let relative_error = if error.is_nan() { f64::INFINITY } else { error };
        let Entry { analytic, numeric, .. } = entry;
        let derivative = ComparedDerivative { row, column, analytic, numeric, relative_error };
        if self.worst.is_none_or(|worst| relative_error > worst.relative_error) {
            self.worst = Some(derivative);
        }
        if relative_error > tolerance {
            self.mismatches.push((name(), derivative));
        }
    }

    fn sort(&mut self) {
        self.mismatches.sort_by(|(_, a), (_, b)| b.relative_error.total_cmp(&a.relative_error));
    }
}

impl AddAssign for GradientCheck {
    fn add_assign(&mut self, other: Self) {
        self.compared += other.compared;
        self.skipped += other.skipped;
        let error = |worst: Option<ComparedDerivative>| worst.map(|worst| worst.relative_error);
        if error(other.worst) > error(self.worst) {
            self.worst = other.worst;
        }
        self.mismatches.extend(other.mismatches);
        self.sort();
    }
}

impl fmt::Display for GradientCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {} derivatives differ, {} skipped at kinks, largest relative error {:.1e}",
            self.mismatches.len(),
            self.compared,
            self.skipped,
            self.worst.map_or(0.0, |worst| worst.relative_error)
        )?;
        for (name, derivative) in self.mismatches.iter().take(LISTED) {
            let ComparedDerivative { analytic, numeric, relative_error, .. } = derivative;
            write!(
                f,
                "\n{name}: analytic {analytic}, numeric {numeric}, relative error {relative_error:.1e}"
            )?;
        }
        if self.mismatches.len() > LISTED {
            write!(f, "\n… and {} more", self.mismatches.len() - LISTED)?;
        }
        Ok(())
    }
}

/// One derivative both ways, and how far the function bends away from a smooth one.
#[derive(Debug, Clone, Copy)]
struct Entry {
    analytic: f64,
    numeric: f64,
    bend: f64,
}

impl Entry {
    /// `values` at −2h, −h, 0, h, 2h.
    fn new(analytic: f64, values: [f64; 5], h: f64) -> Self {
        let slopes: [f64; 4] = std::array::from_fn(|i| (values[i + 1] - values[i]) / h);
        let mean_change = (slopes[3] - slopes[0]) / 3.0;
        let bend = slopes.windows(2).map(|pair| (pair[1] - pair[0] - mean_change).abs()).fold(0.0, f64::max);
        Self { analytic, numeric: 0.5 * (slopes[1] + slopes[2]), bend }
    }

    fn scale(entries: &[Self], options: &DifferenceOptions) -> f64 {
        entries
            .iter()
            .flat_map(|entry| [entry.analytic.abs(), entry.numeric.abs()])
            .filter(|value| value.is_finite())
            .fold(options.smallest_scale, f64::max)
    }
}

/// Compares a Jacobian with differences of the function that it belongs to.
///
/// `function(column, offset)` gives all rows with one column moved by an offset; `name(row, column)` names an
/// entry of a mismatch. The function is called five times a column.
pub fn check_jacobian(
    jacobian: &DMatrix<f64>,
    mut function: impl FnMut(usize, f64) -> Vec<f64>,
    name: impl Fn(usize, usize) -> String,
    options: &DifferenceOptions,
) -> GradientCheck {
    let (mut check, h) = (GradientCheck::default(), options.step);
    for (column, analytic) in jacobian.column_iter().enumerate() {
        let values = STEPS.map(|k| function(column, k * h));
        let entry = |(row, analytic): (usize, &f64)| {
            Entry::new(*analytic, std::array::from_fn(|k| values[k][row]), h)
        };
        let entries: Vec<Entry> = analytic.iter().enumerate().map(entry).collect();
        let scale = Entry::scale(&entries, options);
        for (row, entry) in entries.into_iter().enumerate() {
            check.add([row, column], entry, scale, options.tolerance, || name(row, column));
        }
    }
    check.sort();
    check
}

/// Compares one column of a Jacobian, given row by row: [`check_jacobian`] for those who cannot wait for all of it.
/// The column is numbered 0 in what is found.
pub fn check_column(
    analytic: &[f64],
    mut function: impl FnMut(f64) -> Vec<f64>,
    name: impl Fn(usize) -> String,
    options: &DifferenceOptions,
) -> GradientCheck {
    let column = DMatrix::from_column_slice(analytic.len(), 1, analytic);
    check_jacobian(&column, |_, offset| function(offset), |row, _| name(row), options)
}

/// Compares a problem's gradient of the cost, −2 Jᵀρ, with differences of the cost.
///
/// `moved(column, offset)` gives the point with one column moved by an offset: [`LeastSquares::retract`] where
/// that is not followed by a projection (raw quaternions are renormalised; their gradient is not).
pub fn check_gradient<P: LeastSquares>(
    problem: &mut P,
    point: &P::Point,
    mut moved: impl FnMut(usize, f64) -> P::Point,
    name: impl Fn(usize) -> String,
    options: &DifferenceOptions,
) -> GradientCheck {
    let mut equations = NormalEquations::zeros(problem.columns());
    problem.evaluate(point, &mut equations);
    let gradient = &equations.jtr * -2.0;
    let mut trial = NormalEquations::zeros(problem.columns());
    let mut cost = |point: &P::Point| {
        trial.clear();
        problem.evaluate(point, &mut trial);
        trial.cost
    };
    let h = options.step;
    let entries: Vec<Entry> = (0..gradient.len())
        .map(|column| {
            let values = STEPS.map(|k| cost(&moved(column, k * h)));
            Entry::new(gradient[column], values, h)
        })
        .collect();
    let scale = Entry::scale(&entries, options);
    let mut check = GradientCheck::default();
    for (column, entry) in entries.into_iter().enumerate() {
        check.add([0, column], entry, scale, options.tolerance, || name(column));
    }
    check.sort();
    check
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::optimize::solver::tests::TwoUnknowns;

    /// Checks ρ = (3 − x², 1 − x y, −|y − kink|) at a point, with one derivative wrong on demand.
    fn check(wrong: f64, kink: f64, at: [f64; 2]) -> GradientCheck {
        let evaluate = |&[x, y]: &[f64; 2]| {
            let side = (y - kink).signum();
            let jacobian = DMatrix::from_row_slice(3, 2, &[2.0 * x + wrong, 0.0, y, x, 0.0, side]);
            let residual = vec![3.0 - x * x, 1.0 - x * y, -(y - kink).abs() - 1.0];
            (jacobian, DVector::from_vec(residual))
        };
        let mut curve = TwoUnknowns { evaluate, longest: f64::INFINITY };
        let moved = |column: usize, offset: f64| {
            let mut point = at;
            point[column] += offset;
            point
        };
        let name = |column: usize| ["x", "y"][column].to_owned();
        check_gradient(&mut curve, &at, moved, name, &DifferenceOptions::default())
    }

    #[test]
    fn a_right_gradient_passes() {
        let found = check(0.0, 0.0, [0.7, -1.3]);
        assert!(found.passes() && found.compared == 2, "{found}");
    }

    #[test]
    fn a_wrong_derivative_is_named() {
        let found = check(0.1, 0.0, [0.7, -1.3]);
        assert_eq!(found.mismatches.len(), 1, "{found}");
        assert!(found.to_string().contains("\nx: analytic"), "{found}");
    }

    #[test]
    fn a_kink_within_the_differences_is_skipped() {
        for offset in [-1.5e-6, -0.3e-6, 0.0, 0.8e-6, 1.2e-6] {
            let found = check(0.0, -1.3 + offset, [0.7, -1.3]);
            assert_eq!((found.compared, found.skipped), (1, 1), "{offset} {found}");
        }
    }

    #[test]
    fn jacobians_are_compared_entry_by_entry_and_nan_is_worst() {
        let mut jacobian = DMatrix::from_row_slice(2, 2, &[2.0, 0.0, 0.5, 3.0]);
        let function = |column: usize, offset: f64| match column {
            0 => vec![2.0 * offset, 0.5 * offset],
            _ => vec![0.0, 3.0 * offset],
        };
        let name = |row: usize, column: usize| format!("({row}, {column})");
        let run =
            |jacobian: &DMatrix<f64>| check_jacobian(jacobian, function, name, &DifferenceOptions::default());
        assert!(run(&jacobian).passes());
        jacobian[(1, 0)] = 0.6;
        jacobian[(0, 1)] = f64::NAN;
        let found = run(&jacobian);
        let names: Vec<&str> = found.mismatches.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["(0, 1)", "(1, 0)"], "{found}");
        assert_eq!(found.worst.map(|worst| (worst.row, worst.column)), Some((0, 1)));
        jacobian[(0, 1)] = 1e-9;
        jacobian[(1, 0)] = 0.5;
        let mut right = run(&jacobian);
        assert!(right.passes(), "{right}");
        let worst = right.worst.map(|worst| (worst.row, worst.column));
        assert_eq!(worst, Some((0, 1)), "too small to be a mismatch");
        right += found;
        assert_eq!(right.worst.map(|worst| worst.relative_error), Some(f64::INFINITY));
    }
}
