//! The size of a fault that leaves least between the cameras.

use nalgebra::{DMatrix, DVector};

use super::fault::FaultKind;
use super::hypothesis::{BUMPS, Hypothesis};
use super::pair_angles::{ByWitness, Residuals, correlation_lengths, support, support_of};
use super::state::{Sampled, State};
use crate::statistics::{student_loss, student_weight};

/// Widths of the loss, in deviations, from a coarse fit to the last.
const WIDTHS: [f64; 3] = [32.0, 5.0, 1.0];
/// Steps at each width at most.
const STEPS: usize = 4;
/// Offsets that are tried, in shares of the time between two frames, and most of them on each side.
const OFFSET_STEP: f64 = 0.5;
const MOST_OFFSETS: i32 = 120;
/// Rounds of the fit of a moved camera and of when it was moved.
const BUMP_ROUNDS: usize = 2;
/// A moved camera counts if so many frames, as a share, are before and after.
const LEAST_SHARE: f64 = 0.08;

/// A hypothesis at its best.
pub(super) struct Tried {
    pub(super) hypothesis: Hypothesis,
    pub(super) by: Vec<f64>,
    pub(super) deviations: Vec<f64>,
    pub(super) split: f64,
    /// Of the pairs that it concerns: which, and what they are apart.
    pub(super) residuals: Vec<(usize, Residuals)>,
}

/// What a residual of each witness weighs in a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighing {
    /// Standard deviations, pixels.
    noise: ByWitness,
    /// How much of a residual counts, beside one of silhouettes: those that hang together more say less.
    shares: ByWitness,
}

impl State {
    /// How the cameras as they are weigh their witnesses, whose deviations are `noise`.
    pub(super) fn weighing(&self, noise: ByWitness) -> Weighing {
        let [silhouettes, keypoints] = correlation_lengths(&self.full.residuals, noise);
        Weighing { noise, shares: [1.0, (silhouettes / keypoints).min(1.0)] }
    }

    /// The best size of a fault of this kind.
    pub(super) fn fit(&self, hypothesis: Hypothesis, weighing: Weighing) -> Option<Tried> {
        let mut start = hypothesis.start();
        if hypothesis.kind == FaultKind::Bumped {
            return self.fit_bump(hypothesis, weighing);
        }
        if hypothesis.kind.is_clock() {
            start[0] = self.best_offset(&hypothesis, weighing.noise)?;
            return self.descend(hypothesis, start, &WIDTHS[1..], 0.0, weighing);
        }
        self.descend(hypothesis, start, &WIDTHS, 0.0, weighing)
    }

    fn best_offset(&self, hypothesis: &Hypothesis, noise: ByWitness) -> Option<f64> {
        let camera = hypothesis.camera?;
        let step = OFFSET_STEP * self.full.recordings[camera].period();
        let spread = self.spread();
        let [first, last] = self.span(hypothesis);
        let most = ((0.5 * (last - first) / step) as i32).min(MOST_OFFSETS);
        let mut by = hypothesis.start();
        let rate = hypothesis.repair(&self.cameras, &by, [first, last], 0.0)?.clock.rate;
        let about = if hypothesis.kind == FaultKind::FrameRate { first - rate * first } else { 0.0 };
        let support_at = |k: i32| {
            by[0] = about + f64::from(k) * step;
            let repair = hypothesis.repair(&self.cameras, &by, [first, last], 0.0)?;
            let all = self.with(&self.full, &repair);
            let sum = all.iter().flat_map(|(_, residuals)| support(residuals, noise, spread)).sum::<f64>();
            Some((by[0], sum))
        };
        let all: Vec<(f64, f64)> = (-most..=most).filter_map(support_at).collect();
        all.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|best| best.0)
    }

    /// A camera that was moved and when: the size by descent, the moment by what fits before and after, in turns.
    fn fit_bump(&self, hypothesis: Hypothesis, weighing: Weighing) -> Option<Tried> {
        let span = self.span(&hypothesis);
        let mut split = span[0] + BUMPS[hypothesis.form] * (span[1] - span[0]);
        let mut by = hypothesis.start();
        let mut tried = None;
        for round in 0..BUMP_ROUNDS {
            let widths = if round == 0 { &WIDTHS[..] } else { &WIDTHS[1..] };
            let now = self.descend(hypothesis, by, widths, split, weighing)?;
            by = now.by.clone();
            let better = self.best_split(&hypothesis, &by, weighing.noise)?;
            let is_same = (better - split).abs() < 1e-9;
            split = better;
            tried = Some(now);
            if is_same {
                break;
            }
        }
        let tried = tried?;
        if tried.split == split {
            Some(tried)
        } else {
            self.descend(hypothesis, by, &WIDTHS[1..], split, weighing)
        }
    }

    /// The moment before which the camera as it is, and after which the repaired one fits best.
    fn best_split(&self, hypothesis: &Hypothesis, by: &[f64], noise: ByWitness) -> Option<f64> {
        let camera = hypothesis.camera?;
        let span = self.span(hypothesis);
        let always = self.with(&self.full, &hypothesis.repair(&self.cameras, by, span, f64::NEG_INFINITY)?);
        let spread = self.spread();
        // What is gained by the repair, by time.
        let mut gains: Vec<(f64, f64)> = Vec::new();
        for (pair, residuals) in &always {
            let seconds = &self.full.recordings[self.pairs[*pair][0]].sightings;
            let before = self.full.residuals[*pair].values();
            for (at, ((after, noise), before)) in residuals.each_with(noise).zip(before).enumerate() {
                let of = |residual| support_of(residual, noise, spread);
                gains.push((seconds[at % seconds.len()].seconds, of(after) - of(*before)));
            }
        }
        gains.sort_by(|a, b| a.0.total_cmp(&b.0));
        let times: Vec<f64> =
            self.full.recordings[camera].sightings.iter().map(|sighting| sighting.seconds).collect();
        let edge = (LEAST_SHARE * times.len() as f64).ceil() as usize;
        let mut best: Option<(f64, f64)> = None;
        for &time in times.get(edge..times.len().checked_sub(edge)?)? {
            let from = gains.partition_point(|gain| gain.0 < time);
            let sum: f64 = gains[from..].iter().map(|gain| gain.1).sum();
            if best.is_none_or(|best| sum > best.1) {
                best = Some((time, sum));
            }
        }
        best.map(|best| best.0)
    }

    /// Gauss and Newton with a loss that becomes narrower.
    fn descend(
        &self,
        hypothesis: Hypothesis,
        start: Vec<f64>,
        widths: &[f64],
        split: f64,
        Weighing { noise, shares }: Weighing,
    ) -> Option<Tried> {
        let parameters = hypothesis.parameters();
        let span = self.span(&hypothesis);
        let sampled = if hypothesis.kind.is_clock() { &self.full } else { &self.thin };
        let at = |by: &[f64]| Some(self.with(sampled, &hypothesis.repair(&self.cameras, by, span, split)?));
        let (mut by, mut residuals) = (start.clone(), at(&start)?);
        let mut deviations = vec![0.0; by.len()];
        let spread = self.spread();
        for &width in if parameters.is_empty() { &[][..] } else { widths } {
            let scales = noise.map(|noise| width * noise);
            let cost = |residuals: &[(usize, Residuals)], by: &[f64]| {
                // What is missing costs as much as what does not fit at all.
                let of = |residual: &Option<f64>, scale: f64| {
                    let most = student_loss(spread.max(2.0 * scale) / scale);
                    residual.map_or(most, |px| student_loss(px / scale).min(most))
                };
                let all = residuals.iter().flat_map(|(_, residuals)| {
                    residuals.by_witness().into_iter().zip(scales).zip(shares).map(
                        |((said, scale), share)| {
                            share * said.iter().map(|residual| of(residual, scale)).sum::<f64>()
                        },
                    )
                });
                let data: f64 = all.sum();
                let prior: f64 = by
                    .iter()
                    .zip(&start)
                    .zip(&parameters)
                    .map(|((by, start), parameter)| 0.5 * ((by - start) / parameter.usual).powi(2))
                    .sum();
                data + prior
            };
            let mut now = cost(&residuals, &by);
            for _ in 0..STEPS {
                let columns: Vec<Vec<(usize, Residuals)>> = (0..by.len())
                    .map(|column| {
                        let mut moved = by.clone();
                        moved[column] += parameters[column].step;
                        at(&moved)
                    })
                    .collect::<Option<_>>()?;
                let steps: Vec<f64> = parameters.iter().map(|parameter| parameter.step).collect();
                let weighing = [(scales[0], shares[0]), (scales[1], shares[1])];
                let (mut normal, mut right) = normal_equations(&residuals, &columns, &steps, weighing);
                for (index, parameter) in parameters.iter().enumerate() {
                    let prior = parameter.usual.powi(-2);
                    normal[(index, index)] += prior;
                    right[index] += prior * (start[index] - by[index]);
                }
                let Some(factor) = normal.cholesky() else { break };
                let step = factor.solve(&right);
                let inverse = factor.inverse();
                for (index, deviation) in deviations.iter_mut().enumerate() {
                    *deviation = inverse[(index, index)].max(0.0).sqrt();
                }
                let mut is_better = false;
                let mut share = 1.0;
                for _ in 0..4 {
                    let trial: Vec<f64> =
                        by.iter().zip(step.iter()).map(|(by, step)| by + share * step).collect();
                    if let Some(other) = at(&trial) {
                        let trial_cost = cost(&other, &trial);
                        if trial_cost < now {
                            is_better = now - trial_cost > 1e-4 * now;
                            (by, residuals, now) = (trial, other, trial_cost);
                            break;
                        }
                    }
                    share *= 0.4;
                }
                if !is_better {
                    break;
                }
            }
        }
        // More samples than it was fitted by say so much more.
        let of = |sampled: &Sampled| sampled.residuals[0].values().len() as f64;
        let share = of(sampled) / of(&self.full).max(1.0);
        deviations.iter_mut().for_each(|deviation| *deviation *= share.sqrt());
        let residuals = self.with(&self.full, &hypothesis.repair(&self.cameras, &by, span, split)?);
        Some(Tried { hypothesis, by, deviations, split, residuals })
    }
}

/// `JᵀWJ` and −`JᵀWr` by forward differences; samples that any of them lacks do not count. `weighing` is the scale and the share
/// of each witness's residuals.
fn normal_equations(
    residuals: &[(usize, Residuals)],
    columns: &[Vec<(usize, Residuals)>],
    steps: &[f64],
    weighing: [(f64, f64); 2],
) -> (DMatrix<f64>, DVector<f64>) {
    let count = columns.len();
    let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let mut row = vec![0.0; count];
    for (pair, (_, own)) in residuals.iter().enumerate() {
        for (at, (residual, (scale, share))) in own.each_with(weighing).enumerate() {
            let Some(residual) = residual else { continue };
            let is_whole = columns.iter().zip(steps).zip(row.iter_mut()).all(|((column, step), entry)| {
                column[pair].1.values()[at].is_some_and(|moved| {
                    *entry = (moved - residual) / (step * scale);
                    true
                })
            });
            if !is_whole {
                continue;
            }
            let deviations = residual / scale;
            let weight = share * student_weight(deviations);
            for i in 0..count {
                right[i] -= weight * row[i] * deviations;
                for j in 0..count {
                    normal[(i, j)] += weight * row[i] * row[j];
                }
            }
        }
    }
    (normal, right)
}
