//! The offset between two recordings' clocks, from what no axes and no unit change.
//!
//! Signals of both are the distances between pairs of joints that vary most, over their mean; or angles, where a recording has nothing
//! else. The offset is the one with the least mean |a(t) − b(t + offset)|: coarse over all offsets allowed, then by golden section.

use glam::DVec3;

use super::super::angles::JointAngle;
use super::super::trajectories::{Moments, Trajectories};
use crate::statistics::{mean, median};

/// Signals that are compared.
const SIGNALS: usize = 12;
/// Frames by which signals are chosen, at most.
const MOST_JUDGED: usize = 400;
/// Times of the first that are compared, at most.
const MOST_TIMES: usize = 1500;
/// Both must be there for this share of the shorter one.
const LEAST_TOGETHER: f64 = 0.5;
/// An offset counts where it leaves less than this share of what none leaves.
const BETTER: f64 = 0.9;
/// Golden section: the interval shrinks by 0.618 a step.
const GOLDEN_STEPS: usize = 24;

/// The offset of two clocks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockOffset {
    /// Seconds: what the track shows at t, the reference shows at t + offset.
    pub seconds: f64,
    /// It was measured; else it was given, or there is no motion to measure it by and both clocks count as one.
    pub is_measured: bool,
}

/// One value a frame.
type Signal = Vec<Option<f64>>;

/// Both recordings' signals, in the same order.
struct Signals<'a> {
    track: &'a Trajectories,
    reference: Moments<'a>,
    pairs: Vec<[Signal; 2]>,
    /// Frames of the track whose times are compared.
    frames: Vec<usize>,
    fewest: usize,
}

/// Finds the offset of two recordings, at most `most` seconds either way.
pub(super) fn measure(
    track: &Trajectories,
    reference: &Trajectories,
    joints: &[[usize; 2]],
    most: f64,
) -> ClockOffset {
    let unmeasured = ClockOffset { seconds: 0.0, is_measured: false };
    let pairs = if joints.len() < 2 { angles(track, reference) } else { distances(track, reference, joints) };
    let step = track.period().max(reference.period());
    if pairs.is_empty() || step <= 0.0 {
        return unmeasured;
    }
    let stride = track.times.len().div_ceil(MOST_TIMES);
    let frames: Vec<usize> = (0..track.times.len()).step_by(stride).collect();
    let length = |times: &[f64]| times.last().zip(times.first()).map_or(0.0, |(last, first)| last - first);
    let share = (length(&reference.times) / length(&track.times).max(step)).min(1.0);
    let fewest = ((LEAST_TOGETHER * share * frames.len() as f64) as usize).max(3);
    let signals = Signals { track, reference: reference.moments(), pairs, frames, fewest };
    let starts = reference.times[0] - track.times[0];
    let steps = (most / step).ceil() as i64;
    // About equal clocks, and about equal beginnings: files that count from 0, or from where the recording was cut.
    let centres = if starts.abs() <= step { vec![0.0] } else { vec![0.0, starts] };
    let offsets = centres.iter().flat_map(|centre| (-steps..=steps).map(move |k| centre + k as f64 * step));
    let judged = offsets.filter_map(|offset| Some((signals.difference(offset)?, offset)));
    let Some((_, best)) = judged.min_by(|a, b| a.0.total_cmp(&b.0)) else { return unmeasured };
    let seconds = signals.golden(best - step, best + step);
    let [without, with] = [0.0, seconds].map(|offset| signals.difference(offset));
    match (without, with) {
        // Files that count frames from 1 begin a frame late: of the two usual clocks the better one counts.
        (Some(without), Some(with)) if with >= BETTER * without => {
            let is_late = signals.difference(starts).is_some_and(|together| together < without);
            if is_late { ClockOffset { seconds: starts, is_measured: true } } else { unmeasured }
        }
        (_, None) => unmeasured,
        _ => ClockOffset { seconds, is_measured: true },
    }
}

impl Signals<'_> {
    /// Mean difference with an offset; `None` where both are hardly ever there.
    fn difference(&self, offset: f64) -> Option<f64> {
        let (mut sum, mut count, mut together) = (0.0, 0, 0);
        for &frame in &self.frames {
            let Some(between) = self.reference.between(self.track.times[frame] + offset) else { continue };
            let before = count;
            for [a, b] in &self.pairs {
                if let Some((a, b)) = a[frame].zip(between.value(b)) {
                    sum += (a - b).abs();
                    count += 1;
                }
            }
            together += usize::from(count > before);
        }
        (together >= self.fewest).then(|| sum / count as f64)
    }

    /// The least difference between two offsets.
    fn golden(&self, mut low: f64, mut high: f64) -> f64 {
        let at = |offset: f64| self.difference(offset).unwrap_or(f64::INFINITY);
        let ratio = (5_f64.sqrt() - 1.0) / 2.0;
        let [mut a, mut b] = [high - ratio * (high - low), low + ratio * (high - low)];
        let [mut at_a, mut at_b] = [at(a), at(b)];
        for _ in 0..GOLDEN_STEPS {
            if at_a <= at_b {
                (high, b, at_b) = (b, a, at_a);
                a = high - ratio * (high - low);
                at_a = at(a);
            } else {
                (low, a, at_a) = (a, b, at_b);
                b = low + ratio * (high - low);
                at_b = at(b);
            }
        }
        (low + high) / 2.0
    }
}

/// The distances of joints that vary most in the reference, each recording's over its own mean distance.
fn distances(track: &Trajectories, reference: &Trajectories, joints: &[[usize; 2]]) -> Vec<[Signal; 2]> {
    let signal = |of: &Trajectories, a: usize, b: usize, stride: usize| -> Signal {
        let frames = of.points.iter().step_by(stride);
        frames.map(|points| Some(points[a]?.distance(points[b]?))).collect()
    };
    // Some hundred frames tell which pairs vary: of a body with many joints all pairs would fill the memory.
    let [of_track, of_reference] = [track, reference].map(|of| of.points.len().div_ceil(MOST_JUDGED));
    let is_there = |signal: &Signal| signal.iter().flatten().nth(1).is_some();
    let mut varying: Vec<(f64, [[usize; 2]; 2])> = Vec::new();
    let mut all: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for (first, a) in joints.iter().enumerate() {
        for b in &joints[..first] {
            let judged = [signal(track, a[0], b[0], of_track), signal(reference, a[1], b[1], of_reference)];
            if judged.iter().all(is_there) {
                varying.push((spread(&judged[1]), [*a, *b]));
            }
            for (all, judged) in all.iter_mut().zip(judged) {
                all.extend(mean(judged.into_iter().flatten()));
            }
        }
    }
    // How large the body is: of all pairs, since those that vary most are long in one recording and short in the other.
    let sizes = all.map(|all| mean(all).filter(|size| *size > 0.0).unwrap_or(1.0));
    varying.sort_by(|a, b| b.0.total_cmp(&a.0));
    varying.truncate(SIGNALS);
    let scaled = |signal: Signal, size: f64| -> Signal {
        signal.into_iter().map(|value| value.map(|value| value / size)).collect()
    };
    let pair = |(_, [a, b]): &(f64, [[usize; 2]; 2])| {
        [scaled(signal(track, a[0], b[0], 1), sizes[0]), scaled(signal(reference, a[1], b[1], 1), sizes[1])]
    };
    varying.iter().map(pair).collect()
}

/// The angles that both have, without what they differ by throughout.
fn angles(track: &Trajectories, reference: &Trajectories) -> Vec<[Signal; 2]> {
    let pair = |angle: JointAngle| {
        let mut pair = [track, reference].map(|of| of.angle_curve(angle));
        for signal in &mut pair {
            let middle = median(&mut signal.iter().flatten().copied().collect::<Vec<f64>>())?;
            signal.iter_mut().flatten().for_each(|value| *value -= middle);
        }
        Some(pair)
    };
    JointAngle::ALL.into_iter().filter_map(pair).collect()
}

/// Mean distance from the mean.
fn spread(signal: &Signal) -> f64 {
    let middle = mean(signal.iter().flatten().copied()).unwrap_or(0.0);
    mean(signal.iter().flatten().map(|value| (value - middle).abs())).unwrap_or(0.0)
}

/// The joints that both recordings have, by name: columns in the first and in the second.
pub(super) fn common_joints(track: &Trajectories, reference: &Trajectories) -> Vec<[usize; 2]> {
    let names = track.joints.iter().enumerate();
    names.filter_map(|(column, name)| Some([column, reference.column(name)?])).collect()
}

/// The joints of both at the track's frames, with the reference's clock set.
pub(super) fn matched(
    track: &Trajectories,
    reference: &Trajectories,
    joints: &[[usize; 2]],
    offset: f64,
) -> Vec<Vec<Option<[DVec3; 2]>>> {
    if joints.is_empty() {
        return vec![Vec::new(); track.times.len()];
    }
    let moments = reference.moments();
    let frame = |(time, ours): (&f64, &Vec<Option<DVec3>>)| {
        let theirs = moments.points_at(time + offset);
        joints.iter().map(|[a, b]| Some([ours[*a]?, theirs[*b]?])).collect()
    };
    track.times.iter().zip(&track.points).map(frame).collect()
}
