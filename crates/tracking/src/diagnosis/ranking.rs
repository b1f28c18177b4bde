//! Hypotheses in the order of their evidence.

use std::collections::HashSet;

use rayon::prelude::*;

use super::coherence::{FrameGaps, SilhouetteRecord};
use super::diagnose::{DiagnosisOptions, Finding, Rival};
use super::fault::{ClockChange, FaultKind};
use super::fitting::Tried;
use super::hypothesis::{Hypothesis, Repair};
use super::outlines::Clock;
use super::pair_angles::{ByWitness, Residuals, correlation_lengths, median_px, noise, support, support_of};
use super::state::State;
use crate::cancel::CancelToken;

/// A rival is told if it is no farther behind, nats.
const RIVAL_NATS: f64 = 7.0;
/// From when it was moved on, the repair of a moved camera leaves at most this share of what is apart: a split can be put at any
/// moment, and six numbers fit chance there.
const MOST_LEFT: f64 = 0.5;
/// Hypotheses that are tried at a time.
const BATCH: usize = 16;

/// All hypotheses at their best, the likeliest first.
pub(super) struct Ranking {
    ranked: Vec<Ranked>,
    /// Deviation of an edge and of a keypoint under the best, pixels.
    pub(super) noise_px: ByWitness,
    /// Over how many samples residuals hang together.
    correlated: ByWitness,
}

/// A hypothesis at its best.
struct Ranked {
    tried: Tried,
    /// Against no fault, nats.
    evidence: f64,
    /// Share of its camera's edges with larger gaps than noise makes, before and after its repair.
    unexplained: Option<[f64; 2]>,
}

impl State {
    /// Tries all hypotheses; `None` when cancelled.
    pub(super) fn rank(
        &self,
        cancel: &CancelToken,
        on_progress: &mut impl FnMut(usize, usize),
    ) -> Option<Ranking> {
        let spread = self.spread();
        let least = self.noise();
        // The loss is narrow even where a fault makes much of it noise.
        let first = self.weighing(least.map(|least| least.min(0.1 * spread)));
        let hypotheses = Hypothesis::all(&self.cameras);
        let mut tried: Vec<Tried> = Vec::new();
        for (batch, some) in hypotheses.chunks(BATCH).enumerate() {
            if cancel.is_cancelled() {
                return None;
            }
            on_progress(batch * BATCH, hypotheses.len());
            tried.par_extend(some.par_iter().filter_map(|hypothesis| self.fit(*hypothesis, first)));
        }
        on_progress(hypotheses.len(), hypotheses.len());
        tried.retain(|tried| tried.hypothesis.is_credible(&tried.by));
        let noise_px = tried
            .iter()
            .map(|tried| noise(self.all(tried), spread))
            .fold(least, |least, noise| [least[0].min(noise[0]), least[1].min(noise[1])]);
        let supports = |all: &mut dyn Iterator<Item = &Residuals>| -> ByWitness {
            all.map(|residuals| support(residuals, noise_px, spread)).fold([0.0; 2], sum)
        };
        let totals: Vec<ByWitness> = tried.iter().map(|tried| supports(&mut self.all(tried))).collect();
        let best = (0..tried.len())
            .max_by(|&a, &b| totals[a].iter().sum::<f64>().total_cmp(&totals[b].iter().sum()));
        let correlated = best.map_or([1.0; 2], |best| correlation_lengths(self.all(&tried[best]), noise_px));
        let independent = |of: ByWitness| of[0] / correlated[0] + of[1] / correlated[1];
        let none = independent(supports(&mut self.full.residuals.iter()));
        let samples = self.full.residuals.iter().map(samples).fold([0.0; 2], sum);
        let ln_samples = independent(samples).max(2.0).ln();
        let weighed = |(tried, total): (Tried, ByWitness)| {
            let evidence = independent(total) - tried.hypothesis.cost(&tried.by, ln_samples) - none;
            Ranked { tried, evidence, unexplained: None }
        };
        let mut ranked: Vec<Ranked> = tried.into_iter().zip(totals).map(weighed).collect();
        ranked.retain(|ranked| self.is_no_chance(&ranked.tried));
        sort(&mut ranked);
        self.ask_hulls(&mut ranked, noise_px[0], correlated[0]);
        sort(&mut ranked);
        Some(Ranking { ranked, noise_px, correlated })
    }

    /// Adds to the evidence of hypotheses what gaps say, and keeps the best form of each kind for each camera.
    fn ask_hulls(&self, ranked: &mut Vec<Ranked>, noise_px: f64, correlated: f64) {
        let before = self.gaps();
        if before.is_empty() {
            return;
        }
        let mut met = HashSet::new();
        ranked.retain(|Ranked { tried, .. }| met.insert((tried.hypothesis.camera, tried.hypothesis.kind)));
        let gaps_of = |Ranked { tried, .. }: &Ranked| {
            let hypothesis = &tried.hypothesis;
            let repair = hypothesis.repair(&self.cameras, &tried.by, self.span(hypothesis), tried.split);
            repair.map_or_else(|| before.clone(), |repair| self.gaps_with(&repair, &before))
        };
        let all: Vec<Vec<FrameGaps>> = ranked.par_iter().map(gaps_of).collect();
        let noise = self.edge_noise(noise_px);
        let spread = self.spread();
        let support_by = |gaps: &[FrameGaps]| -> f64 {
            let each = gaps.iter().flat_map(|frame| &frame.px);
            each.map(|px| support_of(Some(*px), noise, spread)).sum()
        };
        let supports: Vec<f64> = all.iter().map(|gaps| support_by(gaps)).collect();
        let best = (0..all.len()).max_by(|&a, &b| supports[a].total_cmp(&supports[b]));
        // Edges hang together within a frame, and frames as the outlines' samples do.
        let within = best.map_or(1.0, |best| correlated_edges(&all[best], noise));
        let apart =
            self.full.recordings[0].frame_count() as f64 / before.len() as f64 * self.cameras.len() as f64;
        let together = within * (correlated / apart).max(1.0);
        let none = support_by(&before);
        let usual = self.edge_noise(self.noise()[0]);
        for ((ranked, after), support) in ranked.iter_mut().zip(&all).zip(supports) {
            ranked.evidence += (support - none) / together;
            let camera = ranked.tried.hypothesis.camera;
            let share = |gaps: &[FrameGaps]| share_beyond(usual, gaps, camera?);
            ranked.unexplained = share(&before).zip(share(after)).map(<[f64; 2]>::from);
        }
    }

    /// No edge is known better than to a cell.
    fn edge_noise(&self, noise_px: f64) -> f64 {
        self.silhouettes.iter().map(SilhouetteRecord::side).fold(noise_px, f64::max)
    }

    /// The likeliest fault, if it is likely and large enough to be told.
    pub(super) fn finding(&self, ranking: &Ranking, options: &DiagnosisOptions) -> Option<(Finding, Repair)> {
        let Ranked { tried: best, evidence, unexplained } = ranking.ranked.first()?;
        let hypothesis = &best.hypothesis;
        let camera = &self.cameras[hypothesis.camera.unwrap_or(0)];
        let is_large = self.effect(best) >= options.least_effect * camera.height() as f64;
        if *evidence < options.least_evidence || !is_large {
            return None;
        }
        let repair = hypothesis.repair(&self.cameras, &best.by, self.span(hypothesis), best.split)?;
        let mut cameras = self.cameras.clone();
        for (index, camera) in repair.cameras.iter().filter(|_| repair.after.is_none()) {
            cameras[*index] = camera.clone();
        }
        let apart = |witness: usize| {
            let before =
                best.residuals.iter().flat_map(|(pair, _)| self.full.residuals[*pair].by_witness()[witness]);
            let after = best.residuals.iter().flat_map(|(_, after)| after.by_witness()[witness]);
            Some([median_px(before)?, median_px(after)?])
        };
        // Keypoints weighed less in the fit by how much more they hang together.
        let correlated = ranking.correlated[0].sqrt();
        let deviations: Vec<f64> = best.deviations.iter().map(|deviation| deviation * correlated).collect();
        let Clock { offset_s, rate } = repair.clock;
        let clock = hypothesis.camera.filter(|_| hypothesis.kind.is_clock());
        let finding = Finding {
            camera: hypothesis.camera,
            with: (hypothesis.kind == FaultKind::Swapped).then_some(hypothesis.form),
            kind: hypothesis.kind,
            sizes: hypothesis.sizes(camera, &best.by, &deviations),
            since_s: repair.after,
            evidence: *evidence,
            apart_px: apart(0),
            keypoints_apart_px: apart(1),
            unexplained: *unexplained,
            rivals: ranking.rivals(),
            cameras,
            clock: clock.map(|camera| ClockChange { camera, offset_s, rate }),
        };
        Some((finding, repair))
    }

    /// Whether a camera that was moved explains what is seen from then on; other faults cannot choose a moment.
    fn is_no_chance(&self, tried: &Tried) -> bool {
        if tried.hypothesis.kind != FaultKind::Bumped {
            return true;
        }
        let (mut before, mut after) = (Vec::new(), Vec::new());
        for (pair, residuals) in &tried.residuals {
            let both = residuals.values().iter().zip(self.full.residuals[*pair].values());
            for (one, other) in both.filter(|(after, before)| after != before) {
                after.push(*one);
                before.push(*other);
            }
        }
        let apart = median_px(&before).zip(median_px(&after));
        apart.is_some_and(|(before, after)| after <= MOST_LEFT * before)
    }

    /// The residuals of all pairs under a hypothesis.
    fn all<'b>(&'b self, tried: &'b Tried) -> impl Iterator<Item = &'b Residuals> {
        let other = |pair: usize| tried.residuals.iter().find(|(at, _)| *at == pair);
        self.full
            .residuals
            .iter()
            .enumerate()
            .map(move |(pair, own)| other(pair).map_or(own, |(_, other)| other))
    }

    /// How far a fault moves what is seen, pixels: one in ten of the numbers that its repair changes is changed by so much or
    /// more. A clock that is wrong shows only where the subject moves.
    fn effect(&self, tried: &Tried) -> f64 {
        let mut changes: Vec<f64> = Vec::new();
        for (pair, residuals) in &tried.residuals {
            for (after, before) in residuals.values().iter().zip(self.full.residuals[*pair].values()) {
                match (after, before) {
                    (Some(after), Some(before)) => changes.push((after - before).abs()),
                    (Some(_), None) => changes.push(self.spread()),
                    _ => {}
                }
            }
        }
        if tried.hypothesis.kind == FaultKind::Bumped {
            changes.retain(|change| *change > 1e-9);
        }
        changes.sort_by(f64::total_cmp);
        changes.get(changes.len() * 9 / 10).copied().unwrap_or(0.0)
    }
}

/// The likeliest first.
fn sort(ranked: &mut [Ranked]) {
    ranked.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
}

/// Share of a camera's gaps that are larger than this; `None` without any.
fn share_beyond(px: f64, gaps: &[FrameGaps], camera: usize) -> Option<f64> {
    let own = || gaps.iter().filter(|frame| frame.camera == camera).flat_map(|frame| &frame.px);
    let all = own().count();
    (all > 0).then(|| own().filter(|gap| **gap > px).count() as f64 / all as f64)
}

/// Σ (Σ g)² / Σ g², inner sums over the edges of a frame: over how many of them gaps hang together.
fn correlated_edges(gaps: &[FrameGaps], noise: f64) -> f64 {
    let bounded = |frame: &FrameGaps| -> Vec<f64> { frame.px.iter().map(|px| px.min(3.0 * noise)).collect() };
    let (mut squares, mut squared_sums) = (0.0, 0.0);
    for px in gaps.iter().map(bounded) {
        squares += px.iter().map(|px| px * px).sum::<f64>();
        squared_sums += px.iter().sum::<f64>().powi(2);
    }
    if squares > 0.0 { (squared_sums / squares).max(1.0) } else { 1.0 }
}

/// Both witnesses' numbers, each with the other's.
fn sum(a: ByWitness, b: ByWitness) -> ByWitness {
    [a[0] + b[0], a[1] + b[1]]
}

/// How many numbers each witness can give: joints only where keypoints show them.
fn samples(residuals: &Residuals) -> ByWitness {
    let [silhouettes, keypoints] = residuals.by_witness();
    [silhouettes.len() as f64, keypoints.iter().flatten().count() as f64]
}

impl Ranking {
    /// Other cameras and kinds that are hardly less likely than the first.
    fn rivals(&self) -> Vec<Rival> {
        let Some(best) = self.ranked.first() else { return Vec::new() };
        let mut told = vec![(best.tried.hypothesis.camera, best.tried.hypothesis.kind)];
        let mut rivals = Vec::new();
        for other in &self.ranked[1..] {
            let (camera, kind) = (other.tried.hypothesis.camera, other.tried.hypothesis.kind);
            let behind = best.evidence - other.evidence;
            if behind < RIVAL_NATS && !told.contains(&(camera, kind)) {
                told.push((camera, kind));
                rivals.push(Rival { camera, kind, behind });
            }
        }
        rivals
    }
}
