//! Balls of the medial axis, found where they are needed.
//!
//! A medial ball touches the surface at a sample p with normal n and at one more place, and no surface is within it. It is found by
//! shrinking a large ball that touches at p until nothing is within (Ma, Bae and Choi 2012, "3D medial axis point approximation
//! using nearest neighbors and the normal field"), here against the mesh itself, where the Voronoi vertices of Bradshaw and
//! O'Sullivan 2004 know its samples only. The sampling is adaptive as theirs: more samples where balls so far stand out most when
//! they grow to cover the surface.

use glam::DVec3;
use rayon::prelude::*;

use crate::pieces::{Patches, Pieces};
use crate::surface::MeshSurface;

/// Rounds of more samples.
const ROUNDS: usize = 4;

/// Least angle at the centre between the two places that a ball touches; less is the roughness of the mesh. About 30°.
const LEAST_SEPARATION_COSINE: f64 = 0.866;

/// The medial ball (centre, radius) at a place with an outward normal.
fn shrink(surface: &MeshSurface<'_>, place: DVec3, normal: DVec3, largest: f64) -> (DVec3, f64) {
    let mut radius = largest;
    for _ in 0..40 {
        let centre = place - radius * normal;
        let near = surface.nearest(centre);
        let away = place - near.point;
        let length_squared = away.length_squared();
        if near.signed.abs() >= radius * (1.0 - 1e-6) || length_squared <= 1e-12 * radius * radius {
            break;
        }
        let along = away.dot(normal);
        let next = if along > 0.0 { 0.5 * length_squared / along } else { radius };
        let to_other = (near.point - (place - next * normal)).normalize_or_zero();
        if next >= radius || to_other.dot(normal) > LEAST_SEPARATION_COSINE {
            break;
        }
        radius = next;
    }
    // A ball that was not shrunk enough for roughness alone is kept within the solid.
    let centre = place - radius * normal;
    (centre, radius)
}

/// The normal in the middle of a patch, smooth as the vertices' are.
fn normal(surface: &MeshSurface<'_>, patches: &Patches, patch: usize) -> DVec3 {
    let triangle = patches.origins[patch] as usize;
    let corners = surface.mesh().corners(triangle);
    let middle = patches.middle(patch);
    let normals = surface.mesh().triangles()[triangle].map(|vertex| surface.vertex_normal(vertex as usize));
    let area = |a: DVec3, b: DVec3| (a - middle).cross(b - middle).length();
    let [a, b, c] = corners;
    let blended = area(b, c) * normals[0] + area(c, a) * normals[1] + area(a, b) * normals[2];
    let flat = (b - a).cross(c - a).normalize_or_zero();
    let smooth = blended.normalize_or_zero();
    // Across a sharp edge the vertices' normals are nobody's.
    if smooth.dot(flat) > 0.8 { smooth } else { flat }
}

/// Patches spread evenly over the area, in the mesh's order.
fn spread(patches: &Patches, count: usize) -> Vec<usize> {
    let total: f64 = (0..patches.triangles.len()).map(|patch| patches.area(patch)).sum();
    let (mut passed, mut chosen) = (0.0, Vec::with_capacity(count));
    for patch in 0..patches.triangles.len() {
        passed += patches.area(patch);
        if passed / total * count as f64 >= chosen.len() as f64 + 0.5 {
            chosen.push(patch);
        }
    }
    chosen
}

/// Medial balls and the patches that each covers with least growth; about `count` of them.
pub(crate) fn medial_balls(
    surface: &MeshSurface<'_>,
    patches: &Patches,
    pieces: &Pieces<'_>,
    count: usize,
) -> Vec<(DVec3, Vec<u32>)> {
    let [low, high] = surface.mesh().bounds();
    let largest = 0.5 * (high - low).length();
    let ball = |&patch: &usize| {
        let normal = normal(surface, patches, patch);
        let (centre, _) = shrink(surface, patches.middle(patch), normal, largest);
        // Where the roughness has pushed a ball outside, a little below the surface is better.
        let signed = surface.signed_distance(centre);
        if signed < 0.0 {
            (centre, signed)
        } else {
            let centre = patches.middle(patch) - 1e-3 * largest * normal;
            (centre, surface.signed_distance(centre))
        }
    };
    let mut is_sample = vec![false; patches.triangles.len()];
    let mut samples = spread(patches, count / 2);
    let mut balls: Vec<(DVec3, f64)> = Vec::new();
    let mut best = vec![(f64::INFINITY, 0_u32); patches.triangles.len()];
    for round in 0..=ROUNDS {
        samples.iter().for_each(|&patch| is_sample[patch] = true);
        let first = balls.len();
        balls.par_extend(samples.par_iter().map(ball));
        best.par_iter_mut().enumerate().for_each(|(piece, best)| {
            for (index, (centre, signed)) in balls.iter().enumerate().skip(first) {
                if pieces.least_reach(piece as u32, *centre) + signed < best.0 {
                    let error = pieces.reach(piece as u32, *centre) + signed;
                    if error < best.0 {
                        *best = (error, index as u32);
                    }
                }
            }
        });
        if round == ROUNDS {
            break;
        }
        samples = worst_apart(patches, &best, &is_sample, count.div_ceil(2 * ROUNDS));
    }
    let mut owned = vec![Vec::new(); balls.len()];
    for (piece, (_, ball)) in best.iter().enumerate() {
        owned[*ball as usize].push(piece as u32);
    }
    let centres = balls.into_iter().map(|(centre, _)| centre);
    centres.zip(owned).filter(|(_, owned)| !owned.is_empty()).collect()
}

/// The patches that are covered worst, of each ball the worst one only, so that new samples are not all at one place.
fn worst_apart(patches: &Patches, best: &[(f64, u32)], is_sample: &[bool], count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..patches.triangles.len()).filter(|&patch| !is_sample[patch]).collect();
    order.sort_by(|&a, &b| best[b].0.total_cmp(&best[a].0).then_with(|| a.cmp(&b)));
    let mut is_taken = std::collections::BTreeSet::new();
    order.into_iter().filter(|&patch| is_taken.insert(best[patch].1)).take(count).collect()
}
