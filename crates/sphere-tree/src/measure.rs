//! How far spheres stand off a surface.
//!
//! The spheres of a level bound a solid of their own, their union. On its boundary, the parts of the spheres that lie in no other
//! sphere, the distance from the mesh is measured, outside of the mesh and inside of it. The greatest distance outside is bounded:
//! patches of the spheres are cut smaller until none can hold a distance that is more than a hundredth greater than what was found
//! (the signed distance changes by no more than the way between two points). The others are taken at points spread evenly.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::ClosedMesh;
use crate::surface::MeshSurface;
use crate::tree::LevelError;

/// Points spread over the spheres of a level for the means, a sphere and at most.
const POINTS_PER_SPHERE: f64 = 1000.0;
const MOST_POINTS: f64 = 60_000.0;

/// Fewest points of a sphere.
const FEWEST: f64 = 64.0;

/// Points of the surface that are looked at for coverage.
const SURFACE_POINTS: usize = 100_000;

/// The bound is no more than so much greater than a distance that was found.
const LOOSENESS: f64 = 0.01;

/// Patches smaller than so much of their sphere's radius are not cut further; what they can hold at most counts.
const SMALLEST: f64 = 2e-3;

/// A sphere with those that reach it, the largest first.
struct Sphere {
    centre: DVec3,
    radius: f64,
    others: Vec<(DVec3, f64)>,
}

impl Sphere {
    /// Whether all within `extent` of a place lies in one other sphere.
    fn is_hidden(&self, place: DVec3, extent: f64) -> bool {
        self.others.iter().any(|(centre, radius)| {
            let least = radius - extent;
            least > 0.0 && place.distance_squared(*centre) < least * least
        })
    }
}

/// Errors of a level's spheres (centre, radius).
pub(crate) fn measure(surface: &MeshSurface<'_>, spheres: &[(DVec3, f64)]) -> LevelError {
    let spheres: Vec<Sphere> = (0..spheres.len()).map(|index| neighbourhood(spheres, index)).collect();
    let total: f64 = spheres.iter().map(|sphere| sphere.radius * sphere.radius).sum();
    let points = (POINTS_PER_SPHERE * spheres.len() as f64).min(MOST_POINTS);
    let sums: Vec<BoundaryError> =
        spheres.par_iter().map(|sphere| sample(surface, sphere, points / total)).collect();
    let sums = sums.into_iter().fold(BoundaryError::default(), BoundaryError::plus);
    let mean = |sum: f64, area: f64| if area > 0.0 { sum / area } else { 0.0 };
    LevelError {
        outside_greatest: greatest_outside(surface, &spheres, sums.greatest[0]),
        outside_mean: mean(sums.distance[0], sums.area[0]),
        inside_greatest: sums.greatest[1],
        inside_mean: mean(sums.distance[1], sums.area[1]),
        coverage: coverage(surface.mesh(), &spheres),
    }
}

fn neighbourhood(spheres: &[(DVec3, f64)], index: usize) -> Sphere {
    let (centre, radius) = spheres[index];
    let reaches = |&(other, &(place, size)): &(usize, &(DVec3, f64))| {
        // Of two equal spheres the first hides the second.
        let is_same = place == centre && size.total_cmp(&radius).is_eq();
        place.distance(centre) < radius + size && if is_same { other < index } else { other != index }
    };
    let mut others: Vec<(DVec3, f64)> =
        spheres.iter().enumerate().filter(reaches).map(|(_, sphere)| *sphere).collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    Sphere { centre, radius, others }
}

/// Of the union's boundary outside of the mesh, and inside.
#[derive(Debug, Clone, Copy, Default)]
struct BoundaryError {
    area: [f64; 2],
    /// Distance times area.
    distance: [f64; 2],
    greatest: [f64; 2],
}

impl BoundaryError {
    fn plus(self, other: Self) -> Self {
        let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            area: add(self.area, other.area),
            distance: add(self.distance, other.distance),
            greatest: [self.greatest[0].max(other.greatest[0]), self.greatest[1].max(other.greatest[1])],
        }
    }
}

fn sample(surface: &MeshSurface<'_>, sphere: &Sphere, points_per_radius_squared: f64) -> BoundaryError {
    let points = sphere.radius * sphere.radius * points_per_radius_squared;
    let count = points.max(FEWEST).round() as usize;
    let area = 4.0 * PI * sphere.radius * sphere.radius / count as f64;
    let turn = PI * (3.0 - 5.0_f64.sqrt());
    let mut sums = BoundaryError::default();
    for index in 0..count {
        // Fibonacci's lattice on the sphere.
        let z = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let (sin, cos) = (turn * index as f64).sin_cos();
        let direction = DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
        let place = sphere.centre + sphere.radius * direction;
        if sphere.is_hidden(place, 0.0) {
            continue;
        }
        let signed = surface.signed_distance(place);
        let side = usize::from(signed < 0.0);
        sums.area[side] += area;
        sums.distance[side] += area * signed.abs();
        sums.greatest[side] = sums.greatest[side].max(signed.abs());
    }
    sums
}

/// A bound of the distance outside, no more than [`LOOSENESS`] above what there is, but for patches of the smallest size.
fn greatest_outside(surface: &MeshSurface<'_>, spheres: &[Sphere], found: f64) -> f64 {
    let mut order: Vec<(f64, usize)> = spheres
        .iter()
        .enumerate()
        .map(|(index, sphere)| (sphere.radius + surface.signed_distance(sphere.centre), index))
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    let mut bound = found;
    for (most, index) in order {
        if most <= bound * (1.0 + LOOSENESS) {
            break;
        }
        bound = bound.max(greatest_of_sphere(surface, &spheres[index], bound));
    }
    bound * (1.0 + LOOSENESS)
}

fn greatest_of_sphere(surface: &MeshSurface<'_>, sphere: &Sphere, mut bound: f64) -> f64 {
    let mut patches: Vec<[DVec3; 3]> = Vec::new();
    for x in [DVec3::X, DVec3::NEG_X] {
        for y in [DVec3::Y, DVec3::NEG_Y] {
            patches.extend([[x, y, DVec3::Z], [x, y, DVec3::NEG_Z]]);
        }
    }
    while let Some([a, b, c]) = patches.pop() {
        let middle = (a + b + c).normalize();
        // Of a patch of the sphere the corners are farthest from its middle.
        let spread = [a, b, c].into_iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let place = sphere.centre + sphere.radius * middle;
        let extent = sphere.radius * spread;
        if sphere.is_hidden(place, extent) {
            continue;
        }
        let signed = surface.signed_distance(place);
        if !sphere.is_hidden(place, 0.0) {
            bound = bound.max(signed);
        }
        if signed + extent <= bound * (1.0 + LOOSENESS) {
            continue;
        }
        if spread < SMALLEST {
            bound = bound.max(signed + extent);
            continue;
        }
        let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
        patches.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    bound
}

/// Share of the surface that lies in spheres, by points spread evenly over its area.
fn coverage(mesh: &ClosedMesh, spheres: &[Sphere]) -> f64 {
    let areas: Vec<f64> = (0..mesh.triangles().len())
        .map(|triangle| {
            let [a, b, c] = mesh.corners(triangle);
            (b - a).cross(c - a).length()
        })
        .collect();
    let total: f64 = areas.iter().sum();
    let mut places = Vec::with_capacity(SURFACE_POINTS);
    let mut passed = 0.0;
    for (triangle, area) in areas.iter().enumerate() {
        passed += area;
        let wanted = (passed / total * SURFACE_POINTS as f64) as usize;
        while places.len() < wanted {
            // Roberts's sequence in the plane, folded into the triangle.
            let index = places.len() as f64;
            let (mut u, mut v) = ((0.754_877_666 * index).fract(), (0.569_840_291 * index).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let [a, b, c] = mesh.corners(triangle);
            places.push(a + u * (b - a) + v * (c - a));
        }
    }
    let is_covered = |place: &DVec3| {
        spheres.iter().any(|sphere| place.distance_squared(sphere.centre) <= sphere.radius * sphere.radius)
    };
    let covered = places.par_iter().filter(|place| is_covered(place)).count();
    covered as f64 / places.len().max(1) as f64
}
