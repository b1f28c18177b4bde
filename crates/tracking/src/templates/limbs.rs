//! Limb after limb, of the pixels that no template holds yet.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::body::{Segment, TemplateBody};
use super::pictures::{Silhouettes, Template};
use super::{Record, TemplateOptions, TemplateStep};
use crate::body::{Kinematics, Pose};
use crate::geometry::rotation::exp;
use crate::residual::pose_prior;
use crate::search::SubjectPlace;

/// What a pixel in another template is worth beside one of the subject's that is free; background is worth −1.
const CLAIMED: f64 = 0.1;
/// Twists that are tried of a limb, so that the joint after it bends as it can.
const TWISTS: usize = 24;

/// A body whose limbs are put on its trunk.
pub(super) struct Limbs<'a> {
    pub(super) frame: &'a TemplateBody<'a>,
    pub(super) options: &'a TemplateOptions,
    /// With what templates hold already.
    pub(super) pictures: Silhouettes,
    pub(super) pose: Pose,
    /// Per limb, whether it is placed.
    pub(super) drawn: Vec<bool>,
    pub(super) record: Record,
}

impl Limbs<'_> {
    /// Puts all chains but the head's on the trunk.
    pub(super) fn place(&mut self) {
        let frame = self.frame;
        for &chain in &frame.limbs {
            let segments = frame.segments(chain);
            for segment in &segments {
                if segment.is_wide {
                    self.begin(segment);
                }
                for &limb in &frame.parts.groups[segment.rotation] {
                    self.drawn[limb] = true;
                }
                if segment.is_wide {
                    self.turn_until_it_rests(segment);
                }
                self.pictures.claim(&frame.template(&self.pose, segment));
            }
            for two in segments.windows(2) {
                untwist(frame, &mut self.pose, [&two[0], &two[1]]);
            }
        }
    }

    /// The direction in which a limb holds most of the subject and least background.
    fn begin(&mut self, segment: &Segment) {
        let rest = self.frame.template(&self.pose, segment);
        let (from, length) = (rest.from, segment.rest.length());
        let along = (rest.to - from).normalize_or(DVec3::X);
        let worth = |direction: DVec3| {
            let held = self.pictures.held(&Template { to: from + direction * length, ..rest });
            held.subject + CLAIMED * held.claimed - held.background
        };
        let mut best = (worth(along), along);
        for direction in sphere(self.options.directions) {
            let value = worth(direction);
            if value > best.0 {
                best = (value, direction);
            }
        }
        self.frame.point(&mut self.pose, segment, best.1);
    }

    /// Turns a limb to the centroid of its pixels, and again.
    fn turn_until_it_rests(&mut self, segment: &Segment) {
        let name = &self.frame.model.limbs()[segment.first].name;
        for turn in 1..=self.options.turns {
            let template = self.frame.template(&self.pose, segment);
            let held = self.pictures.held(&template);
            let (before, after) =
                (template.to - template.from, held.towards.map_or(DVec3::ZERO, |to| to - template.from));
            let by = before.angle_between(after);
            let rests = !(by >= self.options.rest_rad && by.is_finite()) || turn == self.options.turns;
            let ends = [template.from, template.to];
            let step = TemplateStep::of(name, self.pose.clone(), self.drawn.clone(), ends, template.radius);
            self.record.push(TemplateStep { held: held.subject, turned_rad: by, rests, ..step });
            if rests {
                break;
            }
            self.frame.point(&mut self.pose, segment, after);
        }
    }
}

/// Twists a limb about itself so that the next one, which stays where it is, is bent as its limits let it. A body without limits
/// stays as it is.
fn untwist(frame: &TemplateBody<'_>, pose: &mut Pose, [upper, lower]: [&Segment; 2]) {
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

/// Places along the longest side of what the silhouettes leave of space.
const CELLS: f64 = 48.0;
/// Width of the crust about the ball's outline, in radii and at least this many pixels, to either side.
const CRUST: f64 = 0.12;
const CRUST_PX: f64 = 0.7;
/// Rounds of looking nearer about a place, each with half the step.
const ROUNDS: usize = 4;
/// Heads nearer to each other than this many radii are one.
const APART: f64 = 1.5;

/// A place of the head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeadHypothesis {
    pub(super) centre: DVec3,
    /// Border pixels in its crust, as shares of its outlines' lengths, cameras summed and divided by their number.
    pub(super) held: f64,
}

/// The best places that differ, best first.
pub(super) fn heads(
    pictures: &Silhouettes,
    place: &SubjectPlace,
    radius: f64,
    count: usize,
) -> Vec<HeadHypothesis> {
    let (candidates, step) = candidates(place);
    let inside = candidates.into_iter().filter(|point| pictures.may_be_subject(*point));
    let rate = |centre: DVec3| HeadHypothesis { centre, held: crust(pictures, centre, radius) };
    let mut rated: Vec<HeadHypothesis> = inside.map(rate).collect();
    rated.sort_by(|a, b| b.held.total_cmp(&a.held));
    let mut best: Vec<HeadHypothesis> = Vec::new();
    for head in rated {
        if best.len() == count {
            break;
        }
        if best.iter().all(|other| other.centre.distance(head.centre) > APART * radius) {
            best.push(head);
        }
    }
    for head in &mut best {
        let mut step = 0.5 * step;
        for _ in 0..ROUNDS {
            for axis in DVec3::AXES {
                for by in [-step, step] {
                    let other = rate(head.centre + axis * by);
                    if other.held > head.held {
                        *head = other;
                    }
                }
            }
            step *= 0.5;
        }
    }
    best.sort_by(|a, b| b.held.total_cmp(&a.held));
    best
}

/// Where a head may be, and how far these places lie from one another: a grid in the box about the hull; before one camera
/// the silhouette itself, as far away as the body's height says.
fn candidates(place: &SubjectPlace) -> (Vec<DVec3>, f64) {
    let points = &place.points;
    let (low, high) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| {
        (low.min(*point), high.max(*point))
    });
    let step = (high - low).max_element() / CELLS;
    if place.is_flat || step.is_nan() || step <= 0.0 {
        return (points.to_vec(), step.max(1e-3));
    }
    let counts = ((high - low) / step).ceil().max(DVec3::ONE).to_array().map(|count| count as usize);
    let mut grid = Vec::with_capacity(counts.iter().product());
    for x in 0..counts[0] {
        for y in 0..counts[1] {
            for z in 0..counts[2] {
                grid.push(low + step * (DVec3::new(x as f64, y as f64, z as f64) + 0.5));
            }
        }
    }
    (grid, step)
}

/// Border pixels in the crust about a ball's outlines, as shares of their lengths.
fn crust(pictures: &Silhouettes, centre: DVec3, radius: f64) -> f64 {
    let mut held = 0.0;
    for picture in &pictures.0 {
        let (Some(middle), depth) = (picture.camera.project(centre), picture.camera.depth(centre)) else {
            continue;
        };
        let radius = radius * picture.camera.intrinsics().mean_focal_px() / depth;
        let width = (CRUST * radius).max(CRUST_PX);
        let [inner, outer] = [(radius - width).max(0.0).powi(2), (radius + width).powi(2)];
        let is_held = |pixel: &&glam::DVec2| (inner..outer).contains(&pixel.distance_squared(middle));
        let count = picture.border.iter().filter(is_held).count() as f64;
        held += count / (TAU * radius.max(0.5));
    }
    held / pictures.0.len().max(1) as f64
}
