//! How far a tracked pose is believed: what held its limbs, how likely each is wrong, which poses rival it.

use std::cmp::Reverse;

use backlit_tracking::belief::{LimbTrust, Verdict, deviation_m};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cues::LimbHold;
use backlit_tracking::track::Mode;

use crate::Document;

/// Two poses whose rotations differ by less are the same, radians and metres.
const SAME: f64 = 1e-6;

/// Whether two poses are the same but for rounding: a pose that is set is normalised.
pub fn are_same(a: &Pose, b: &Pose) -> bool {
    a.root.distance(b.root) < SAME && a.local(b).iter().all(|value| value.abs() < SAME)
}

/// What the tracker says of a pose that it found.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTrust {
    pub(crate) pose: Pose,
    /// By limb; empty where nobody judged them.
    pub(crate) limbs: Vec<LimbTrust>,
    /// Those that are doubtful or wrong and have a rotation of their own, the wrong ones first.
    doubts: Vec<LimbTrust>,
    /// What held the limbs, part by part; empty where it was not tracked with cues.
    pub holds: Vec<LimbHold>,
    /// Poses that were carried beside it, likeliest first.
    pub rivals: Vec<Mode>,
}

impl FrameTrust {
    /// How far each limb of this pose of a body is believed (empty where nobody judged them), what held them, and what rivals it.
    pub fn new(
        model: &Model,
        pose: Pose,
        limbs: Vec<LimbTrust>,
        holds: Vec<LimbHold>,
        rivals: Vec<Mode>,
    ) -> Self {
        let has_own = |limb: usize| model.limbs().get(limb).is_some_and(|limb| limb.has_own_rotation);
        let is_doubt = |limb: &&LimbTrust| limb.verdict > Verdict::Good && has_own(limb.limb);
        let mut doubts: Vec<LimbTrust> = limbs.iter().filter(is_doubt).copied().collect();
        doubts.sort_by_key(|doubt| Reverse(doubt.verdict));
        Self { pose, limbs, doubts, holds, rivals }
    }

    /// The limbs that are doubtful or wrong and have a rotation of their own.
    pub fn doubts(&self) -> &[LimbTrust] {
        &self.doubts
    }

    /// How many limbs are wrong in the mean of such frames: the sum of P(wrong) of those that are not believed.
    pub fn expected_wrong(&self) -> f64 {
        self.doubts.iter().map(|doubt| doubt.wrong).sum()
    }

    /// How far silhouettes leave the end of a limb to move in a rival pose, metres; `None` where that is not known.
    pub fn deviation_m(&self, rival: &Pose, limb: usize) -> Option<f64> {
        let mode = self.rivals.iter().find(|mode| are_same(&mode.pose, rival))?;
        mode.covariances.get(limb).map(deviation_m)
    }

    /// The tracked pose and its rivals with their weights; empty where there are none.
    fn modes(&self) -> impl Iterator<Item = (&Pose, f64)> {
        let rivals: f64 = self.rivals.iter().map(|rival| rival.weight).sum();
        let tracked = (!self.rivals.is_empty()).then_some((&self.pose, 1.0 - rivals));
        tracked.into_iter().chain(self.rivals.iter().map(|rival| (&rival.pose, rival.weight)))
    }
}

impl Document {
    /// What the tracker says of this pose of a frame; nothing of one that was set by hand.
    pub fn trust_of(&self, frame: usize, pose: &Pose) -> Option<&FrameTrust> {
        let trust = self.trust.get(&frame).filter(|trust| trust.pose == *pose)?;
        (self.keys.get(&frame) != Some(pose)).then_some(trust)
    }

    /// The tracked frames in which a limb is not believed.
    pub fn doubted(&self) -> impl Iterator<Item = (usize, &FrameTrust)> {
        let doubted = self.trust.iter().filter(|(_, trust)| !trust.doubts.is_empty());
        doubted
            .filter_map(|(&frame, _)| Some((frame, self.trust_of(frame, &self.estimates.get(&frame)?.pose)?)))
    }

    /// The poses that a frame allowed as it was tracked, if this one is one of them.
    pub fn modes(&self, frame: usize, pose: &Pose) -> Vec<(&Pose, f64)> {
        let modes: Vec<_> = self.trust.get(&frame).into_iter().flat_map(|trust| trust.modes()).collect();
        if modes.iter().any(|(mode, _)| are_same(mode, pose)) { modes } else { Vec::new() }
    }
}
