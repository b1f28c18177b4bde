//! Trees of a torus, a hand and a hare as a scanner sees it: count, coverage, nesting, errors, repeatability.

#![expect(clippy::unwrap_used, reason = "a panic is a test's answer")]

mod shapes;

use backlit_sphere_tree::{ClosedMesh, MeshSurface, SphereTree, TreeOptions, TreeSphere};
use glam::DVec3;

/// Numbers from 0 to 1 from a seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Points of the surface, some on every triangle and its edges.
fn samples(mesh: &ClosedMesh, each: usize) -> Vec<DVec3> {
    let mut random = Random(7);
    let mut places = mesh.vertices().to_vec();
    for triangle in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(triangle);
        for _ in 0..each {
            let (u, v) = (random.next(), random.next());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            places.push(a + u * (b - a) + v * (c - a));
        }
        places.push(a.midpoint(b));
    }
    places
}

fn holds(sphere: &TreeSphere, place: DVec3) -> bool {
    place.distance(sphere.centre) <= sphere.radius
}

fn check(name: &str, mesh: &ClosedMesh, tree: &SphereTree, options: TreeOptions) {
    assert_eq!(tree.levels.len(), options.levels, "{name}");
    assert!(tree.levels.last().unwrap().spheres.len() <= options.spheres, "{name}");
    let places = samples(mesh, 2);
    for (index, level) in tree.levels.iter().enumerate() {
        assert!((1.0 - level.error.coverage).abs() < 1e-12, "{name}");
        for place in &places {
            assert!(level.spheres.iter().any(|sphere| holds(sphere, *place)), "{name}: hole at {place}");
        }
        if index == 0 {
            assert!(level.spheres.iter().all(|sphere| sphere.parent.is_none()));
            continue;
        }
        let above = &tree.levels[index - 1];
        assert!(above.error.outside_mean > level.error.outside_mean, "{name}: level {index} is no better");
        for sphere in &level.spheres {
            let parent = &above.spheres[sphere.parent.unwrap()];
            let lost = places.iter().find(|place| holds(sphere, **place) && !holds(parent, **place));
            assert_eq!(lost, None, "{name}: a parent does not cover what its child covers");
        }
    }
}

/// The errors that a level says, by other points: random ones on every sphere.
fn check_errors(name: &str, mesh: &ClosedMesh, tree: &SphereTree) {
    let surface = MeshSurface::new(mesh);
    let mut random = Random(3);
    for level in &tree.levels {
        let (mut greatest, mut sum, mut area) = (0.0_f64, 0.0, 0.0);
        let each = 20_000 / level.spheres.len() + 60;
        for sphere in &level.spheres {
            let weight = sphere.radius * sphere.radius / each as f64;
            for _ in 0..each {
                let z = 2.0 * random.next() - 1.0;
                let (sin, cos) = (std::f64::consts::TAU * random.next()).sin_cos();
                let side = (1.0 - z * z).sqrt();
                let place = sphere.centre + sphere.radius * DVec3::new(side * cos, side * sin, z);
                let is_hidden = |other: &TreeSphere| place.distance(other.centre) < other.radius - 1e-9;
                if level.spheres.iter().any(is_hidden) {
                    continue;
                }
                let signed = surface.signed_distance(place);
                if signed > 0.0 {
                    greatest = greatest.max(signed);
                    sum += weight * signed;
                    area += weight;
                }
            }
        }
        let error = level.error;
        let count = level.spheres.len();
        assert!(
            greatest <= error.outside_greatest,
            "{name}, {count}: {greatest} is beyond the bound {error:?}"
        );
        assert!(
            greatest > 0.85 * error.outside_greatest,
            "{name}, {count}: {greatest}, the bound is loose: {error:?}"
        );
        assert!(
            (sum / area / error.outside_mean - 1.0).abs() < 0.05,
            "{name}, {count}: {} {error:?}",
            sum / area
        );
    }
}

#[test]
fn trees_cover_nest_and_tell_their_errors() {
    let options = TreeOptions { spheres: 64, levels: 2 };
    for (name, mesh) in shapes::all(0.12) {
        let tree = SphereTree::build(&mesh, &options).unwrap();
        check(name, &mesh, &tree, options);
        check_errors(name, &mesh, &tree);
        // Greatest and mean distance in hundredths of the radius of the box's ball: twice what was measured, or less.
        let [low, high] = mesh.bounds();
        let unit = 0.5 * (high - low).length() / 100.0;
        let error = tree.levels[1].error;
        assert!(error.outside_greatest < 9.0 * unit && error.outside_mean < 5.0 * unit, "{name}: {error:?}");
        assert_eq!(SphereTree::build(&mesh, &options).unwrap(), tree, "{name}: another time another tree");
    }
}

#[test]
fn five_hundred_spheres_fit_a_hand_closely() {
    let options = TreeOptions::default();
    let (name, mesh) = shapes::all(0.1).swap_remove(1);
    let tree = SphereTree::build(&mesh, &options).unwrap();
    check(name, &mesh, &tree, options);
    let [low, high] = mesh.bounds();
    let unit = 0.5 * (high - low).length() / 100.0;
    let error = tree.levels[2].error;
    assert!(error.outside_greatest < 2.5 * unit && error.outside_mean < 0.9 * unit, "{error:?}");
}

#[test]
fn few_spheres_many_parts_and_other_units_are_no_problem() {
    let mesh = shapes::all(0.2).swap_remove(0).1;
    // Three tori that do not touch, far from the origin, in millimetres.
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for part in 0..3 {
        let first = vertices.len() as u32;
        let shift = DVec3::new(5.0 * f64::from(part), 0.0, 40.0);
        vertices.extend(mesh.vertices().iter().map(|place| 1000.0 * (*place + shift)));
        triangles.extend(mesh.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    let parts = ClosedMesh::new(&vertices, &triangles).unwrap();
    for (spheres, levels) in [(1, 1), (2, 2), (5, 3), (30, 1)] {
        let options = TreeOptions { spheres, levels };
        let tree = SphereTree::build(&parts, &options).unwrap();
        assert!(tree.levels.last().unwrap().spheres.len() <= spheres);
        for place in samples(&parts, 0) {
            for level in &tree.levels {
                assert!(level.spheres.iter().any(|sphere| holds(sphere, place)));
            }
        }
    }
    for (spheres, levels, what) in [(0, 1, "spheres is 0"), (9999, 1, "1 to 4096"), (8, 0, "levels is 0")] {
        let message = SphereTree::build(&mesh, &TreeOptions { spheres, levels }).unwrap_err().to_string();
        assert!(message.contains(what), "{message}");
    }
}
