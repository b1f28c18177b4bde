//! The clocks of all cameras from the evidence of all pairs.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::answer::{
    CameraOffset, Offset, PairOffset, Synchronisation, SynchroniseError, SynchroniseOptions, Undecided,
};
use super::evidence::Comparison;
use super::outline::Recording;
use super::signals::{PairSignals, image_motion};
use crate::numbers::{Range, check_options};

/// Frames with a silhouette that a camera must have.
const LEAST_FRAMES: usize = 12;
/// Edges that move less than this do not tell moments apart, pixels.
const LEAST_MOTION_PX: f64 = 1.5;
/// A pair whose best evidence is less than this has nothing to say, nats.
const LEAST_EVIDENCE: f64 = 4.0;
/// Offsets beyond the longest recording are refused: absurd times must not fill the memory.
const MOST_OFFSETS: f64 = 10_000.0;
/// Rounds over all cameras; each can only raise the evidence.
const ROUNDS: usize = 20;
/// A pair's own peak is looked for this many steps of the grid (half frames) about the offsets of all cameras.
const PEAK_WITHIN: f64 = 3.0;
/// No pair is believed to be more exact, seconds.
const LEAST_DEVIATION_S: f64 = 1e-6;
/// A rise by less than this is no other peak, nats.
const RIPPLE: f64 = 2.0;
/// A pair this many deviations off the others does not count, if it is also half a frame off.
const OUTLIER: f64 = 4.0;

/// Finds how far every camera's clock is ahead of the first one's.
///
/// Guaranteed: as many answers as recordings, in their order, the first [`CameraOffset::Reference`]; the same bits for any
/// number of threads. Where an offset cannot be told the answer says why.
///
/// # Errors
/// Fewer than two recordings, times that do not grow, a mask of another size than its camera's, options out of range.
pub fn synchronise(
    recordings: &[Recording],
    options: &SynchroniseOptions,
) -> Result<Synchronisation, SynchroniseError> {
    check(recordings, options)?;
    let refused: Vec<Option<Undecided>> = recordings.iter().map(refusal).collect();
    let count = recordings.len();
    let period = recordings.iter().map(Recording::period).fold(0.0, f64::max);
    let longest =
        recordings.iter().map(|recording| recording.span()[1] - recording.span()[0]).fold(0.0, f64::max);
    let step = (0.5 * period).max(longest / MOST_OFFSETS);
    let couples: Vec<[usize; 2]> = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b])).collect();
    let pairs: Vec<Comparison> = couples
        .into_par_iter()
        .filter(|couple| couple.iter().all(|&camera| refused[camera].is_none()))
        .filter_map(|cameras| {
            let [a, b] = cameras.map(|camera| &recordings[camera]);
            Comparison::new(cameras, PairSignals::of(a, b), [a.span(), b.span()], step, options)
        })
        .collect();
    let network = Network { count, step, pairs };
    let coarse = network.climb();
    Ok(network.synchronisation(&coarse, &refused, options))
}

fn check(recordings: &[Recording], options: &SynchroniseOptions) -> Result<(), SynchroniseError> {
    let share = Range(|value| (0.0..=1.0).contains(&value), "0 to 1");
    check_options([
        ("least_overlap", options.least_overlap, share),
        ("least_probability", options.least_probability, share),
        ("largest_rival", options.largest_rival, share),
        ("farthest_s", options.farthest_s, Range(|value| value >= 0.0, "0 seconds or more")),
    ])?;
    if recordings.len() < 2 {
        return Err(SynchroniseError::Count { count: recordings.len() });
    }
    for (camera, recording) in recordings.iter().enumerate() {
        if let Some(frame) = recording.wrong_size {
            return Err(SynchroniseError::Size { camera, frame });
        }
        let mut before = f64::NEG_INFINITY;
        for (frame, sighting) in recording.sightings.iter().enumerate() {
            let seconds = sighting.seconds;
            if !(seconds.is_finite() && seconds > before) {
                return Err(SynchroniseError::Times { camera, frame, seconds });
            }
            before = seconds;
        }
    }
    Ok(())
}

/// Why a camera cannot be told from its own silhouettes.
fn refusal(recording: &Recording) -> Option<Undecided> {
    let found = recording.seen();
    if found < LEAST_FRAMES {
        return Some(Undecided::FewSilhouettes { found, wanted: LEAST_FRAMES });
    }
    let spread_px = image_motion(recording);
    (spread_px < LEAST_MOTION_PX).then_some(Undecided::NoMotion { spread_px })
}

impl Comparison {
    fn speaks(&self) -> bool {
        self.curve.best() >= LEAST_EVIDENCE
    }

    /// The evidence if a camera of it has one offset and the other another.
    fn evidence_of(&self, camera: usize, offset: f64, other: f64) -> f64 {
        let tau = if camera == self.cameras[1] { offset - other } else { other - offset };
        self.curve.at(tau)
    }

    /// The camera beside this one.
    fn other_camera(&self, camera: usize) -> Option<usize> {
        let [a, b] = self.cameras;
        if camera == a { Some(b) } else { (camera == b).then_some(a) }
    }
}

/// All cameras and the pairs that can be compared.
struct Network {
    count: usize,
    step: f64,
    pairs: Vec<Comparison>,
}

impl Network {
    /// Evidence for a camera's offset, the others' given; `None` where no pair joins it to one that is known.
    fn evidence(&self, camera: usize, offset: f64, known: &[Option<f64>]) -> Option<f64> {
        let mut sum = None;
        for pair in self.pairs.iter().filter(|pair| pair.speaks()) {
            let Some(other) = pair.other_camera(camera).and_then(|other| known[other]) else { continue };
            *sum.get_or_insert(0.0) += pair.evidence_of(camera, offset, other);
        }
        sum
    }

    /// Offsets that a camera may have beside those that are known, in order.
    fn candidates(&self, camera: usize, known: &[Option<f64>]) -> Vec<f64> {
        let mut range: Option<[f64; 2]> = None;
        for pair in self.pairs.iter().filter(|pair| pair.speaks()) {
            let Some(other) = pair.other_camera(camera).and_then(|other| known[other]) else { continue };
            let curve = &pair.curve;
            let ends = [curve.first, curve.offset(curve.values.len() - 1)];
            let [low, high] = if camera == pair.cameras[1] {
                ends.map(|end| other + end)
            } else {
                [other - ends[1], other - ends[0]]
            };
            let [lowest, highest] = range.unwrap_or([low, high]);
            range = Some([lowest.min(low), highest.max(high)]);
        }
        let Some([low, high]) = range else { return Vec::new() };
        let first = (low / self.step).ceil();
        let count = ((high / self.step).floor() - first).max(0.0) as usize + 1;
        (0..count).map(|index| self.step * (first + index as f64)).collect()
    }

    fn best(&self, camera: usize, known: &[Option<f64>]) -> Option<(f64, f64)> {
        let tried = self.candidates(camera, known).into_iter();
        let tried = tried.filter_map(|offset| Some((offset, self.evidence(camera, offset, known)?)));
        tried.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Offsets on the grid: from the first camera on, always the one that is surest next, then each again beside all others
    /// until nothing changes.
    fn climb(&self) -> Vec<Option<f64>> {
        let mut known = vec![None; self.count];
        known[0] = Some(0.0);
        loop {
            let next = (1..self.count)
                .filter(|&camera| known[camera].is_none())
                .filter_map(|camera| Some((camera, self.best(camera, &known)?)))
                .max_by(|a, b| a.1.1.total_cmp(&b.1.1));
            let Some((camera, (offset, _))) = next else { break };
            known[camera] = Some(offset);
        }
        for _ in 0..ROUNDS {
            let before = known.clone();
            for camera in 1..self.count {
                if known[camera].is_some()
                    && let Some((offset, _)) = self.best(camera, &known)
                {
                    known[camera] = Some(offset);
                }
            }
            if known == before {
                break;
            }
        }
        known
    }

    fn synchronisation(
        &self,
        coarse: &[Option<f64>],
        refused: &[Option<Undecided>],
        options: &SynchroniseOptions,
    ) -> Synchronisation {
        let peak = |pair: &Comparison| {
            let [a, b] = pair.cameras;
            pair.peak(coarse[b]? - coarse[a]?, PEAK_WITHIN * self.step)
        };
        let mut pairs: Vec<PairOffset> =
            self.pairs.iter().filter(|pair| pair.speaks()).filter_map(peak).collect();
        let solution = settle(&mut pairs, coarse, self.step);
        for pair in &mut pairs {
            let [a, b] = pair.cameras;
            pair.residual_s = pair.seconds - (solution.offsets[b] - solution.offsets[a]);
        }
        let cameras = (0..self.count)
            .map(|camera| match (camera, refused[camera]) {
                (0, _) => CameraOffset::Reference,
                (_, Some(why)) => CameraOffset::Undecided(why),
                (_, None) => self.judge(camera, coarse, refused[0], &solution, options),
            })
            .collect();
        let used: Vec<&PairOffset> = pairs.iter().filter(|pair| pair.is_used).collect();
        let has_loop = used.len() + 1 > coarse.iter().flatten().count();
        let square: f64 = used.iter().map(|pair| pair.weight() * pair.residual_s.powi(2)).sum();
        let loop_error_s =
            has_loop.then(|| (square / used.iter().map(|pair| pair.weight()).sum::<f64>()).sqrt());
        Synchronisation { cameras, pairs, loop_error_s }
    }

    /// Whether a camera's offset is told, and how sure it is.
    fn judge(
        &self,
        camera: usize,
        coarse: &[Option<f64>],
        first: Option<Undecided>,
        solution: &Solution,
        options: &SynchroniseOptions,
    ) -> CameraOffset {
        let Some(best_s) = coarse[camera] else {
            return CameraOffset::Undecided(first.unwrap_or(Undecided::NoAgreement));
        };
        let tried = self.candidates(camera, coarse);
        let values: Vec<f64> =
            tried.iter().map(|&offset| self.evidence(camera, offset, coarse).unwrap_or(0.0)).collect();
        let Some(posterior) = Posterior::of(&tried, &values) else {
            return CameraOffset::Undecided(Undecided::NoAgreement);
        };
        let Posterior { probability, evidence, rival, .. } = posterior;
        let is_rivalled = rival.is_some_and(|(_, nats)| nats > options.largest_rival * evidence);
        let deviation_s = solution.deviations[camera].max(posterior.deviation_s);
        if evidence < LEAST_EVIDENCE || !deviation_s.is_finite() {
            return CameraOffset::Undecided(Undecided::NoAgreement);
        }
        if probability < options.least_probability || is_rivalled {
            let rival_s = rival.map_or(best_s, |(offset, _)| offset);
            return CameraOffset::Undecided(Undecided::Ambiguous { best_s, rival_s, probability });
        }
        let seconds = solution.offsets[camera];
        CameraOffset::Found(Offset { seconds, deviation_s, probability, evidence, rival })
    }
}

/// What a camera's evidence at all offsets makes of the best of them.
struct Posterior {
    evidence: f64,
    /// Of the best peak, beside all other offsets and beside knowing nothing.
    probability: f64,
    /// How wide the peak is beyond the grid's step, seconds.
    deviation_s: f64,
    /// The best offset of another peak, and its evidence.
    rival: Option<(f64, f64)>,
}

impl Posterior {
    fn of(offsets: &[f64], values: &[f64]) -> Option<Self> {
        let best = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b]))?;
        // The peak reaches as far as the evidence falls; ripples do not end it, a valley with a rise behind it does.
        let reach = |steps: &mut dyn Iterator<Item = usize>| {
            let (mut lowest, mut end) = (values[best], best);
            for at in steps {
                if values[at] <= lowest {
                    (lowest, end) = (values[at], at);
                } else if values[at] > lowest + RIPPLE {
                    break;
                }
            }
            end
        };
        let within = reach(&mut (0..best).rev())..=reach(&mut (best + 1..values.len()));
        let weight = |index: usize| (values[index] - values[best]).exp();
        let sum =
            |of: &dyn Fn(usize) -> f64| within.clone().map(|index| weight(index) * of(index)).sum::<f64>();
        let mass = sum(&|_| 1.0);
        let mean = sum(&|index| offsets[index]) / mass;
        let variance = sum(&|index| (offsets[index] - mean).powi(2)) / mass;
        let all: f64 = (0..values.len()).map(weight).sum();
        // No knowledge is as good as evidence 0 at every offset.
        let nothing = values.len() as f64 * (-values[best]).exp();
        let others = (0..values.len()).filter(|index| !within.contains(index));
        let rival = others.max_by(|&a, &b| values[a].total_cmp(&values[b]));
        let step = offsets.get(1).zip(offsets.first()).map_or(0.0, |(b, a)| b - a);
        Some(Self {
            evidence: values[best],
            probability: mass / (all + nothing),
            // A peak of one or two steps is as narrow as its parabola says.
            deviation_s: (variance - step * step).max(0.0).sqrt(),
            rival: rival.map(|index| (offsets[index], values[index])),
        })
    }
}

impl PairOffset {
    /// Its deviation as far as that is believed, seconds.
    fn believed_deviation(&self) -> f64 {
        self.deviation_s.max(LEAST_DEVIATION_S)
    }

    fn weight(&self) -> f64 {
        self.believed_deviation().powi(-2)
    }
}

/// Offsets by weighted least squares; deviations are infinite where a camera is joined to nothing.
struct Solution {
    offsets: Vec<f64>,
    deviations: Vec<f64>,
}

/// Least squares over the pairs, worst outliers left out one by one.
fn settle(pairs: &mut [PairOffset], coarse: &[Option<f64>], step: f64) -> Solution {
    loop {
        let solution = least_squares(pairs, coarse);
        let off = |pair: &PairOffset| {
            let [a, b] = pair.cameras;
            let seconds = (pair.seconds - solution.offsets[b] + solution.offsets[a]).abs();
            let share = seconds / pair.believed_deviation();
            (seconds > step && share > OUTLIER).then_some(share)
        };
        let worst = (0..pairs.len())
            .filter(|&index| pairs[index].is_used)
            .filter_map(|index| Some((index, off(&pairs[index])?)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((worst, _)) = worst else { return solution };
        pairs[worst].is_used = false;
        let without = least_squares(pairs, coarse);
        let lost = |camera: usize| {
            without.deviations[camera].is_infinite() && solution.deviations[camera].is_finite()
        };
        if (0..coarse.len()).any(lost) {
            pairs[worst].is_used = true;
            return solution;
        }
    }
}

fn least_squares(pairs: &[PairOffset], coarse: &[Option<f64>]) -> Solution {
    let count = coarse.len();
    let mut offsets: Vec<f64> = coarse.iter().map(|offset| offset.unwrap_or(0.0)).collect();
    let mut deviations = vec![f64::INFINITY; count];
    deviations[0] = 0.0;
    // Cameras that pairs join to the first.
    let mut reached = vec![false; count];
    reached[0] = true;
    for _ in 1..count {
        for pair in pairs.iter().filter(|pair| pair.is_used) {
            let [a, b] = pair.cameras;
            (reached[a], reached[b]) = (reached[a] || reached[b], reached[a] || reached[b]);
        }
    }
    let free: Vec<usize> = (1..count).filter(|&camera| reached[camera]).collect();
    let row = |camera: usize| free.iter().position(|&other| other == camera);
    let (mut normal, mut right) = (DMatrix::zeros(free.len(), free.len()), DVector::zeros(free.len()));
    let used = || pairs.iter().filter(|pair| pair.is_used && reached[pair.cameras[0]]);
    for pair in used() {
        let weight = pair.weight();
        let rows = pair.cameras.map(row);
        for (row, sign) in rows.into_iter().zip([-1.0, 1.0]) {
            let Some(row) = row else { continue };
            right[row] += sign * weight * pair.seconds;
            normal[(row, row)] += weight;
        }
        if let [Some(a), Some(b)] = rows {
            normal[(a, b)] -= weight;
            normal[(b, a)] -= weight;
        }
    }
    let Some(factor) = normal.cholesky() else { return Solution { offsets, deviations } };
    let solved = factor.solve(&right);
    for (row, &camera) in free.iter().enumerate() {
        offsets[camera] = solved[row];
    }
    let chi_square: f64 = used()
        .map(|pair| {
            let [a, b] = pair.cameras;
            ((pair.seconds - offsets[b] + offsets[a]) / pair.believed_deviation()).powi(2)
        })
        .sum();
    // Pairs that contradict one another know less than they think.
    let spare = used().count().saturating_sub(free.len());
    let worse = if spare > 0 { (chi_square / spare as f64).max(1.0) } else { 1.0 };
    let inverse = factor.inverse();
    for (row, &camera) in free.iter().enumerate() {
        deviations[camera] = (inverse[(row, row)] * worse).sqrt();
    }
    Solution { offsets, deviations }
}
