//! Later frames mend earlier ones: a pose that was found elsewhere is followed back to where the track left it.
//!
//! Where a rival takes the lead, or a search finds a limb again, the frames before are wrong too, from the one on in which the
//! limb was lost. So the new pose is fitted to them, one after the other backwards, until it is where the track was, or the track
//! explains them better by far. Both tracks are then hypotheses of the same frames, and the cheapest path through them is kept
//! (A. Viterbi, "Error bounds for convolutional codes and an asymptotically optimum decoding algorithm", 1967): with e the free
//! energies of both poses in a frame, nats, and d the farthest that a joint moves in the time t between two frames,
//!
//! cost = Σ e + Σ min(½ (d/([`SPEED`] t))², [`JUMP`]).

use super::beam::{free_energy, nat};
use super::estimate::FrameEstimate;
use super::tracker::{Tracker, WhenToSearch};
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{Fit, FitError, FitView, PreparedFit};
use crate::search::farthest_m;

/// Most frames that are gone back.
pub const REWOUND_FRAMES: usize = 240;
/// A joint that moves as fast as this, metres a second, costs half a nat.
const SPEED: f64 = 1.5;
/// No step costs more than this, nats.
const JUMP: f64 = 12.0;
/// A path that is this far behind the track is not followed any farther, nats.
const BEHIND: f64 = 24.0;
/// Both tracks are one where no joint is farther apart than this, metres.
pub(super) const SAME_M: f64 = 0.02;
/// What is found nearer than this to the frame before is no new pose, metres.
const ELSEWHERE_M: f64 = 0.1;

/// A frame with both hypotheses.
#[derive(Debug)]
struct Step {
    track: Pose,
    found: FrameEstimate,
    /// The track's free energy less the found pose's, nats.
    gain: f64,
}

/// A pose found elsewhere, on its way back.
#[derive(Debug)]
pub struct Rewind {
    tracker: Tracker,
    found: (usize, Pose),
    /// The frames so far, the latest first.
    steps: Vec<Step>,
    /// How far the found path is behind the track, nats.
    behind: f64,
    /// Whether the tracks are one again.
    has_joined: bool,
}

impl Rewind {
    /// Begins at a frame, if its pose is elsewhere than in the frame before. `tracker` makes one that could begin there.
    ///
    /// # Errors
    /// There is no such tracker.
    pub fn begin<E>(
        tracker: impl FnOnce(Pose) -> Result<Tracker, E>,
        found: &FrameEstimate,
        before: &Pose,
    ) -> Result<Option<Self>, E> {
        if !found.is_elsewhere || found.is_lost() {
            return Ok(None);
        }
        let tracker = tracker(found.pose.clone())?;
        if farthest_m(&tracker.model, before, &found.pose) < ELSEWHERE_M {
            return Ok(None);
        }
        let tracker = tracker.with_rivals(0).with_search(WhenToSearch::Never).continuing_from(found.frame);
        let found = (found.frame, found.pose.clone());
        Ok(Some(Self { tracker, found, steps: Vec::new(), behind: 0.0, has_joined: false }))
    }

    /// What was found in a frame, if the last step took it up.
    pub fn found_in(&mut self, frame: usize) -> Option<&mut FrameEstimate> {
        self.steps.last_mut().map(|step| &mut step.found).filter(|found| found.frame == frame)
    }

    /// Goes one frame further back, where the track has this pose. Tells whether it is worth to go on.
    ///
    /// # Errors
    /// Data that are not the camera's.
    pub fn step(
        &mut self,
        frame: usize,
        views: Vec<FitView>,
        track: &Pose,
        cancel: &CancelToken,
    ) -> Result<bool, FitError> {
        let found = self.tracker.track_frame(frame, views.clone(), cancel)?;
        if found.is_lost() || cancel.is_cancelled() {
            return Ok(false);
        }
        let Some([of_found, of_track]) = self.tracker.energies(&views, [&found.pose, track]) else {
            return Ok(false);
        };
        self.has_joined = farthest_m(&self.tracker.model, track, &found.pose) < SAME_M;
        if self.has_joined {
            return Ok(false);
        }
        let gain = of_track - of_found;
        // A path that was ahead begins anew: what lies between may be cut.
        self.behind = (self.behind - gain).max(0.0);
        self.steps.push(Step { track: track.clone(), found, gain });
        Ok(self.behind < BEHIND)
    }

    /// The frames in which the found pose is the better one, latest first. `is_whole` says that there is no frame of the track
    /// before the last one.
    #[must_use]
    pub fn finish(self, is_whole: bool) -> Vec<FrameEstimate> {
        let step_cost = |from: (usize, &Pose), to: (usize, &Pose)| {
            let seconds = self.tracker.seconds_between(from.0, to.0);
            step_cost(&self.tracker.model, seconds, from.1, to.1)
        };
        let poses = |step: &Step| [step.track.clone(), step.found.pose.clone()];
        // By hypothesis, track or found: the cost of the cheapest path that ends there, and which one it came from.
        let mut costs = [f64::INFINITY, 0.0];
        let mut before = (self.found.0, [self.found.1.clone(), self.found.1.clone()]);
        let mut came_from = Vec::with_capacity(self.steps.len());
        for step in &self.steps {
            let (frame, here) = (step.found.frame, poses(step));
            let arrive = |to: usize| {
                let by = [0, 1]
                    .map(|from| costs[from] + step_cost((before.0, &before.1[from]), (frame, &here[to])));
                let from = usize::from(by[1] < by[0]);
                (by[from], from)
            };
            let [(track, from_track), (found, from_found)] = [arrive(0), arrive(1)];
            costs = [track + step.gain.max(0.0), found + (-step.gain).max(0.0)];
            came_from.push([from_track, from_found]);
            before = (frame, here);
        }
        // The track goes on before the last frame.
        let leaves = if is_whole || self.has_joined { 0.0 } else { JUMP };
        let mut at = usize::from(costs[1] + leaves < costs[0]);
        let mut mended = Vec::new();
        for (step, from) in self.steps.into_iter().zip(came_from).rev() {
            if at == 1 {
                mended.push(step.found);
            }
            at = from[at];
        }
        mended.reverse();
        mended
    }
}

/// What a step from one pose to another in this time costs, nats.
pub(super) fn step_cost(model: &Model, seconds: f64, from: &Pose, to: &Pose) -> f64 {
    let moved = farthest_m(model, from, to) / (SPEED * seconds.abs());
    (0.5 * moved * moved).min(JUMP)
}

impl Tracker {
    /// Free energies of two poses in a frame, nats; `None` where nothing is seen.
    #[must_use]
    pub fn energies(&self, views: &[FitView], poses: [&Pose; 2]) -> Option<[f64; 2]> {
        let options = self.options.clone().near_at_scale(&self.model, views, poses[0]);
        let prepared =
            PreparedFit::new(&self.model, views.to_vec(), poses[0], &options, |_, _, _| 0.0).ok()?;
        let mut fit = Fit::at_last_stage(self.model.clone(), prepared, options, poses[0]);
        let unit = nat(views, poses[0].root);
        let energies = poses.map(|pose| free_energy(&mut fit, pose, unit).nats);
        energies.iter().all(|energy| energy.is_finite()).then_some(energies)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DQuat, DVec3};

    use super::*;
    use crate::body::builtin;
    use crate::fit::FitOptions;
    use crate::fixtures;
    use crate::metrics::mean_joint_error_mm;
    use crate::track::Motion;

    fn posed(model: &Model, right: f64) -> Pose {
        fixtures::posed(model, DVec3::Z * 0.92, &[("right upper arm", DQuat::from_rotation_y(right))])
    }

    fn begin(model: &Arc<Model>, found: &FrameEstimate, before: &Pose) -> Option<Rewind> {
        let tracker = |pose| {
            let tracker = Tracker::new(model.clone(), FitOptions::default(), pose)?;
            Ok::<_, FitError>(tracker.with_motion(Motion::Velocity, 30.0).unwrap())
        };
        Rewind::begin(tracker, found, before).unwrap()
    }

    fn views(model: &Model, truth: &Pose) -> Vec<FitView> {
        let camera = |x: f64, y: f64| {
            let at = DVec3::new(x, y, 1.1);
            fixtures::camera([180, 260], [320.0, 320.0, 89.5, 129.5], at, DVec3::Z * 0.9, DVec3::Z)
        };
        [camera(-1.2, 2.7), camera(0.7, 2.9)].map(|camera| fixtures::fit_view(model, truth, camera)).to_vec()
    }

    /// Goes back from frame 6 over a track in which the arm was lost from frame `lost_from` on.
    fn mended(lost_from: usize) -> (Arc<Model>, Vec<FrameEstimate>) {
        let model = Arc::new(builtin::full_body());
        let truth = |frame: usize| posed(&model, -0.6 - 0.05 * frame as f64);
        let track = |frame: usize| if frame < lost_from { truth(frame) } else { posed(&model, 0.12) };
        let found = FrameEstimate { is_elsewhere: true, ..FrameEstimate::of_pose(6, truth(6)) };
        let mut rewind = begin(&model, &found, &track(5)).expect("the arm is elsewhere");
        let mut is_whole = true;
        for frame in (0..6).rev() {
            let views = views(&model, &truth(frame));
            if !rewind.step(frame, views, &track(frame), &CancelToken::new()).unwrap() {
                is_whole = false;
                break;
            }
        }
        let mended = rewind.finish(is_whole);
        (model, mended)
    }

    #[test]
    fn frames_since_a_limb_was_lost_are_mended_and_those_before_stay() {
        let (model, frames) = mended(3);
        let numbers: Vec<usize> = frames.iter().map(|one| one.frame).collect();
        assert!(numbers.starts_with(&[5, 4, 3]) && !numbers.contains(&0), "{numbers:?}");
        for one in &frames {
            let truth = posed(&model, -0.6 - 0.05 * one.frame as f64);
            let error = mean_joint_error_mm(&model, &one.pose, &truth);
            assert!(error < 10.0, "frame {}: {error} mm", one.frame);
        }
        let (_, all) = mended(0);
        assert_eq!(all.iter().map(|one| one.frame).collect::<Vec<_>>(), [5, 4, 3, 2, 1, 0]);
    }

    #[test]
    fn a_pose_that_fits_the_frames_before_worse_mends_nothing() {
        let model = Arc::new(builtin::full_body());
        let truth = posed(&model, -0.6);
        let found = FrameEstimate { is_elsewhere: true, ..FrameEstimate::of_pose(6, posed(&model, 0.12)) };
        let mut rewind = begin(&model, &found, &truth).expect("the arm is elsewhere");
        let mut steps = 0;
        while steps < 6 && rewind.step(5 - steps, views(&model, &truth), &truth, &CancelToken::new()).unwrap()
        {
            steps += 1;
        }
        assert!(steps < 6 && rewind.finish(false).is_empty(), "{steps}");
    }

    #[test]
    fn a_pose_that_was_led_to_or_is_near_begins_nothing() {
        let model = Arc::new(builtin::full_body());
        let begins = |is_elsewhere: bool, right: f64| {
            let found = FrameEstimate { is_elsewhere, ..FrameEstimate::of_pose(6, posed(&model, right)) };
            begin(&model, &found, &posed(&model, -0.6)).is_some()
        };
        assert!(begins(true, 0.4) && !begins(false, 0.4) && !begins(true, -0.59));
    }
}
