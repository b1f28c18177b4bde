//! Medians, quantiles, normal deviates and sums of logarithms.

use glam::DVec3;
use rand::{Rng, RngExt};

/// A median absolute deviation is this part of a normal standard deviation.
pub(crate) const MAD: f64 = 0.674_489_75;
/// Degrees of freedom of Student's distribution where outliers are expected.
const STUDENT_FREEDOM: f64 = 4.0;

/// The loss of a residual, in deviations, under Student's distribution: half a squared one where it is small.
pub(crate) fn student_loss(deviations: f64) -> f64 {
    0.5 * (STUDENT_FREEDOM + 1.0) * (deviations * deviations / STUDENT_FREEDOM).ln_1p()
}

/// The weight of such a residual in the normal equations.
pub(crate) fn student_weight(deviations: f64) -> f64 {
    (STUDENT_FREEDOM + 1.0) / (STUDENT_FREEDOM + deviations * deviations)
}

/// What a list of numbers is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Arithmetic mean.
    pub mean: f64,
    /// Half lie below.
    pub median: f64,
    /// 95 % lie below.
    pub p95: f64,
    /// The largest.
    pub max: f64,
    /// How many there are.
    pub count: usize,
}

impl Statistics {
    /// Of any numbers; `None` of an empty list.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let max = *sorted.last()?;
        Some(Self {
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
            median: quantile(&sorted, 0.5),
            p95: quantile(&sorted, 0.95),
            max,
            count: sorted.len(),
        })
    }
}

/// Linear between the two nearest ranks of sorted values, of which there is at least one.
fn quantile(sorted: &[f64], fraction: f64) -> f64 {
    let rank = fraction * (sorted.len() - 1) as f64;
    let (low, high) = (rank.floor() as usize, rank.ceil() as usize);
    sorted[low] + (sorted[high] - sorted[low]) * (rank - low as f64)
}

/// The mean; `None` of an empty list.
pub fn mean(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let (sum, count) =
        values.into_iter().fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

/// The median, the mean of the two middle values where their number is even; `None` of an empty list. Sorts the values.
pub fn median(values: &mut [f64]) -> Option<f64> {
    let upper = upper_median(values)?;
    let middle = values.len() / 2;
    Some(if values.len() % 2 == 1 { upper } else { 0.5 * (values[middle - 1] + upper) })
}

/// The median, the larger of the two middle values where their number is even; `None` of an empty list. Sorts the values.
pub fn upper_median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// A number of the standard normal distribution (G. Box and M. Muller 1958).
pub fn normal(random: &mut impl Rng) -> f64 {
    let (u, v): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Three numbers of the standard normal distribution.
pub fn normal_vector(random: &mut impl Rng) -> DVec3 {
    DVec3::new(normal(random), normal(random), normal(random))
}

/// ln Σ exp.
pub fn log_sum_exp(logs: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + logs.map(|log| (log - largest).exp()).sum::<f64>().ln()
}

/// Standard deviations of an interval that holds the true share 95 times of 100.
pub const Z_95: f64 = 1.96;

/// Ends of Wilson's interval for the share of `found` in `tried`, from 0 to 1; all of that where nothing was tried.
///
/// With k of n, p = k/n and z standard deviations they are
/// (p + z²/2n ± z √(p(1−p)/n + z²/4n²)) / (1 + z²/n)
/// (E. B. Wilson, "Probable inference, the law of succession, and statistical inference", 1927). Unlike the normal
/// interval it stays within 0 and 1 and has a width where none or all succeeded.
pub fn wilson(found: usize, tried: usize, z: f64) -> [f64; 2] {
    if tried == 0 {
        return [0.0, 1.0];
    }
    let n = tried as f64;
    let share = found.min(tried) as f64 / n;
    let middle = share + z * z / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let whole = 1.0 + z * z / n;
    [((middle - half) / whole).clamp(0.0, share), ((middle + half) / whole).clamp(share, 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_a_ladder() {
        let values: Vec<f64> = (0..=100).rev().map(f64::from).collect();
        let found = Statistics::of(&values).unwrap();
        assert_eq!((found.mean, found.median, found.p95, found.max), (50.0, 50.0, 95.0, 100.0));
        assert_eq!((Statistics::of(&[]), median(&mut []), mean([])), (None, None, None));
        let even = [4.0, 1.0, 2.0, 9.0];
        assert_eq!((median(&mut even.clone()), upper_median(&mut even.clone())), (Some(3.0), Some(4.0)));
    }

    #[test]
    fn ends_of_an_interval_are_those_of_the_tables() {
        let near = |[low, high]: [f64; 2], expected: [f64; 2]| {
            assert!((low - expected[0]).abs() < 5e-4 && (high - expected[1]).abs() < 5e-4, "{low} {high}");
        };
        near(wilson(5, 10, Z_95), [0.2366, 0.7634]);
        near(wilson(0, 10, Z_95), [0.0, 0.2775]);
        near(wilson(10, 10, Z_95), [0.7225, 1.0]);
        near(wilson(90, 100, Z_95), [0.8256, 0.9448]);
        assert_eq!(wilson(0, 0, Z_95), [0.0, 1.0]);
    }
}
