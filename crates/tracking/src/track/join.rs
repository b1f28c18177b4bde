//! Two tracks of the same frames made one: forwards from a known pose, backwards from a later one.
//!
//! Both tracks are hypotheses of the frames between, and either may have lost a limb on the way. So the path through them that
//! changes over once and costs least is taken, by the same costs as where later frames mend earlier ones ([`Rewind`](super::Rewind)):
//! the free energies of its poses and the steps between them. Of paths that cost nearly the same, the one is taken whose tracks
//! are nearest to each other where it changes over.
//!
//! If they are one movement there, the poses of a few frames on both sides go from one to the other on the manifold of poses,
//! x = f ⊕ w (b ⊖ f), with w from 0 to 1 (⊕ is [`Pose::retract`], ⊖ [`Pose::local`], in tangent columns).

use std::collections::BTreeSet;

use super::estimate::Track;
use super::rewind::{SAME_M, step_cost};
use crate::body::{Model, Parameters, Pose};
use crate::search::farthest_m;

/// Frames on each side of the change that are blended.
const BLENDED: usize = 3;
/// Paths whose costs differ by less are as good as each other, nats.
const SAME: f64 = 1.0;
/// Tracks in which a joint is farther apart than this, metres, where they change over do not meet: half-way between two poses that
/// differ so much is none.
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
    /// The farthest that a joint is apart in the two tracks there, metres.
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

/// A frame on a path before and after the change.
struct Place<'a> {
    frame: usize,
    /// The poses of the forward and of the backward track; of the only one that has the frame.
    poses: [&'a Pose; 2],
    /// How far they are apart, if both tracks have the frame.
    apart_m: Option<f64>,
    /// The forward pose's free energy less the backward pose's, nats.
    behind: f64,
}

/// Joins two tracks of one body, the forward and the backward one. Frames that only one of them has are that one's. `behind` tells
/// by how many nats the forward pose of a frame is behind the backward one; it is asked where they differ. Where the tracks do not
/// meet ([`Join::meets`]) nothing is blended. `None` if no frame is in both.
#[must_use]
pub fn join(
    model: &Model,
    frame_rate: f64,
    [forward, backward]: [&Track; 2],
    mut behind: impl FnMut(usize, [&Pose; 2]) -> Option<f64>,
) -> Option<Join> {
    let frames: BTreeSet<usize> = forward.frames.keys().chain(backward.frames.keys()).copied().collect();
    let place = |frame: usize| {
        let [f, b] = [forward, backward].map(|track| track.frames.get(&frame).map(|one| &one.pose));
        let poses = [f.or(b)?, b.or(f)?];
        let apart_m = f.zip(b).map(|(f, b)| farthest_m(model, f, b));
        let differs = apart_m.is_some_and(|apart| apart > SAME_M);
        let behind = differs.then(|| behind(frame, poses)).flatten().unwrap_or(0.0);
        Some(Place { frame, poses, apart_m, behind })
    };
    let places: Vec<Place<'_>> = frames.into_iter().filter_map(place).collect();
    let at = change(model, frame_rate, &places)?;
    let distance_m = distance_m(&places[at..])?;
    let meets = distance_m <= MEETS_WITHIN_M;
    let source = |(index, place): (usize, &Place<'_>)| {
        // 2 BLENDED frames about the change, in equal steps of the weight, 0 and 1 left out.
        let weight = 0.5 + (index as f64 - at as f64 - 0.5) / (2.0 * BLENDED as f64 + 1.0);
        let is_near = meets && place.apart_m.is_some_and(|apart| apart <= MEETS_WITHIN_M);
        if is_near && 0.0 < weight && weight < 1.0 {
            let [from, to] = place.poses;
            let step: Vec<f64> = to.local(from).into_iter().map(|value| value * weight).collect();
            return (place.frame, Source::Blended(from.retract(Parameters::Tangent, &step)));
        }
        let has = |track: &Track| track.frames.contains_key(&place.frame);
        let is_forward = has(forward) && (index <= at || !has(backward));
        (place.frame, if is_forward { Source::Forward } else { Source::Backward })
    };
    let sources = places.iter().enumerate().map(source).collect();
    Some(Join { frame: places[at].frame, distance_m, sources })
}

/// How far the tracks are apart in the first of these frames, or in the next one if only one track has the first.
fn distance_m(places: &[Place<'_>]) -> Option<f64> {
    places.iter().take(2).find_map(|place| place.apart_m)
}

/// The last frame of the forward track's side. The backward track keeps the last frame.
fn change(model: &Model, frame_rate: f64, places: &[Place<'_>]) -> Option<usize> {
    let step = |from: usize, to: usize, [a, b]: [usize; 2]| {
        let (from, to) = (&places[from], &places[to]);
        let seconds = (to.frame - from.frame) as f64 / frame_rate;
        step_cost(model, seconds, from.poses[a], to.poses[b])
    };
    // What the forward track costs up to a frame and the backward one after it: the one is added, the other taken away.
    let mut cost: f64 = places.iter().map(|place| (-place.behind).max(0.0)).sum();
    cost += (1..places.len()).map(|to| step(to - 1, to, [1, 1])).sum::<f64>();
    let mut costs = Vec::with_capacity(places.len());
    for (at, place) in places.iter().enumerate() {
        cost += place.behind;
        if at > 0 {
            cost += step(at - 1, at, [0, 0]);
        }
        let mut jump = 0.0;
        if at + 1 < places.len() {
            cost -= step(at, at + 1, [1, 1]);
            jump = step(at, at + 1, [0, 1]);
        }
        costs.push(cost + jump);
    }
    costs.truncate((places.len().saturating_sub(1)).max(1));
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let nearest = |at: &usize| distance_m(&places[*at..]);
    let good = (0..costs.len()).filter(|at| costs[*at] <= least + SAME && nearest(at).is_some());
    good.min_by(|a, b| nearest(a).partial_cmp(&nearest(b)).unwrap_or(std::cmp::Ordering::Equal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::track::FrameEstimate;
    use glam::{DQuat, DVec3};

    /// A track whose root lies at these x.
    fn track(frames: impl IntoIterator<Item = (usize, f64)>) -> Track {
        let estimate = |(frame, x): (usize, f64)| {
            let mut pose = Pose::rest(&builtin::single_limb());
            pose.root = DVec3::new(x, 0.0, 0.0);
            (frame, FrameEstimate::of_pose(frame, pose))
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

    fn joined(model: &Model, tracks: [&Track; 2], behind: impl Fn(usize) -> f64) -> Option<Join> {
        join(model, 30.0, tracks, |frame, _| Some(behind(frame)))
    }

    fn blended(join: &Join) -> usize {
        join.sources.iter().filter(|(_, source)| matches!(source, Source::Blended(_))).count()
    }

    /// One track drifts upwards to the right, the other to the left: they are nearest in the middle.
    #[test]
    fn tracks_change_over_where_they_are_nearest_and_without_a_jump() {
        let model = builtin::single_limb();
        let forward = track((0..11).map(|frame| (frame, 0.002 * (frame * frame) as f64)));
        let backward = track((0..11).map(|frame| (frame, 0.1 - 0.01 * frame as f64)));
        let joined = joined(&model, [&forward, &backward], |_| 0.0).unwrap();
        assert_eq!(joined.frame, 5);
        assert!(joined.meets() && joined.distance_m < 0.001, "{}", joined.distance_m);
        let xs = xs(&joined, &forward, &backward);
        assert_eq!((xs[1], xs[9]), (0.002, 0.1 - 0.09), "the ends are the tracks' own");
        assert_eq!(blended(&joined), 2 * BLENDED);
        assert!(xs.windows(2).all(|two| (two[1] - two[0]).abs() < 0.03), "{xs:?}");
    }

    /// The forward track is lost for a while; both are nearest after that.
    #[test]
    fn what_one_track_lost_is_taken_from_the_other() {
        let model = builtin::single_limb();
        let forward = track((0..20).map(|frame| (frame, if (5..13).contains(&frame) { 0.4 } else { 0.03 })));
        let backward = track((0..20).map(|frame| (frame, if frame < 14 { 0.0 } else { 0.03 })));
        let is_lost = |frame| (5..13).contains(&frame);
        let behind = |frame| if is_lost(frame) { 4.0 } else { 0.0 };
        let tracks = [&forward, &backward];
        let found = joined(&model, tracks, behind).unwrap();
        assert!(found.frame < 5 && found.meets(), "{}", found.frame);
        assert!(xs(&found, &forward, &backward).iter().all(|x| *x < 0.05));
        // The other way round it is the backward track that is lost.
        let found = joined(&model, [&backward, &forward], |frame| -behind(frame)).unwrap();
        assert!(found.frame >= 12 && found.meets(), "{}", found.frame);
    }

    /// An arm is elsewhere in all frames: most joints agree, but half-way is no pose.
    #[test]
    fn two_different_poses_are_not_blended() {
        let model = builtin::full_body();
        let posed = |angle: f64| {
            crate::fixtures::posed(&model, DVec3::Z, &[("right upper arm", DQuat::from_rotation_y(angle))])
        };
        let [forward, backward] = [-0.9, 0.2].map(|angle| Track {
            frames: (0..12).map(|frame| (frame, FrameEstimate::of_pose(frame, posed(angle)))).collect(),
        });
        let behind = |frame| if frame < 7 { -3.0 } else { 3.0 };
        let found = joined(&model, [&forward, &backward], behind).unwrap();
        assert_eq!((found.frame, blended(&found)), (6, 0));
        assert!(!found.meets(), "{}", found.distance_m);
    }

    #[test]
    fn tracks_that_do_not_meet_are_not_blended() {
        let model = builtin::single_limb();
        let forward = track((0..6).map(|frame| (frame, 0.0)));
        let backward = track((2..9).map(|frame| (frame, 1.0)));
        let found = joined(&model, [&forward, &backward], |_| 0.0).unwrap();
        assert!(!found.meets() && blended(&found) == 0);
        assert_eq!(found.sources[0].1, Source::Forward);
        assert_eq!(found.sources[8].1, Source::Backward);
        assert_eq!(found.sources.len(), 9);
        assert_eq!(joined(&model, [&forward, &track([(7, 0.0)])], |_| 0.0), None);
    }
}
