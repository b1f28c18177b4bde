//! Two tracks of the same frames made one: forwards from a known pose, backwards from a later one.
//!
//! A track errs more the farther it is from the pose that it began with. So earlier frames are the forward
//! track's, later ones the backward track's, and they change over where their joints lie nearest to each other.
//! Over a few frames on both sides the poses go from one to the other on the manifold of poses,
//! x = f ⊕ w (b ⊖ f), with w from 0 to 1 (⊕ is [`Pose::retract`], ⊖ [`Pose::local`], in tangent columns).

use super::estimate::Track;
use crate::body::{Kinematics, Model, Parameters, Pose};

/// Frames on each side of the change that are blended.
const BLENDED: usize = 3;
/// Distances that differ by less are the same: then the costs decide. Metres.
const SAME_M: f64 = 0.005;
/// Tracks whose joints are farther apart (mean, metres) where they are nearest do not meet: half-way between two
/// poses that differ so much is none.
pub const MEETS_WITHIN_M: f64 = 0.15;

/// Which track a frame's pose was taken from.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// The forward track's.
    Forward,
    /// The backward track's.
    Backward,
    /// Between the two: no fit of either.
    Blended(Pose),
}

/// How two tracks were joined.
#[derive(Debug, Clone, PartialEq)]
pub struct Join {
    /// The last frame of the forward track's side.
    pub frame: usize,
    /// Mean distance of the two tracks' joints there, metres.
    pub distance_m: f64,
    /// Every frame that either track has, in their order.
    pub sources: Vec<(usize, Source)>,
}

impl Join {
    /// Whether the two tracks are near enough to each other to be one movement.
    #[must_use]
    pub fn meets(&self) -> bool {
        self.distance_m <= MEETS_WITHIN_M
    }
}

/// Joins two tracks of one body. Frames that only one of them has are that one's. Where they do not meet
/// ([`Join::meets`]) nothing is blended. `None` if no frame is in both.
#[must_use]
pub fn join(model: &Model, forward: &Track, backward: &Track) -> Option<Join> {
    let common: Vec<usize> =
        forward.frames.keys().copied().filter(|frame| backward.frames.contains_key(frame)).collect();
    let distances: Vec<f64> = common
        .iter()
        .map(|frame| mean_distance(model, &forward.frames[frame].pose, &backward.frames[frame].pose))
        .collect();
    let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
    let costs = costs_of_changing_after(&common, forward, backward);
    let at = (0..common.len())
        .filter(|&at| distances[at] <= nearest + SAME_M)
        .min_by(|&a, &b| costs[a].total_cmp(&costs[b]))?;
    let (frame, distance_m) = (common[at], distances[at]);
    let meets = distance_m <= MEETS_WITHIN_M;
    let source = |other: usize| {
        let Some(index) = common.iter().position(|common| *common == other).filter(|_| meets) else {
            return plain_source(other, frame, forward, backward);
        };
        // 2 BLENDED frames about the change, in equal steps of the weight, 0 and 1 left out.
        let offset = index as f64 - at as f64 - 0.5;
        let weight = 0.5 + offset / (2.0 * BLENDED as f64 + 1.0);
        if weight <= 0.0 || weight >= 1.0 {
            return plain_source(other, frame, forward, backward);
        }
        let (from, to) = (&forward.frames[&other].pose, &backward.frames[&other].pose);
        let step: Vec<f64> = to.local(from).into_iter().map(|value| value * weight).collect();
        Source::Blended(from.retract(Parameters::Tangent, &step))
    };
    let mut frames: Vec<usize> = forward.frames.keys().chain(backward.frames.keys()).copied().collect();
    frames.sort_unstable();
    frames.dedup();
    let sources = frames.into_iter().map(|frame| (frame, source(frame))).collect();
    Some(Join { frame, distance_m, sources })
}

fn plain_source(frame: usize, last_forward: usize, forward: &Track, backward: &Track) -> Source {
    let has = |track: &Track| track.frames.contains_key(&frame);
    if has(forward) && (frame <= last_forward || !has(backward)) { Source::Forward } else { Source::Backward }
}

/// For every common frame: the sum of costs if the forward track is followed up to it and the backward one after
/// it. Lost frames count double, those with nobody in the picture nothing: they are the same in both tracks.
fn costs_of_changing_after(common: &[usize], forward: &Track, backward: &Track) -> Vec<f64> {
    let cost = |track: &Track, frame: &usize| {
        let estimate = &track.frames[frame];
        estimate.cost.unwrap_or_default() * if estimate.is_lost() { 2.0 } else { 1.0 }
    };
    let after: f64 = common.iter().map(|frame| cost(backward, frame)).sum();
    let mut sum = after;
    common
        .iter()
        .map(|frame| {
            sum += cost(forward, frame) - cost(backward, frame);
            sum
        })
        .collect()
}

/// Mean distance of two poses' joints, metres.
fn mean_distance(model: &Model, a: &Pose, b: &Pose) -> f64 {
    let (ka, kb) = (Kinematics::new(model, a), Kinematics::new(model, b));
    let sum: f64 = ka.ends().iter().zip(kb.ends()).map(|(a, b)| a.distance(*b)).sum();
    (sum + a.root.distance(b.root)) / (ka.ends().len() + 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::track::FrameEstimate;
    use glam::DVec3;

    /// A track whose root lies at these x, with these costs.
    fn track(frames: impl IntoIterator<Item = (usize, f64, f64)>) -> Track {
        let estimate = |(frame, x, cost): (usize, f64, f64)| {
            let mut pose = Pose::rest(&builtin::single_limb());
            pose.root = DVec3::new(x, 0.0, 0.0);
            let known = FrameEstimate::of_pose(frame, pose);
            let estimate = FrameEstimate { cost: Some(cost), rms: Some(0.0), iterations: 1, ..known };
            (frame, estimate)
        };
        Track { frames: frames.into_iter().map(estimate).collect() }
    }

    fn xs(join: &Join, forward: &Track, backward: &Track) -> Vec<f64> {
        let x = |(frame, source): &(usize, Source)| match source {
            Source::Forward => forward.frames[frame].pose.root.x,
            Source::Backward => backward.frames[frame].pose.root.x,
            Source::Blended(pose) => pose.root.x,
        };
        join.sources.iter().map(x).collect()
    }

    /// One track drifts upwards to the right, the other to the left: they are nearest in the middle.
    #[test]
    fn tracks_change_over_where_they_are_nearest_and_without_a_jump() {
        let model = builtin::single_limb();
        let forward = track((0..11).map(|frame| (frame, 0.002 * (frame * frame) as f64, 1.0)));
        let backward = track((0..11).map(|frame| (frame, 0.1 - 0.01 * frame as f64, 1.0)));
        let joined = join(&model, &forward, &backward).unwrap();
        assert_eq!(joined.frame, 5);
        assert!(joined.meets() && joined.distance_m < 0.001, "{}", joined.distance_m);
        let xs = xs(&joined, &forward, &backward);
        assert_eq!((xs[1], xs[9]), (0.002, 0.1 - 0.09), "the ends are the tracks' own");
        let blended =
            joined.sources.iter().filter(|(_, source)| matches!(source, Source::Blended(_))).count();
        assert_eq!(blended, 2 * BLENDED);
        assert!(xs.windows(2).all(|two| (two[1] - two[0]).abs() < 0.03), "{xs:?}");
    }

    #[test]
    fn where_both_are_the_same_the_costs_decide() {
        let model = builtin::single_limb();
        let forward = track((0..8).map(|frame| (frame, 0.0, if frame < 3 { 1.0 } else { 9.0 })));
        let backward = track((0..8).map(|frame| (frame, 0.0, if frame < 3 { 9.0 } else { 1.0 })));
        assert_eq!(join(&model, &forward, &backward).unwrap().frame, 2);
    }

    #[test]
    fn tracks_that_do_not_meet_are_not_blended() {
        let model = builtin::single_limb();
        let forward = track((0..6).map(|frame| (frame, 0.0, 1.0)));
        let backward = track((2..9).map(|frame| (frame, 1.0, 1.0)));
        let joined = join(&model, &forward, &backward).unwrap();
        assert!(!joined.meets());
        assert!(joined.sources.iter().all(|(_, source)| !matches!(source, Source::Blended(_))));
        assert_eq!(joined.sources[0].1, Source::Forward);
        assert_eq!(joined.sources[8].1, Source::Backward);
        assert_eq!(joined.sources.len(), 9);
        assert_eq!(join(&model, &forward, &track([(7, 0.0, 1.0)])), None);
    }
}
