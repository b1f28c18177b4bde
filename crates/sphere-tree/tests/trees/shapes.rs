//! Solids of functions: a torus, a hand, and a sitting animal with the roughness of a scan.

use backlit_sphere_tree::{ClosedMesh, isosurface};
use glam::DVec3;

/// Distance of a point from a capsule whose radius goes from `r` at `a` to `s` at `b`, about.
fn limb(p: DVec3, a: DVec3, b: DVec3, [r, s]: [f64; 2]) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a.lerp(b, t)) - (r + t * (s - r))
}

/// About an ellipsoid.
fn egg(p: DVec3, centre: DVec3, radii: DVec3) -> f64 {
    let q = (p - centre) / radii;
    (q.length() - 1.0) * radii.min_element()
}

/// Smooth union of two distances.
fn blend(a: f64, b: f64, width: f64) -> f64 {
    let h = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - 0.25 * h * h * width
}

fn torus_distance(p: DVec3) -> f64 {
    p.z.hypot(p.x.hypot(p.y) - 0.7) - 0.25
}

fn hand_distance(p: DVec3) -> f64 {
    let palm = egg(p, DVec3::ZERO, DVec3::new(0.45, 0.5, 0.16));
    let fingers = [(-0.33, 0.62, 0.85), (-0.12, 0.72, 1.05), (0.1, 0.72, 1.0), (0.31, 0.62, 0.8)];
    let mut all = fingers.iter().fold(palm, |all, &(x, middle, tip)| {
        let joints =
            [DVec3::new(0.8 * x, 0.3, 0.0), DVec3::new(x, middle, 0.03), DVec3::new(1.2 * x, tip, -0.06)];
        let low = limb(p, joints[0], joints[1], [0.1, 0.09]);
        let high = limb(p, joints[1], joints[2], [0.09, 0.07]);
        blend(all, low.min(high), 0.06)
    });
    let thumb = [DVec3::new(0.35, -0.2, 0.05), DVec3::new(0.62, 0.1, 0.12), DVec3::new(0.7, 0.38, 0.1)];
    all = blend(all, limb(p, thumb[0], thumb[1], [0.13, 0.11]), 0.08);
    all = blend(all, limb(p, thumb[1], thumb[2], [0.11, 0.08]), 0.03);
    blend(all, limb(p, DVec3::new(0.0, -0.4, 0.0), DVec3::new(0.0, -0.8, 0.0), [0.2, 0.22]), 0.2)
}

fn hare_distance(p: DVec3) -> f64 {
    let body = egg(p, DVec3::ZERO, DVec3::new(0.45, 0.5, 0.6));
    let chest = egg(p, DVec3::new(0.0, 0.25, 0.45), DVec3::new(0.3, 0.38, 0.3));
    let head = egg(p, DVec3::new(0.0, 0.72, 0.6), DVec3::new(0.22, 0.22, 0.3));
    let mut all = blend(blend(body, chest, 0.2), head, 0.1);
    for side in [-1.0, 1.0] {
        let at = |x: f64, y: f64, z: f64| DVec3::new(side * x, y, z);
        all = blend(all, limb(p, at(0.1, 0.85, 0.5), at(0.2, 1.35, 0.25), [0.1, 0.06]), 0.06);
        all = blend(all, egg(p, at(0.36, -0.2, -0.15), DVec3::new(0.2, 0.34, 0.36)), 0.1);
        all = blend(all, limb(p, at(0.3, -0.45, -0.1), at(0.32, -0.47, 0.4), [0.1, 0.08]), 0.05);
        all = blend(all, limb(p, at(0.16, 0.1, 0.55), at(0.17, -0.45, 0.68), [0.11, 0.08]), 0.08);
    }
    all = all.min(egg(p, DVec3::new(0.0, -0.15, -0.68), DVec3::splat(0.17)));
    // What a scanner adds.
    let wave =
        |q: DVec3| (31.0 * q.x + 5.0 * q.z).sin() * (37.0 * q.y).cos() * (29.0 * q.z + 7.0 * q.x).sin();
    all + 0.006 * wave(p)
}

/// The three solids by name, on a grid of `step`; what they are as a function, too.
pub(crate) fn all(step: f64) -> Vec<(&'static str, ClosedMesh)> {
    type Shape = (&'static str, [DVec3; 2], fn(DVec3) -> f64);
    let box_of = |low: [f64; 3], high: [f64; 3]| [DVec3::from(low), DVec3::from(high)];
    let shapes: [Shape; 3] = [
        ("torus", box_of([-1.0, -1.0, -0.3], [1.0, 1.0, 0.3]), torus_distance),
        ("hand", box_of([-0.6, -1.1, -0.3], [0.9, 1.2, 0.3]), hand_distance),
        ("hare", box_of([-0.65, -0.65, -0.9], [0.65, 1.45, 0.95]), hare_distance),
    ];
    let mesh = |(name, bounds, value): Shape| (name, isosurface(bounds, step, value).expect("a solid"));
    shapes.into_iter().map(mesh).collect()
}
