//! The body's parts as templates.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::pictures::{Silhouettes, Template};
use super::{Record, TemplateOptions, TemplateStep};
use crate::body::{Kinematics, Model, Pose};
use crate::search::{Chains, Stance, turn_whole};

/// The rotations of a chain that are searched: those with the longest limbs.
const WIDE: usize = 2;

/// A body taken apart for its templates.
#[derive(Debug)]
pub(crate) struct TemplateBody<'a> {
    pub(crate) model: &'a Model,
    pub(crate) parts: Chains,
    pub(crate) stance: Stance,
    /// Index of the chain that the head is at the end of.
    pub(crate) head: usize,
    /// The other chains, the one with the most flesh first.
    pub(crate) limbs: Vec<usize>,
}

/// One rotation of a chain as a template.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    pub(crate) rotation: usize,
    /// The limbs between whose ends it lies.
    pub(crate) first: usize,
    pub(crate) last: usize,
    /// From the one end to the other at rest, in the parent's frame.
    pub(crate) rest: DVec3,
    pub(crate) radius: f64,
    /// Whether its direction is looked for.
    pub(crate) is_wide: bool,
}

impl<'a> TemplateBody<'a> {
    /// `None` for a body without a chain on its trunk.
    pub(crate) fn new(model: &'a Model) -> Option<Self> {
        let parts = Chains::new(model);
        let stance = Stance::new(model, &parts);
        let at_rest = Pose::rest(model);
        let up = stance.up_of(model, &at_rest);
        let kinematics = Kinematics::new(model, &at_rest);
        let end = |chain: &[usize]| {
            chain_end(&parts, chain).map_or(f64::NAN, |limb| kinematics.ends()[limb].dot(up))
        };
        let chains = parts.chains.iter().enumerate();
        let head = chains.max_by(|a, b| end(a.1).total_cmp(&end(b.1))).map(|(index, _)| index)?;
        let flesh = |chain: usize| -> f64 {
            let limbs = parts.chains[chain].iter().flat_map(|&rotation| &parts.groups[rotation]);
            limbs.map(|&limb| model.limbs()[limb].length * model.limbs()[limb].radius).sum()
        };
        let mut limbs: Vec<usize> = (0..parts.chains.len()).filter(|&chain| chain != head).collect();
        limbs.sort_by(|&a, &b| flesh(b).total_cmp(&flesh(a)));
        Some(Self { model, stance, head, limbs, parts })
    }

    /// The limb that the head's ball is the end of, and the one that begins at the neck.
    pub(crate) fn skull_and_neck(&self) -> [usize; 2] {
        let chain = &self.parts.chains[self.head];
        let first = self.parts.groups[chain[0]].first().copied().unwrap_or(0);
        [chain_end(&self.parts, chain).unwrap_or(first), first]
    }

    /// Upright along `up` and facing `ahead`, with the neck at a place. The head's chain points from there to the ball.
    pub(crate) fn standing(&self, neck: DVec3, ball: DVec3, up: DVec3, ahead: DVec3) -> Pose {
        let ahead = ahead.reject_from_normalized(up).normalize_or(up.any_orthonormal_vector());
        let mut pose = self.stance.pose(self.model, DVec3::ZERO, up, ahead);
        let [_, first] = self.skull_and_neck();
        pose.root = neck - Kinematics::new(self.model, &pose).starts()[first];
        for segment in self.segments(self.head).iter().take(1) {
            self.point(&mut pose, segment, ball - neck);
        }
        pose
    }

    /// The rotations of a chain as templates, from the trunk outwards.
    pub(crate) fn segments(&self, chain: usize) -> Vec<Segment> {
        let kinematics = Kinematics::new(self.model, &Pose::rest(self.model));
        let rotations = &self.parts.chains[chain];
        let segment = |(index, &rotation): (usize, &usize)| {
            let group = &self.parts.groups[rotation];
            let first = *group.first()?;
            let next = rotations.get(index + 1).and_then(|next| self.parts.groups[*next].first());
            let grown_from = next.and_then(|&limb| self.model.limbs()[limb].parent);
            let last = grown_from.or(group.last().copied())?;
            let radii = group.iter().map(|&limb| self.model.limbs()[limb].radius);
            let radius = radii.sum::<f64>() / group.len() as f64;
            let rest = kinematics.ends()[last] - kinematics.starts()[first];
            Some(Segment { rotation, first, last, rest, radius, is_wide: true })
        };
        let mut segments: Vec<Segment> = rotations.iter().enumerate().filter_map(segment).collect();
        let mut lengths: Vec<f64> = segments.iter().map(|segment| segment.rest.length()).collect();
        lengths.sort_by(|a, b| b.total_cmp(a));
        if let Some(&least) = lengths.get(WIDE - 1) {
            for segment in &mut segments {
                segment.is_wide = segment.rest.length() >= least;
            }
        }
        segments
    }

    /// A posed segment as a template.
    pub(crate) fn template(&self, pose: &Pose, segment: &Segment) -> Template {
        let kinematics = Kinematics::new(self.model, pose);
        let (from, to) = (kinematics.starts()[segment.first], kinematics.ends()[segment.last]);
        Template { from, to, radius: segment.radius }
    }

    /// Turns a segment along a direction in world axes, without twist.
    pub(crate) fn point(&self, pose: &mut Pose, segment: &Segment, along: DVec3) {
        let kinematics = Kinematics::new(self.model, pose);
        let parent = DQuat::from_mat3(&kinematics.parent_frames()[segment.rotation]);
        let local = (parent.inverse() * along).normalize_or_zero();
        let rest = segment.rest.normalize_or_zero();
        if local != DVec3::ZERO && rest != DVec3::ZERO {
            pose.rotations[segment.rotation] = DQuat::from_rotation_arc(rest, local);
        }
    }

    /// The trunk of a posed body as one template, from the neck down to the root; half as thick as the trunk is broad, and as
    /// it is deep, between the two.
    pub(crate) fn trunk_template(&self, pose: &Pose) -> Template {
        let kinematics = Kinematics::new(self.model, pose);
        let [_, first] = self.skull_and_neck();
        let (from, to) = (kinematics.starts()[first], pose.root);
        let axis = (to - from).normalize_or_zero();
        let trunk = self.parts.trunk.iter().flat_map(|&rotation| &self.parts.groups[rotation]);
        let (mut thick, mut broad) = (0.0_f64, 0.0_f64);
        for &limb in trunk {
            let out = |joint: DVec3| (joint - from).reject_from_normalized(axis).length();
            let radius = self.model.limbs()[limb].radius;
            thick = thick.max(radius);
            broad = broad.max(out(kinematics.starts()[limb]).max(out(kinematics.ends()[limb])) + radius);
        }
        Template { from, to, radius: 0.5 * (thick + broad) }
    }

    /// Which limbs are the head's and the trunk's.
    pub(super) fn trunk_limbs(&self) -> Vec<bool> {
        self.limbs_of(&[&self.parts.trunk[..], &self.parts.chains[self.head]].concat())
    }

    /// Which limbs these rotations turn.
    fn limbs_of(&self, rotations: &[usize]) -> Vec<bool> {
        let mut drawn = vec![false; self.model.limbs().len()];
        for &limb in rotations.iter().flat_map(|&rotation| &self.parts.groups[rotation]) {
            drawn[limb] = true;
        }
        drawn
    }

    /// Turns the whole body about a point.
    pub(crate) fn turn_about(&self, pose: &mut Pose, point: DVec3, turn: DQuat) {
        pose.root = point + turn * (pose.root - point);
        turn_whole(self.model, pose, turn);
    }
}

fn chain_end(parts: &Chains, chain: &[usize]) -> Option<usize> {
    chain.last().and_then(|&rotation| parts.groups[rotation].last().copied())
}

/// The template of the trunk at one head, resting.
pub(super) fn hung(
    frame: &TemplateBody<'_>,
    pictures: &Silhouettes,
    options: &TemplateOptions,
    (ball, up, ahead): (DVec3, DVec3, DVec3),
    record: &mut Record,
) -> Pose {
    let model = frame.model;
    let [skull, first] = frame.skull_and_neck();
    let at_rest = Kinematics::new(model, &Pose::rest(model));
    let neck = ball - up * (at_rest.ends()[skull] - at_rest.starts()[first]).length();
    let mut pose = frame.standing(neck, ball, up, ahead);
    let template = frame.trunk_template(&pose);
    record.push(TemplateStep::of(
        "head",
        pose.clone(),
        frame.limbs_of(&frame.parts.chains[frame.head]),
        [ball, ball],
        model.limbs()[skull].radius,
    ));
    let drawn = frame.trunk_limbs();
    for turn in 1..=options.turns {
        let template = Template { radius: template.radius, ..frame.trunk_template(&pose) };
        let held = pictures.held(&template);
        let (before, after) = (template.to - neck, held.towards.map_or(DVec3::ZERO, |to| to - neck));
        let by = before.angle_between(after);
        let rests = !(by >= options.rest_rad && by.is_finite()) || turn == options.turns;
        let ends = [template.from, template.to];
        let step = TemplateStep::of("trunk", pose.clone(), drawn.clone(), ends, template.radius);
        record.push(TemplateStep { held: held.subject + held.claimed, turned_rad: by, rests, ..step });
        if rests {
            break;
        }
        frame.turn_about(&mut pose, neck, DQuat::from_rotation_arc(before.normalize(), after.normalize()));
    }
    // The head stays where its ball is.
    let axis = neck - pose.root;
    frame.standing(neck, ball, axis.normalize_or(up), frame.stance.ahead_of(model, &pose))
}

/// A trunk facing every way about its own axis, as many as there are headings.
pub(super) fn facings(frame: &TemplateBody<'_>, pose: &Pose, ball: DVec3, headings: usize) -> Vec<Pose> {
    let [_, first] = frame.skull_and_neck();
    let neck = Kinematics::new(frame.model, pose).starts()[first];
    let up = frame.stance.up_of(frame.model, pose);
    let ahead = frame.stance.ahead_of(frame.model, pose);
    let facing = |heading: usize| {
        let turn = DQuat::from_axis_angle(up, TAU * heading as f64 / headings as f64);
        frame.standing(neck, ball, up, turn * ahead)
    };
    (0..headings).map(facing).collect()
}
