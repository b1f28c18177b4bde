//! New places for one chain while the rest of the body is held: which way could this arm be?
//!
//! Rotations of the chain are set one after the other, from the trunk outwards. The two longest search the
//! whole sphere of directions, the others a cone about rest; joint limits leave out what no body can do. A
//! beam keeps the best partial chains by the sketch's cost.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::SearchOptions;
use super::chains::Chains;
use super::sketch::{Canvas, LimbPositions, Sketch};
use crate::body::{Model, Pose};
use crate::geometry::rotation::{exp, log};

/// Opening of the cone about rest in which a chain's short rotations search, radians.
const CONE: f64 = 0.45;
/// Directions on that cone.
const CONE_DIRECTIONS: usize = 5;
/// Twists tried of a limb whose child is a hinge, radians.
const TWISTS: [f64; 3] = [-0.9, 0.0, 0.9];
/// How much of what a limb covers counts before its chain is whole: the rest of the chain may cover it too.
const EARLY_GAIN: f32 = 0.5;
/// Angles may lie this far outside their limits, radians.
const SLACK: f64 = 0.2;
/// Candidates whose limbs all end within this of each other are one, metres.
const SAME_M: f64 = 0.10;
/// Pull of every rotation towards the start, per rad², in fully wrong coarse pixels.
const PULL: f32 = 0.2;

struct PartialChain {
    pose: Pose,
    skeleton: LimbPositions,
    canvas: Canvas,
    cost: f32,
}

/// A body in front of its coarse pictures.
#[derive(Debug)]
pub(super) struct Reseeder<'a> {
    pub(super) model: &'a Model,
    pub(super) parts: Chains,
    pub(super) sketch: Sketch,
    /// Where the fit began.
    pub(super) reference: &'a Pose,
    pub(super) effort: &'a SearchOptions,
}

/// A candidate place of one rotation.
struct RatedTurn {
    /// What it is ranked by, and what it costs.
    ranked: f32,
    cost: f32,
    /// Index of the partial chain that it goes on from.
    partial: usize,
    turn: DQuat,
    /// Where its last limb ends.
    end: DVec3,
}

impl Reseeder<'_> {
    /// Name of a chain's first limb.
    pub(super) fn name(&self, chain: usize) -> String {
        let first = self.parts.chains[chain][0];
        self.model.limbs()[self.model.rotation_owners()[first]].name.clone()
    }

    /// Sketch cost of a pose's trunk alone.
    pub(super) fn trunk_cost(&self, pose: &Pose) -> f32 {
        let all: Vec<usize> = (0..self.parts.chains.len()).collect();
        self.sketch.cost(&self.drawn(pose, &all).1)
    }

    fn drawn(&self, pose: &Pose, absent: &[usize]) -> (LimbPositions, Canvas) {
        let skeleton = LimbPositions::new(self.model, pose);
        let mut canvas = self.sketch.blank();
        for (rotation, group) in self.parts.groups.iter().enumerate() {
            if absent.iter().any(|&chain| self.parts.chains[chain].contains(&rotation)) {
                continue;
            }
            for &limb in group {
                self.sketch.draw(&mut canvas, &skeleton, limb);
            }
        }
        (skeleton, canvas)
    }

    /// All chains put again on a pose's trunk, one after the other, the shortest (a head) first.
    pub(super) fn assemble(&self, trunk: &Pose) -> Pose {
        let mut order: Vec<usize> = (0..self.parts.chains.len()).collect();
        order.sort_by_key(|&chain| self.parts.chains[chain].len());
        let mut pose = trunk.clone();
        for (index, &chain) in order.iter().enumerate() {
            if let Some((_, best)) = self.propose(&pose, chain, &order[index + 1..]).into_iter().next() {
                pose = best;
            }
        }
        pose
    }

    /// The best places of a chain by their sketch costs, best first; other chains in `absent` are not drawn.
    pub(super) fn propose(&self, base: &Pose, chain: usize, absent: &[usize]) -> Vec<(f32, Pose)> {
        let mut without: Vec<usize> = absent.to_vec();
        without.push(chain);
        let (skeleton, canvas) = self.drawn(base, &without);
        let cost = self.sketch.cost(&canvas);
        let mut beam = vec![PartialChain { pose: base.clone(), skeleton, canvas, cost }];
        let chain = &self.parts.chains[chain];
        let wide = self.wide_rotations(chain);
        for &rotation in chain {
            let is_last = Some(&rotation) == chain.last();
            let turns = self.turns(base, rotation, wide.contains(&rotation));
            let mut candidates = Vec::with_capacity(beam.len() * turns.len());
            for (index, partial) in beam.iter_mut().enumerate() {
                let is_wide = wide.contains(&rotation);
                self.rate(index, partial, rotation, &turns, is_wide, is_last, &mut candidates);
            }
            candidates.sort_by(|a, b| a.ranked.total_cmp(&b.ranked));
            beam = self.pick(&beam, &candidates, rotation, is_last);
        }
        beam.into_iter().map(|partial| (partial.cost, partial.pose)).collect()
    }

    /// Rates the turns of a rotation on one partial chain.
    #[expect(clippy::too_many_arguments, reason = "the inner loop of a proposal, kept apart to be read")]
    fn rate(
        &self,
        index: usize,
        partial: &mut PartialChain,
        rotation: usize,
        turns: &[DQuat],
        is_wide: bool,
        is_last: bool,
        candidates: &mut Vec<RatedTurn>,
    ) {
        let group = &self.parts.groups[rotation];
        let (kept, root) = (partial.pose.rotations[rotation], partial.pose.root);
        let gain = if is_last { 1.0 } else { EARLY_GAIN };
        let back = self.reference.rotations[rotation].inverse();
        for turn in self.sifted(turns, partial, rotation, is_wide) {
            partial.skeleton.set(self.model, group, rotation, turn, root);
            let pull = PULL * log(turn * back).length_squared() as f32;
            let (mut cost, mut ranked) = (partial.cost + pull, partial.cost + pull);
            for &limb in group {
                let change = self.sketch.change(&partial.canvas, &partial.skeleton, limb);
                cost += change.spill + change.gain;
                ranked += change.spill + gain * change.gain;
            }
            let end = group.last().map_or(root, |&limb| partial.skeleton.ends[limb]);
            candidates.push(RatedTurn { ranked, cost, partial: index, turn, end });
        }
        partial.skeleton.set(self.model, group, rotation, kept, root);
    }

    /// The best candidates as partial chains; the last rotation's differ.
    fn pick(
        &self,
        beam: &[PartialChain],
        candidates: &[RatedTurn],
        rotation: usize,
        is_last: bool,
    ) -> Vec<PartialChain> {
        let group = &self.parts.groups[rotation];
        let width = if is_last { self.effort.proposals } else { self.effort.beam };
        let mut picked: Vec<(PartialChain, DVec3)> = Vec::with_capacity(width);
        for candidate in candidates {
            if picked.len() == width {
                break;
            }
            let parent = &beam[candidate.partial];
            let is_same = |(partial, end): &(PartialChain, DVec3)| {
                let starts = |skeleton: &LimbPositions| group.first().map(|&limb| skeleton.starts[limb]);
                let apart = starts(&partial.skeleton).zip(starts(&parent.skeleton));
                end.distance(candidate.end) < SAME_M && apart.is_none_or(|(a, b)| a.distance(b) < SAME_M)
            };
            if is_last && picked.iter().any(is_same) {
                continue;
            }
            let mut pose = parent.pose.clone();
            pose.rotations[rotation] = candidate.turn;
            let mut skeleton = parent.skeleton.clone();
            skeleton.set(self.model, group, rotation, candidate.turn, pose.root);
            let mut canvas = Canvas::new();
            if !is_last {
                canvas.clone_from(&parent.canvas);
                for &limb in group {
                    self.sketch.draw(&mut canvas, &skeleton, limb);
                }
            }
            picked.push((PartialChain { pose, skeleton, canvas, cost: candidate.cost }, candidate.end));
        }
        picked.into_iter().map(|(partial, _)| partial).collect()
    }

    /// The turns whose limbs lie best in the silhouettes, by a few points of each.
    fn sifted(&self, turns: &[DQuat], partial: &mut PartialChain, rotation: usize, wide: bool) -> Vec<DQuat> {
        if !wide {
            return turns.to_vec();
        }
        let group = &self.parts.groups[rotation];
        let mut scored: Vec<(f32, DQuat)> = Vec::with_capacity(turns.len());
        for &turn in turns {
            partial.skeleton.set(self.model, group, rotation, turn, partial.pose.root);
            let misses = group.iter().map(|&limb| self.sketch.misses(&partial.skeleton, limb)).sum();
            scored.push((misses, turn));
        }
        let keep = ((turns.len() as f64 * self.effort.sieve) as usize).max(1);
        scored.sort_by(|a, b| a.0.total_cmp(&b.0));
        scored.truncate(keep);
        scored.into_iter().map(|(_, turn)| turn).collect()
    }

    /// The two rotations of a chain with the longest limbs.
    fn wide_rotations(&self, chain: &[usize]) -> Vec<usize> {
        let length = |&rotation: &usize| -> f64 {
            self.parts.groups[rotation].iter().map(|&limb| self.model.limbs()[limb].length).sum()
        };
        let mut by_length = chain.to_vec();
        by_length.sort_by(|a, b| length(b).total_cmp(&length(a)));
        by_length.truncate(2);
        by_length
    }

    /// Turns to try of a rotation.
    fn turns(&self, base: &Pose, rotation: usize, wide: bool) -> Vec<DQuat> {
        let limb = &self.model.limbs()[self.model.rotation_owners()[rotation]];
        let v = limb.direction;
        let mut turns = vec![base.rotations[rotation], DQuat::IDENTITY, self.reference.rotations[rotation]];
        let (across, other) = v.any_orthonormal_pair();
        if wide {
            // A Fibonacci sphere with its pole along the limb at rest.
            let golden = TAU * 0.618_033_988_749_895;
            let count = self.effort.directions;
            for k in 0..count {
                let height = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
                let (sin, cos) = (golden * k as f64).sin_cos();
                let radius = (1.0 - height * height).sqrt();
                let direction = v * height + (across * cos + other * sin) * radius;
                turns.push(DQuat::from_rotation_arc(v, direction));
            }
        } else {
            turns.extend((0..CONE_DIRECTIONS).map(|k| {
                let (sin, cos) = (TAU * k as f64 / CONE_DIRECTIONS as f64).sin_cos();
                exp((across * cos + other * sin) * CONE)
            }));
        }
        let has_hinge_child = self.model.rotation_parents().iter().enumerate().any(|(child, &parent)| {
            parent == Some(rotation)
                && self.model.limbs()[self.model.rotation_owners()[child]].limits.is_some()
        });
        if has_hinge_child && wide {
            turns = turns.iter().flat_map(|&q| TWISTS.map(|twist| q * exp(v * twist))).collect();
        }
        if let Some(limits) = limb.limits {
            let allowed = |q: &DQuat| {
                let angles = limb.angles(*q);
                limits.flexion.excess(angles.flexion).abs() < SLACK
                    && limits.sideways.excess(angles.sideways).abs() < SLACK
                    && limits.twist.excess(angles.twist).abs() < SLACK
            };
            turns.retain(allowed);
            if turns.is_empty() {
                turns.push(base.rotations[rotation]);
            }
        }
        turns
    }
}
