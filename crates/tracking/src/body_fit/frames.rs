//! What a frame contributes, and which frames to look at.

use glam::DVec3;

use super::widening;
use crate::body::{Kinematics, Model, Pose, Sides};
use crate::fit::{Evidence, FitView};
use crate::metrics::ReferenceJoints;
use crate::render::{Ramp, RendererKind, View, prediction};
use crate::silhouette::Overlap;
use crate::statistics::upper_median;
use crate::track::FrameEstimate;

/// What one frame contributes.
#[derive(Debug, Clone)]
pub struct BodyFrame {
    /// Its number, for the report.
    pub frame: usize,
    /// Its cameras.
    pub views: Vec<FitView>,
    /// A pose near its own.
    pub start: Pose,
    /// Joints that are known from elsewhere, a few centimetres accurate (keypoints); none is fine.
    pub joints: ReferenceJoints,
}

/// A frame of a track that sizes may be fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct PosedFrame {
    /// Its number.
    pub frame: usize,
    /// What was found in it.
    pub pose: Pose,
    /// Overlap of all cameras together, where it is known.
    pub iou: Option<f64>,
    /// Whether the subject, or a limb of it, was lost.
    pub is_lost: bool,
}

impl BodyFrame {
    /// Overlap of its masks with a body in a pose, as silhouettes that are this many pixels too wide show it; `None` without
    /// masks.
    pub(super) fn overlap(&self, model: &Model, pose: &Pose, widening_px: f64) -> Option<Overlap> {
        let kinematics = Kinematics::new(model, pose);
        let of_view = |view: &FitView| {
            let Evidence::Mask(mask) = &view.evidence else { return None };
            let metres_per_px = widening::metres_per_px(&kinematics, &view.camera);
            let wide = widening::widened(model, &metres_per_px, widening_px);
            let drawn = View::new(&wide, &kinematics, &view.camera, RendererKind::Capsule, Ramp::Half);
            Overlap::between(mask, &prediction::lambda(&drawn)).ok()
        };
        self.views.iter().filter_map(of_view).reduce(Overlap::merge)
    }
}

impl From<&FrameEstimate> for PosedFrame {
    fn from(estimate: &FrameEstimate) -> Self {
        let (frame, pose) = (estimate.frame, estimate.pose.clone());
        Self { frame, pose, iou: estimate.iou(), is_lost: estimate.is_lost() }
    }
}

/// Which frames sizes are fitted to, and which judge them: indices among the candidates, in the order of the frames.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Choice {
    /// Sizes are fitted to these.
    pub fitted: Vec<usize>,
    /// And judged by these.
    pub held_out: Vec<usize>,
    /// Left out: lost.
    pub lost: usize,
    /// Left out: the body faces the other way than in most frames about it, from one candidate to the next.
    pub turned: usize,
    /// Left out: seen much worse than most.
    pub poor: usize,
}

/// A frame whose IoU is this far below the median is seen poorly.
const POOR: f64 = 0.05;
/// Between one candidate and the next a body that turns by more than this cosine's angle, 120°, was turned round by the track.
const TURNED: f64 = -0.5;

/// Chooses frames whose poses are far from one another: first the one seen best, then always the one farthest from all
/// that were chosen, by the mean distance of their joints about the root. Every third is held out. Lost frames, those seen
/// poorly and those in which the track turned the body round are no candidates.
///
/// `candidates` are in the order of their frames, with poses of `model`.
pub fn choose(model: &Model, candidates: &[PosedFrame], fitted: usize, held_out: usize) -> Choice {
    let mut choice = Choice::default();
    let mut good: Vec<usize> = (0..candidates.len()).filter(|&one| !candidates[one].is_lost).collect();
    choice.lost = candidates.len() - good.len();
    let mut ious: Vec<f64> = good.iter().filter_map(|&one| candidates[one].iou).collect();
    let median = upper_median(&mut ious).unwrap_or(0.0);
    let count = good.len();
    good.retain(|&one| candidates[one].iou.is_none_or(|iou| iou >= median - POOR));
    choice.poor = count - good.len();
    let joints = |&one: &usize| Kinematics::new(model, &candidates[one].pose);
    let all: Vec<Kinematics> = good.iter().map(joints).collect();
    let run = larger_part(model, &all);
    choice.turned = good.len() - run.len();
    let about_root = |&index: &usize| -> Vec<DVec3> {
        let root = candidates[good[index]].pose.root;
        all[index].ends().iter().map(|end| *end - root).collect()
    };
    let places: Vec<Vec<DVec3>> = run.iter().map(about_root).collect();
    let run: Vec<usize> = run.into_iter().map(|index| good[index]).collect();
    let seen = |index: usize| candidates[run[index]].iou.unwrap_or(0.0);
    // Of equals the first.
    let best = (0..run.len()).reduce(|best, one| if seen(one) > seen(best) { one } else { best });
    let Some(mut next) = best else { return choice };
    let apart = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).sum::<f64>();
    let mut nearest = vec![f64::INFINITY; run.len()];
    for order in 0..(fitted + held_out).min(run.len()) {
        let is_held_out = order % 3 == 2 && choice.held_out.len() < held_out;
        let is_held_out = is_held_out || choice.fitted.len() == fitted;
        let chosen = if is_held_out { &mut choice.held_out } else { &mut choice.fitted };
        chosen.push(run[next]);
        for (nearest, place) in nearest.iter_mut().zip(&places) {
            *nearest = nearest.min(apart(place, &places[next]));
        }
        nearest[next] = f64::NEG_INFINITY;
        next = (0..run.len())
            .reduce(|far, one| if nearest[one] > nearest[far] { one } else { far })
            .unwrap_or(next);
    }
    choice.fitted.sort_unstable();
    choice.held_out.sort_unstable();
    choice
}

/// The larger of the two parts into which jumps of the direction that the body faces divide the frames: each jump leads
/// from one part to the other.
fn larger_part(model: &Model, all: &[Kinematics]) -> Vec<usize> {
    let mut parts = [Vec::new(), Vec::new()];
    let (mut part, mut last) = (0, None::<DVec3>);
    for (index, kinematics) in all.iter().enumerate() {
        let faces = Sides::of(model, kinematics).map(|sides| sides.ahead);
        if last.zip(faces).is_some_and(|(before, faces)| before.dot(faces) < TURNED) {
            part = 1 - part;
        }
        parts[part].push(index);
        last = faces.or(last);
    }
    let [first, second] = parts;
    if second.len() > first.len() { second } else { first }
}

/// `count` of these frames, evenly spread with the first and the last among them; all, if there are no more.
pub fn spread(frames: &[usize], count: usize) -> Vec<usize> {
    let last = frames.len().saturating_sub(1);
    if count > last {
        return frames.to_vec();
    }
    let between = count.saturating_sub(1).max(1);
    (0..count).map(|k| frames[(k * last + between / 2) / between]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::fixtures;
    use crate::posing::turn_round;
    use glam::{DQuat, DVec3};

    /// An arm that rises frame by frame, a body that walks.
    fn arm_rises(count: usize) -> (Model, Vec<PosedFrame>) {
        let model = builtin::full_body();
        let posed = |frame: usize| {
            let raised = DQuat::from_rotation_x(2.0 * frame as f64 / count as f64);
            let root = DVec3::new(0.5 * frame as f64, 0.0, 0.0);
            let pose = fixtures::posed(&model, root, &[("right upper arm", raised)]);
            PosedFrame { frame, pose, iou: Some(0.9), is_lost: false }
        };
        let frames = (0..count).map(posed).collect();
        (model, frames)
    }

    #[test]
    fn chosen_frames_are_far_from_one_another_and_some_are_held_out() {
        let (model, mut frames) = arm_rises(40);
        // Nearly all of them show one pose.
        for frame in 0..30 {
            frames[frame].pose.rotations = frames[0].pose.rotations.clone();
        }
        let choice = choose(&model, &frames, 4, 2);
        assert_eq!((choice.fitted.len(), choice.held_out.len()), (4, 2));
        let still = choice.fitted.iter().chain(&choice.held_out).filter(|&&one| one < 30).count();
        assert_eq!(still, 1, "{choice:?}");
        assert!(choice.fitted.contains(&39) || choice.held_out.contains(&39));
        assert_eq!(choose(&model, &frames[..2], 4, 2).fitted, [0, 1]);
        assert_eq!(choose(&model, &[], 4, 2), Choice::default());
    }

    #[test]
    fn lost_poor_and_turned_frames_are_left_out() {
        let (model, mut frames) = arm_rises(20);
        frames[3].is_lost = true;
        frames[7].iou = Some(0.7);
        for frame in [10, 11, 15] {
            frames[frame].pose = turn_round(&model, &frames[frame].pose);
        }
        let choice = choose(&model, &frames, 12, 6);
        assert_eq!((choice.lost, choice.poor, choice.turned), (1, 1, 3));
        let mut all = [choice.fitted.clone(), choice.held_out.clone()].concat();
        all.sort_unstable();
        let expected: Vec<usize> = (0..20).filter(|one| ![3, 7, 10, 11, 15].contains(one)).collect();
        assert_eq!(all, expected);
    }

    #[test]
    fn the_first_and_the_last_are_among_them() {
        let frames: Vec<usize> = (10..70).collect();
        assert_eq!(spread(&frames, 4), [10, 30, 49, 69]);
        assert_eq!(spread(&frames, 1), [10]);
        assert_eq!(spread(&frames[..3], 8), [10, 11, 12]);
        assert!(spread(&[], 3).is_empty());
    }
}
