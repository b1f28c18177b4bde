//! How what is told of joints agrees with how far they are off.

use backlit_tracking::belief::{ErrorDistribution, Verdict, WRONG_M};
use serde::Serialize;

/// A joint farther off than this is wrong, one nearer than that is right, millimetres.
pub(super) const WRONG_MM: f64 = 1e3 * WRONG_M;
const RIGHT_MM: f64 = 100.0;
/// The second area under the curve is for errors above this, millimetres.
const NEAR_MM: f64 = 50.0;
/// Shares of joints within the regions that are told.
pub(super) const REGIONS: [f64; 4] = [0.5, 0.68, 0.9, 0.95];
/// Ranges of the told probability of being wrong, for the reliability curve: their ends.
pub(super) const RANGES: [f64; 6] = [0.01, 0.03, 0.1, 0.25, 0.5, 1.0];

/// What is told of a joint, and how far off it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct JudgedJoint {
    pub(super) error_mm: f64,
    pub(super) error: ErrorDistribution,
    pub(super) verdict: Verdict,
}

/// Joints of all frames.
#[derive(Debug, Default, Clone, Serialize)]
pub(super) struct Counts {
    pub(super) joints: usize,
    pub(super) mean_mm: f64,
    pub(super) max_mm: f64,
    /// More than 250 mm off; told as doubtful or wrong; told as wrong.
    pub(super) wrong: usize,
    pub(super) wrong_told: usize,
    pub(super) wrong_called_wrong: usize,
    /// Less than 100 mm off; told as doubtful or wrong; told as wrong.
    pub(super) right: usize,
    pub(super) right_told: usize,
    pub(super) right_called_wrong: usize,
    /// Area under the curve for errors above 250 and above 50 mm: 1 where what is told ranks them perfectly, 0.5 by chance.
    pub(super) auc_250: Option<f64>,
    pub(super) auc_50: Option<f64>,
    /// Spearman's rank correlation of the told median and the true error.
    pub(super) rank_correlation: Option<f64>,
    /// Shares of the joints within the told regions of 50, 68, 90 and 95 %.
    pub(super) within: [f64; REGIONS.len()],
    /// By range of the told probability of being wrong: joints, its mean, and the share that is wrong.
    pub(super) reliability: Vec<(usize, f64, f64)>,
}

impl Counts {
    pub(super) fn of(told: &[JudgedJoint]) -> Self {
        let mut counts = Self { joints: told.len(), ..Self::default() };
        let count = told.len().max(1) as f64;
        for joint in told {
            counts.mean_mm += joint.error_mm / count;
            counts.max_mm = counts.max_mm.max(joint.error_mm);
            let (is_told, is_wrong) = (joint.verdict > Verdict::Good, joint.verdict == Verdict::Wrong);
            if joint.error_mm > WRONG_MM {
                counts.wrong += 1;
                counts.wrong_told += usize::from(is_told);
                counts.wrong_called_wrong += usize::from(is_wrong);
            } else if joint.error_mm < RIGHT_MM {
                counts.right += 1;
                counts.right_told += usize::from(is_told);
                counts.right_called_wrong += usize::from(is_wrong);
            }
        }
        counts.auc_250 = auc(told, WRONG_MM);
        counts.auc_50 = auc(told, NEAR_MM);
        let told_mm: Vec<f64> = told.iter().map(|joint| 1e3 * joint.error.quantile(0.5)).collect();
        let errors_mm: Vec<f64> = told.iter().map(|joint| joint.error_mm).collect();
        counts.rank_correlation = correlation(&ranks(&told_mm), &ranks(&errors_mm));
        counts.within = REGIONS.map(|share| {
            let inside = told.iter().filter(|joint| joint.error_mm <= 1e3 * joint.error.quantile(share));
            inside.count() as f64 / count
        });
        counts.reliability = reliability(told);
        counts
    }
}

fn reliability(told: &[JudgedJoint]) -> Vec<(usize, f64, f64)> {
    let mut from = 0.0;
    let range = |to: f64| {
        let begins = std::mem::replace(&mut from, to);
        let within = |wrong: f64| wrong <= to && (wrong > begins || begins == 0.0);
        let wrong = |joint: &JudgedJoint| joint.error.beyond(1e-3 * WRONG_MM);
        let inside: Vec<&JudgedJoint> = told.iter().filter(|joint| within(wrong(joint))).collect();
        let count = inside.len().max(1) as f64;
        let mean = inside.iter().map(|joint| wrong(joint)).sum::<f64>() / count;
        let is = inside.iter().filter(|joint| joint.error_mm > WRONG_MM).count() as f64 / count;
        (inside.len(), mean, is)
    };
    RANGES.into_iter().map(range).collect()
}

/// How often a joint above the error is told to be above it with a larger probability than one below, ties by half (Mann and
/// Whitney 1947). `None` where all are on one side.
fn auc(told: &[JudgedJoint], above_mm: f64) -> Option<f64> {
    let beyond: Vec<f64> = told.iter().map(|joint| joint.error.beyond(1e-3 * above_mm)).collect();
    let is_above = |joint: &&(f64, &JudgedJoint)| joint.1.error_mm > above_mm;
    let ranked: Vec<(f64, &JudgedJoint)> = ranks(&beyond).into_iter().zip(told).collect();
    let above = ranked.iter().filter(is_above).count() as f64;
    let below = told.len() as f64 - above;
    let sum: f64 = ranked.iter().filter(is_above).map(|joint| joint.0).sum();
    (above > 0.0 && below > 0.0).then(|| (sum - above * (above + 1.0) / 2.0) / (above * below))
}

/// Ranks from 1 on; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut at = 0;
    while at < order.len() {
        let same = order[at..].iter().take_while(|&&index| values[index] == values[order[at]]).count();
        for &index in &order[at..at + same] {
            ranks[index] = at as f64 + (same as f64 + 1.0) / 2.0;
        }
        at += same;
    }
    ranks
}

/// Pearson's coefficient; of ranks it is Spearman's. `None` where one of both is constant.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sum = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
        a.iter().zip(b).map(|(a, b)| of(a - mean_a, b - mean_b)).sum()
    };
    let spread = (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt();
    (spread > 0.0).then(|| sum(&|a, b| a * b) / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_share_their_ties_and_correlate() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, 2.0]), [3.5, 1.0, 3.5, 2.0]);
        let up = [1.0, 5.0, 7.0, 8.0];
        assert!((correlation(&ranks(&up), &ranks(&[0.1, 0.2, 0.3, 9.0])).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(correlation(&up, &[2.0; 4]), None);
    }
}
