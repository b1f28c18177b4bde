//! Limb after limb, of the pixels that no template holds yet.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::frame::{Frame, Segment};
use super::options::TemplateOptions;
use super::pictures::{Held, Pictures, Template};
use super::steps::{Record, TemplateStep};
use crate::body::{Kinematics, Pose};
use crate::geometry::rotation::exp;
use crate::residual::pose_prior;

/// What a pixel in another template is worth beside one of the subject's that is free; background is worth −1.
const CLAIMED: f64 = 0.1;
/// Twists that are tried of a limb, so that the joint after it bends as it can.
const TWISTS: usize = 24;

/// Puts all chains but the head's on a trunk. `drawn` says which limbs are placed already.
pub(super) fn placed(
    frame: &Frame<'_>,
    pictures: &mut Pictures,
    options: &TemplateOptions,
    trunk: &Pose,
    mut drawn: Vec<bool>,
    record: &mut Record,
) -> Pose {
    let mut pose = trunk.clone();
    for &chain in &frame.limbs {
        let segments = frame.segments(chain);
        for segment in &segments {
            if segment.is_wide {
                begin(frame, pictures, options, &mut pose, segment);
            }
            for &limb in &frame.parts.groups[segment.rotation] {
                drawn[limb] = true;
            }
            if segment.is_wide {
                turn_until_it_rests(frame, pictures, options, &mut pose, segment, &drawn, record);
            }
            pictures.claim(&frame.template(&pose, segment));
        }
        for two in segments.windows(2) {
            untwist(frame, &mut pose, [&two[0], &two[1]]);
        }
    }
    pose
}

/// The direction in which a limb holds most of the subject and least background.
fn begin(
    frame: &Frame<'_>,
    pictures: &Pictures,
    options: &TemplateOptions,
    pose: &mut Pose,
    segment: &Segment,
) {
    let rest = frame.template(pose, segment);
    let (from, length) = (rest.from, segment.rest.length());
    let along = (rest.to - from).normalize_or(DVec3::X);
    let worth = |direction: DVec3| {
        let held = pictures.held(&Template { to: from + direction * length, ..rest });
        worth(&held)
    };
    let mut best = (worth(along), along);
    for direction in sphere(options.directions) {
        let value = worth(direction);
        if value > best.0 {
            best = (value, direction);
        }
    }
    frame.point(pose, segment, best.1);
}

fn worth(held: &Held) -> f64 {
    held.subject + CLAIMED * held.claimed - held.background
}

/// Turns a limb to the centroid of its pixels, and again.
fn turn_until_it_rests(
    frame: &Frame<'_>,
    pictures: &Pictures,
    options: &TemplateOptions,
    pose: &mut Pose,
    segment: &Segment,
    drawn: &[bool],
    record: &mut Record,
) {
    let name = &frame.model.limbs()[segment.first].name;
    for turn in 1..=options.turns {
        let template = frame.template(pose, segment);
        let held = pictures.held(&template);
        let (before, after) =
            (template.to - template.from, held.towards.map_or(DVec3::ZERO, |to| to - template.from));
        let by = before.angle_between(after);
        let rests = !(by >= options.rest_rad && by.is_finite()) || turn == options.turns;
        let ends = [template.from, template.to];
        let step = TemplateStep::of(name, pose.clone(), drawn.to_vec(), ends, template.radius);
        record.push(TemplateStep { held: held.subject, turned_rad: by, rests, ..step });
        if rests {
            break;
        }
        frame.point(pose, segment, after);
    }
}

/// Twists a limb about itself so that the next one, which stays where it is, is bent as its limits let it. A body without limits
/// stays as it is.
fn untwist(frame: &Frame<'_>, pose: &mut Pose, [upper, lower]: [&Segment; 2]) {
    let limb = |segment: &Segment| &frame.model.limbs()[frame.model.rotation_owners()[segment.rotation]];
    if limb(lower).limits.is_none() {
        return;
    }
    let kinematics = Kinematics::new(frame.model, pose);
    let along = kinematics.ends()[lower.last] - kinematics.starts()[lower.first];
    let turned = |twist: f64| {
        let mut pose = pose.clone();
        pose.rotations[upper.rotation] *= exp(limb(upper).direction * twist);
        frame.point(&mut pose, lower, along);
        (pose_prior::limit_cost(frame.model, &pose, 1.0), pose)
    };
    // From none to half a turn, either way: the first of equals twists least.
    let twists = (0..=TWISTS)
        .map(|k| PI * k.div_ceil(2) as f64 / (TWISTS / 2) as f64 * if k % 2 == 0 { 1.0 } else { -1.0 });
    let best = twists.map(turned).min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, best)) = best {
        *pose = best;
    }
}

/// Directions evenly over the sphere (a Fibonacci lattice).
fn sphere(count: usize) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |k| {
        let height = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let (sine, cosine) = (TAU * 0.618_033_988_749_895 * k as f64).sin_cos();
        let radius = (1.0 - height * height).sqrt();
        DVec3::new(radius * cosine, radius * sine, height)
    })
}
