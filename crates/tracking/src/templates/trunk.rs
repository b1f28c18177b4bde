//! The trunk: hung from the neck, turned until it rests, and the ways that it may face.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::frame::Frame;
use super::options::TemplateOptions;
use super::pictures::Pictures;
use super::steps::{Record, TemplateStep};
use crate::body::{Kinematics, Model, Pose};

/// The template of the trunk at one head, resting.
pub(super) fn hung(
    frame: &Frame<'_>,
    pictures: &Pictures,
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
        head_limbs(frame),
        [ball, ball],
        model.limbs()[skull].radius,
    ));
    let drawn = trunk_limbs(frame);
    for turn in 1..=options.turns {
        let template = super::pictures::Template { radius: template.radius, ..frame.trunk_template(&pose) };
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
pub(super) fn facings(frame: &Frame<'_>, pose: &Pose, ball: DVec3, headings: usize) -> Vec<Pose> {
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

/// Which limbs are the head's.
fn head_limbs(frame: &Frame<'_>) -> Vec<bool> {
    limbs_of(frame.model, frame, &frame.parts.chains[frame.head].rotations)
}

/// Which limbs are the head's and the trunk's.
pub(super) fn trunk_limbs(frame: &Frame<'_>) -> Vec<bool> {
    let rotations = [&frame.parts.trunk[..], &frame.parts.chains[frame.head].rotations].concat();
    limbs_of(frame.model, frame, &rotations)
}

fn limbs_of(model: &Model, frame: &Frame<'_>, rotations: &[usize]) -> Vec<bool> {
    let mut drawn = vec![false; model.limbs().len()];
    for &limb in rotations.iter().flat_map(|&rotation| &frame.parts.groups[rotation]) {
        drawn[limb] = true;
    }
    drawn
}
