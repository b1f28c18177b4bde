//! Hypotheses through time: a track carries rivals of its pose where the silhouettes do not decide.
//!
//! A frame's fit goes downhill, and where a limb was hidden it goes on in the wrong place. So a track keeps a beam. With e the
//! free energy of a pose in a frame, its cost without any pull to another pose, in nats ([`AREA_M2`]), and Sₜ how far a
//! hypothesis is behind the leading one,
//!
//! Sₜ = γ Sₜ₋₁ + (e(rival) − e(leader)).
//!
//! A rival that gets ahead by [`AHEAD`] takes the lead; one that falls behind by [`BEHIND`] is dropped. Rivals come from chains
//! that the silhouettes speak against ([`Conflicts`]), taken off and seeded again, and from poses that silhouettes confuse with
//! one that people seldom take ([`rivals`]). Where nothing speaks against the pose there are no rivals.

use glam::{DMat3, DVec3};

use super::memory::LastFrame;
use super::motion::Motion;
use super::patience::{CONFUSION, Patience, RESEEDING};
use super::tracker::Tracker;
use crate::belief::{self, Conflicts, px_per_metre};
use crate::body::{Kinematics, Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{Fit, FitView};
use crate::optimize::NormalEquations;
use crate::posing;
use crate::render::BACKGROUND;
use crate::residual::learnt_prior::PartEnergy;
use crate::search::{self, Chains, SearchOptions, rivals};

/// Wrong area of all cameras that is worth one nat, square metres: neighbouring pixels err together.
const AREA_M2: f64 = 0.002;
/// γ: what is left of a frame's evidence in the next one. Frames that follow one another err together.
const REMEMBERED: f64 = 0.8;
/// A rival leads once it is this far ahead, nats.
const AHEAD: f64 = 1.0;
/// A rival is dropped once it is this far behind, nats.
const BEHIND: f64 = 12.0;
/// A pose that silhouettes confuse with the leading one explains them before it is fitted; this far behind it does not, nats.
const HOPELESS: f64 = 75.0;
/// What a hypothesis that was just seeded is behind, nats: nothing has led there.
const NEWCOMER: f64 = 2.0;
/// Hypotheses whose joints all lie this near to each other are one, metres.
const SAME_M: f64 = 0.05;
/// How much of what motion files say of a pose counts: frames that follow one another say the same again.
const PRIOR: f64 = 0.5;
/// A part of the body is odd above this energy.
const ODD: f64 = 12.0;
/// Cameras look the same way where their axes are this near to their mean, as a cosine.
const PARALLEL_COSINE: f64 = 0.9;
/// Chains are seeded again where this much speaks against them, square metres a camera.
const TROUBLE_M2: f64 = 0.002;
/// Chains that are seeded again in one frame at most.
const CHAINS: usize = 2;

/// A pose that was carried beside the leading one.
#[derive(Debug, Clone, PartialEq)]
pub struct Rival {
    /// As [`TrackerMemory::last`](super::TrackerMemory::last) is of the leading one.
    pub last: LastFrame,
    /// How far it is behind, nats.
    pub behind: f64,
}

/// What a tracker carries beside its leading hypothesis.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Beam {
    /// Best first.
    pub rivals: Vec<Rival>,
    /// When chains are seeded again.
    pub reseeds: Patience,
    /// When poses that look the same are tried again.
    pub confusions: Patience,
}

/// One of several poses that a frame allows.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// The pose.
    pub pose: Pose,
    /// How likely it is, 0 to 1, among those that were carried.
    pub weight: f64,
    /// By limb, the covariance that the frame leaves to its end in this pose, square metres.
    pub covariances: Vec<DMat3>,
}

/// A hypothesis in the frame at hand.
struct Contender {
    fit: Fit,
    covariances: Vec<DMat3>,
    /// Nats behind the leading one.
    behind: f64,
    /// Where it was in the frame before; `None` for one that was just seeded.
    last: Option<LastFrame>,
}

/// A frame in which hypotheses are compared.
struct Contest<'a> {
    tracker: &'a Tracker,
    leader: &'a Fit,
    /// Squared grey levels of a nat.
    unit: f64,
    /// The leading one's free energy, nats.
    leading: f64,
    contenders: Vec<Contender>,
    cancel: &'a CancelToken,
}

impl Contest<'_> {
    /// Fits a hypothesis that was this far behind, and keeps it if it is no double and not too far behind. Tells how far it is
    /// behind by this frame alone.
    fn enter(&mut self, start: Pose, before: f64, last: Option<LastFrame>) -> Option<f64> {
        let mut fit = self.leader.started_at(start);
        let summary = fit.run(self.cancel, |_| {});
        if summary.is_broken() || self.cancel.is_cancelled() {
            return None;
        }
        let FreeEnergy { nats, equations, .. } = free_energy(&mut fit, &summary.pose, self.unit);
        let here = nats - self.leading;
        let is_same =
            |other: &Fit| search::farthest_m(&self.tracker.model, other.pose(), fit.pose()) < SAME_M;
        let behind = before + here;
        if !behind.is_finite() || behind > BEHIND || is_same(self.leader) {
            return None;
        }
        match self.contenders.iter().position(|other| is_same(&other.fit)) {
            Some(double) if self.contenders[double].behind <= behind => return Some(here),
            Some(double) => drop(self.contenders.remove(double)),
            None => {}
        }
        let covariances = end_covariances(&self.tracker.model, &summary.pose, &equations);
        self.contenders.push(Contender { fit, covariances, behind, last });
        Some(here)
    }
}

impl Tracker {
    /// Follows the rivals into a frame, seeds new ones where silhouettes speak against the leading pose, and decides who leads:
    /// the rival that took the lead, if one did, and the modes beside the pose that now leads.
    pub(super) fn contest(
        &mut self,
        frame: usize,
        leader: &mut Fit,
        conflicts: &Conflicts,
        views: &[FitView],
        cancel: &CancelToken,
    ) -> (Option<Fit>, Vec<Mode>) {
        let pose = leader.pose().clone();
        let chains = troubled_chains(&self.model, conflicts);
        let unit = nat(views, pose.root);
        let FreeEnergy { nats: leading, energies, equations } = free_energy(leader, &pose, unit);
        let seeds = self.beam.reseeds.is_due_fading(!chains.is_empty(), RESEEDING);
        let is_odd = energies.iter().any(|part| part.energy > ODD);
        let confuses = is_odd && self.beam.confusions.is_due(true, CONFUSION);
        let rivals = std::mem::take(&mut self.beam.rivals);
        if rivals.is_empty() && !seeds && !confuses {
            return (None, Vec::new());
        }
        let mut twins = if confuses { confused(&self.model, &pose, views, &energies) } else { Vec::new() };
        twins.retain(|twin| free_energy(leader, twin, unit).nats - leading < HOPELESS);
        let mut contest = Contest { tracker: self, leader, unit, leading, contenders: Vec::new(), cancel };
        for Rival { last, behind } in rivals {
            let start = last.leads_to(self.seconds_between(last.frame, frame));
            contest.enter(start, REMEMBERED * behind, Some(last));
        }
        let mut is_better = false;
        if seeds && !cancel.is_cancelled() {
            let (effort, options) = (seeding(), &leader.options);
            let found = search::reseeded(&self.model, views, &pose, options, &effort, &chains, cancel);
            for hypothesis in found.unwrap_or_default() {
                let behind = contest.enter(hypothesis.pose, NEWCOMER, None);
                is_better |= behind.is_some_and(|behind| behind < -NEWCOMER - AHEAD);
            }
        }
        for start in twins {
            contest.enter(start, NEWCOMER, None);
        }
        let contenders = contest.contenders;
        if is_better {
            self.beam.reseeds = Patience::default();
        }
        let leading = end_covariances(&self.model, &pose, &equations);
        self.settle(frame, pose, leading, contenders)
    }

    /// Ranks the contenders, and carries those that do not lead on. The pose and its ends' covariances are the leading one's.
    fn settle(
        &mut self,
        frame: usize,
        pose: Pose,
        covariances: Vec<DMat3>,
        mut contenders: Vec<Contender>,
    ) -> (Option<Fit>, Vec<Mode>) {
        contenders.sort_by(|a, b| a.behind.total_cmp(&b.behind));
        contenders.truncate(self.most_rivals);
        let carried = |last: Option<&LastFrame>, pose: &Pose, behind: f64| {
            let from = last.filter(|last| last.frame != frame && self.motion != Motion::Still);
            let velocity = from.map(|last| last.velocity_to(pose, self.seconds_between(last.frame, frame)));
            Rival { last: LastFrame { frame, pose: pose.clone(), lost: false, velocity }, behind }
        };
        let takes_over = contenders.first().is_some_and(|first| first.behind < -AHEAD);
        let lead = if takes_over { contenders[0].behind } else { 0.0 };
        let mut others = Vec::with_capacity(contenders.len());
        let mut winner = None;
        if takes_over {
            winner = Some(contenders.remove(0).fit);
            others.push((carried(self.last.as_ref(), &pose, -lead), covariances));
        }
        others.extend(contenders.into_iter().map(|Contender { fit, covariances, behind, last }| {
            (carried(last.as_ref(), fit.pose(), behind - lead), covariances)
        }));
        others.retain(|(rival, _)| rival.behind <= BEHIND);
        others.sort_by(|(a, _), (b, _)| a.behind.total_cmp(&b.behind));
        // The leading one is not behind itself.
        let total = 1.0 + others.iter().map(|(rival, _)| (-rival.behind).exp()).sum::<f64>();
        let mode = |(rival, covariances): &(Rival, Vec<DMat3>)| Mode {
            pose: rival.last.pose.clone(),
            weight: (-rival.behind).exp() / total,
            covariances: covariances.clone(),
        };
        let modes = others.iter().map(mode).collect();
        self.beam.rivals = others.into_iter().map(|(rival, _)| rival).collect();
        (winner, modes)
    }
}

/// What a frame leaves to the ends of a pose's limbs.
fn end_covariances(model: &Model, pose: &Pose, equations: &NormalEquations) -> Vec<DMat3> {
    let ends = belief::end_jacobians(model, &Kinematics::new(model, pose));
    belief::end_covariances(&ends, equations)
}

/// How hard chains are looked for again: less than in a search, since it is done frame after frame.
fn seeding() -> SearchOptions {
    SearchOptions { directions: 60, beam: 16, proposals: 3, ..SearchOptions::default() }
}

/// What a frame says of a pose without any pull to another one.
pub(super) struct FreeEnergy {
    pub(super) nats: f64,
    /// What motion files say of it.
    energies: Vec<PartEnergy>,
    equations: NormalEquations,
}

/// The free energy of a pose in a frame, with `unit` squared grey levels to a nat.
pub(super) fn free_energy(fit: &mut Fit, pose: &Pose, unit: f64) -> FreeEnergy {
    let (equations, energies) = fit.free_equations(pose);
    let energy: f64 = energies.iter().map(|part| part.energy).sum();
    FreeEnergy { nats: equations.cost / unit + 0.5 * PRIOR * energy, energies, equations }
}

/// Poses that silhouettes confuse with this one, of the parts that are odd.
fn confused(model: &Model, pose: &Pose, views: &[FitView], energies: &[PartEnergy]) -> Vec<Pose> {
    let parts = Chains::new(model);
    let energy_of = |chain: usize| {
        let of_chain =
            |part: &&PartEnergy| part.rotations.iter().any(|rotation| parts.chains[chain].contains(rotation));
        energies.iter().filter(of_chain).map(|part| part.energy).fold(0.0, f64::max)
    };
    let pairs = rivals::pairs(model, &parts);
    let mut poses = Vec::new();
    for &pair in &pairs {
        if pair.iter().any(|&chain| energy_of(chain) > ODD) {
            poses.push(rivals::swapped(model, &parts, pose, pair));
        }
    }
    let in_trunk = |part: &&PartEnergy| part.rotations.iter().any(|rotation| parts.trunk.contains(rotation));
    if energies.iter().filter(in_trunk).any(|part| part.energy > ODD) {
        let turned = posing::turn_round(model, pose);
        poses.extend(pairs.iter().map(|&pair| rivals::swapped(model, &parts, &turned, pair)));
        poses.push(turned);
    }
    let aheads = views.iter().filter(|view| view.has_data());
    let aheads: Vec<DVec3> = aheads.map(|view| view.camera.axis_in_world()).collect();
    let mean = aheads.iter().sum::<DVec3>().normalize_or_zero();
    if aheads.iter().all(|ahead| ahead.dot(mean) > PARALLEL_COSINE) {
        let odd = (0..parts.chains.len()).filter(|&chain| energy_of(chain) > ODD);
        for rotations in odd.map(|chain| &parts.chains[chain]) {
            let mut long = rotations.clone();
            let length = |rotation: usize| model.limbs()[model.rotation_owners()[rotation]].length;
            long.sort_by(|a, b| length(*b).total_cmp(&length(*a)));
            long.truncate(2);
            for flips in [&long[..], &long[..1], &long[1..]] {
                poses.push(rivals::flipped(model, rotations, pose, flips, mean));
            }
        }
    }
    poses
}

/// Squared grey levels of a nat at the body's distance.
pub(super) fn nat(views: &[FitView], root: DVec3) -> f64 {
    let squared = |view: &FitView| px_per_metre(&view.camera, root).powi(2);
    let seen = views.iter().filter(|view| view.has_data());
    let (sum, count) = seen.fold((0.0, 0_usize), |(sum, count), view| (sum + squared(view), count + 1));
    AREA_M2 * BACKGROUND * BACKGROUND * sum / count.max(1) as f64
}

/// The chains that silhouettes speak against, the worst first, a few at most. What is missing may be of a chain that hides.
fn troubled_chains(model: &Model, conflicts: &Conflicts) -> Vec<usize> {
    let cameras = conflicts.cameras.max(1) as f64;
    let parts = Chains::new(model);
    let missing = conflicts.missing() / cameras;
    let speaks = |chain: &Vec<usize>| {
        let limbs =
            model.limbs().iter().zip(&conflicts.limbs).filter(|(limb, _)| chain.contains(&limb.rotation));
        let (mut against, mut inner, mut expected) = (0.0, 0.0, 0.0);
        for (limb, conflict) in limbs {
            against += conflict.spurious + conflict.missing;
            inner += conflict.inner;
            expected += limb.length * limb.radius;
        }
        let hidden = (1.0 - inner / (cameras * expected).max(1e-6)).clamp(0.0, 1.0);
        against / cameras + hidden * missing
    };
    let mut chains: Vec<(f64, usize)> = parts.chains.iter().map(speaks).zip(0..).collect();
    chains.retain(|(speaks, _)| *speaks > TROUBLE_M2);
    chains.sort_by(|a, b| b.0.total_cmp(&a.0));
    chains.into_iter().take(CHAINS).map(|(_, chain)| chain).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DQuat;

    use super::*;
    use crate::body::builtin;
    use crate::fit::FitOptions;
    use crate::fixtures;
    use crate::metrics::mean_joint_error_mm;

    /// A track that begins with an arm in the trunk finds it with rivals, and keeps it in the trunk without.
    #[test]
    fn an_arm_in_the_wrong_place_is_found_again() {
        let model = Arc::new(builtin::full_body());
        let posed = |right: f64, frame: usize| {
            let turns = [
                ("right upper arm", DQuat::from_rotation_y(right)),
                ("left upper arm", DQuat::from_rotation_y(0.5 + 0.01 * frame as f64)),
            ];
            fixtures::posed(&model, DVec3::Z * 0.92, &turns)
        };
        let camera = |x: f64, y: f64| {
            let at = DVec3::new(x, y, 1.1);
            fixtures::camera([180, 260], [320.0, 320.0, 89.5, 129.5], at, DVec3::Z * 0.9, DVec3::Z)
        };
        let tracked = |rivals: usize| {
            let start = posed(0.12, 0);
            let tracker = Tracker::new(model.clone(), FitOptions::default(), start).unwrap();
            let mut tracker = tracker.continuing_from(0).with_rivals(rivals).with_trust();
            let estimates: Vec<_> = (1..6)
                .map(|frame| {
                    let truth = posed(-1.3, frame);
                    let cameras = [camera(-1.2, 2.7), camera(0.7, 2.9)];
                    let views = cameras.map(|camera| fixtures::fit_view(&model, &truth, camera)).to_vec();
                    tracker.track_frame(frame, views, &CancelToken::new()).unwrap()
                })
                .collect();
            let last = estimates[estimates.len() - 1].clone();
            (mean_joint_error_mm(&model, &last.pose, &posed(-1.3, 5)), estimates)
        };
        let (with, estimates) = tracked(7);
        let (without, alone) = tracked(0);
        assert!(with < 10.0 && without > 20.0, "{with} mm with rivals, {without} mm without");
        // The leading pose and its rivals share what is likely.
        for estimate in &estimates {
            let rivals: f64 = estimate.modes.iter().map(|mode| mode.weight).sum();
            assert!((0.0..1.0).contains(&rivals), "{rivals}");
        }
        let hand = model.limb_index("right forearm").unwrap();
        assert!(alone[4].trust[hand].wrong > 2.0 * estimates[4].trust[hand].wrong);
        assert!(estimates[4].modes.len() <= 7 && alone.iter().all(|estimate| estimate.modes.is_empty()));
    }
}
