//! Pieces of a surface that spheres cover: each lies wholly within one sphere of a level. At the finest level a piece is a small
//! triangle, which lies within a sphere if its corners do; above, it is all that a child's sphere touches.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::ClosedMesh;
use crate::surface::distance_to_triangle;

/// Small triangles of a surface.
#[derive(Debug, Clone)]
pub(crate) struct Patches {
    pub(crate) points: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Triangle of the mesh that each was cut from.
    pub(crate) origins: Vec<u32>,
}

impl Patches {
    /// About `count` triangles of like size, and no fewer than the mesh has.
    pub(crate) fn new(mesh: &ClosedMesh, count: usize) -> Self {
        let longest_squared = |corners: [DVec3; 3]| {
            let [a, b, c] = corners;
            a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a))
        };
        let total: f64 =
            (0..mesh.triangles().len()).map(|triangle| longest_squared(mesh.corners(triangle))).sum();
        let most_squared = 2.0 * total / count as f64;
        let mut patches =
            Self { points: mesh.vertices().to_vec(), triangles: Vec::new(), origins: Vec::new() };
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut stack = Vec::new();
        for (origin, &triangle) in mesh.triangles().iter().enumerate() {
            stack.push(triangle);
            while let Some(triangle) = stack.pop() {
                let corners = triangle.map(|point| patches.points[point as usize]);
                if longest_squared(corners) <= most_squared {
                    patches.triangles.push(triangle);
                    patches.origins.push(origin as u32);
                    continue;
                }
                let length = |i: usize| corners[i].distance_squared(corners[(i + 1) % 3]);
                let edge = (1..3).fold(0, |best, i| if length(i) > length(best) { i } else { best });
                let [a, b, c] = [triangle[edge], triangle[(edge + 1) % 3], triangle[(edge + 2) % 3]];
                let middle = *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    let middle = patches.points[a as usize].midpoint(patches.points[b as usize]);
                    patches.points.push(middle);
                    patches.points.len() as u32 - 1
                });
                stack.extend([[middle, b, c], [a, middle, c]]);
            }
        }
        patches
    }

    pub(crate) fn corners(&self, patch: usize) -> [DVec3; 3] {
        self.triangles[patch].map(|point| self.points[point as usize])
    }

    pub(crate) fn middle(&self, patch: usize) -> DVec3 {
        self.corners(patch).into_iter().sum::<DVec3>() / 3.0
    }

    pub(crate) fn area(&self, patch: usize) -> f64 {
        let [a, b, c] = self.corners(patch);
        0.5 * (b - a).cross(c - a).length()
    }
}

/// Groups of points that are covered as one each.
#[derive(Debug)]
pub(crate) struct Pieces<'a> {
    pub(crate) points: &'a [DVec3],
    /// Points of a piece, ascending.
    pub(crate) corners: Vec<Vec<u32>>,
    /// Where a piece lies, and how far its points are from there at most.
    pub(crate) bounds: Vec<(DVec3, f64)>,
}

impl<'a> Pieces<'a> {
    fn new(points: &'a [DVec3], corners: Vec<Vec<u32>>) -> Self {
        let bounds = corners.iter().map(|corners| {
            let place = |&point: &u32| points[point as usize];
            let middle = corners.iter().map(place).sum::<DVec3>() / corners.len() as f64;
            (middle, corners.iter().map(|point| place(point).distance(middle)).fold(0.0, f64::max))
        });
        let bounds = bounds.collect();
        Self { points, corners, bounds }
    }

    /// Every patch by itself.
    pub(crate) fn of_patches(patches: &'a Patches) -> Self {
        let corners = patches.triangles.iter().map(|triangle| {
            let mut corners = triangle.to_vec();
            corners.sort_unstable();
            corners
        });
        Self::new(&patches.points, corners.collect())
    }

    /// What each sphere (centre, radius) touches, whole patches.
    pub(crate) fn touched(patches: &'a Patches, spheres: &[(DVec3, f64)]) -> Self {
        let reach: Vec<(DVec3, f64)> = (0..patches.triangles.len())
            .map(|patch| {
                let middle = patches.middle(patch);
                let corners = patches.corners(patch);
                (middle, corners.into_iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max))
            })
            .collect();
        let touched = |&(centre, radius): &(DVec3, f64)| {
            let mut corners = Vec::new();
            for (patch, (middle, reach)) in reach.iter().enumerate() {
                let distance = middle.distance(centre);
                let is_touched = distance <= radius
                    || (distance <= radius + reach
                        && distance_to_triangle(patches.corners(patch), centre) <= radius);
                if is_touched {
                    corners.extend(patches.triangles[patch]);
                }
            }
            corners.sort_unstable();
            corners.dedup();
            corners
        };
        Self::new(&patches.points, spheres.par_iter().map(touched).collect())
    }

    /// How far the points of a piece are from a place at most.
    pub(crate) fn reach(&self, piece: u32, place: DVec3) -> f64 {
        let distances = self.corners[piece as usize].iter();
        distances.map(|&point| self.points[point as usize].distance_squared(place)).fold(0.0, f64::max).sqrt()
    }

    /// No more than [`reach`](Self::reach).
    pub(crate) fn least_reach(&self, piece: u32, place: DVec3) -> f64 {
        let (middle, extent) = self.bounds[piece as usize];
        middle.distance(place).max(extent - middle.distance(place))
    }

    /// All points of some pieces, ascending.
    pub(crate) fn points_of(&self, pieces: &[u32]) -> Vec<u32> {
        let mut points: Vec<u32> =
            pieces.iter().flat_map(|&piece| self.corners[piece as usize].iter().copied()).collect();
        points.sort_unstable();
        points.dedup();
        points
    }
}
