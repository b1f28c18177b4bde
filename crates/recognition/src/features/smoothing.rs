//! Smoothing and derivatives over time.

use std::ops::{Add, Mul, Sub};

/// A quantity that can be weighted and summed.
pub(super) trait Quantity:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>> Quantity for T {}

/// Convolution with a Gaussian of this many frames' deviation, cut at four deviations; the ends go on as they are.
pub(super) fn gaussian<T: Quantity>(values: &[T], deviation: f64) -> Vec<T> {
    let reach = (4.0 * deviation + 0.5) as isize;
    let weights: Vec<f64> =
        (-reach..=reach).map(|at| (-0.5 * (at as f64 / deviation).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let last = values.len() as isize - 1;
    let at = |index: isize| values[index.clamp(0, last) as usize];
    (0..=last)
        .map(|index| {
            let mut terms =
                weights.iter().enumerate().map(|(k, w)| at(index + k as isize - reach) * (w / sum));
            let first = terms.next().map_or(at(index), |first| first);
            terms.fold(first, |a, b| a + b)
        })
        .collect()
}

/// Change a second: differences between the neighbours, and to the one neighbour at the ends.
pub(super) fn derivative<T: Quantity>(values: &[T], rate: f64) -> Vec<T> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|index| {
            let (from, to) = (index.saturating_sub(1), (index + 1).min(last));
            (values[to] - values[from]) * (rate / (to - from).max(1) as f64)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_lines_and_have_their_slope() {
        let line: Vec<f64> = (0..40).map(|index| 2.0 + 0.5 * f64::from(index)).collect();
        let smooth = gaussian(&line, 2.0);
        for index in 8..32 {
            assert!((smooth[index] - line[index]).abs() < 1e-12);
        }
        assert!(derivative(&line, 30.0).iter().all(|slope| (slope - 15.0).abs() < 1e-12));
        assert_eq!(derivative(&[1.0], 30.0), [0.0]);
    }
}
