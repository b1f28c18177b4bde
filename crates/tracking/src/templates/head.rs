//! The head: the ball whose outlines hold most border pixels.

use glam::DVec3;

use super::pictures::Pictures;
use crate::search::Place;

/// Places along the longest side of what the silhouettes leave of space.
const CELLS: f64 = 48.0;
/// Width of the crust about the ball's outline, in radii and at least so many pixels, to either side.
const CRUST: f64 = 0.12;
const CRUST_PX: f64 = 0.7;
/// Rounds of looking nearer about a place, each with half the step.
const ROUNDS: usize = 4;
/// Heads nearer to each other than this many radii are one.
const APART: f64 = 1.5;

/// A place of the head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Head {
    pub(super) centre: DVec3,
    /// Border pixels in its crust, as shares of its outlines' lengths, cameras summed and divided by their number.
    pub(super) held: f64,
}

/// The best places that differ, best first.
pub(super) fn heads(pictures: &Pictures, place: &Place, radius: f64, count: usize) -> Vec<Head> {
    let (candidates, step) = candidates(place);
    let inside = candidates.into_iter().filter(|point| pictures.may_be_subject(*point));
    let rate = |centre: DVec3| Head { centre, held: crust(pictures, centre, radius) };
    let mut rated: Vec<Head> = inside.map(rate).collect();
    rated.sort_by(|a, b| b.held.total_cmp(&a.held));
    let mut best: Vec<Head> = Vec::new();
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
fn candidates(place: &Place) -> (Vec<DVec3>, f64) {
    let points = place.points();
    let (low, high) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| {
        (low.min(*point), high.max(*point))
    });
    let step = (high - low).max_element() / CELLS;
    if place.is_flat() || step.is_nan() || step <= 0.0 {
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
fn crust(pictures: &Pictures, centre: DVec3, radius: f64) -> f64 {
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
        held += count / (std::f64::consts::TAU * radius.max(0.5));
    }
    held / pictures.0.len().max(1) as f64
}
