//! Solids as distance functions: how far a point lies outside a shape, negative inside.
//!
//! Where a function is not the exact Euclidean distance it is a lower bound times at most
//! [`STEP`](super::figure::STEP), so that a ray that walks by it does not pass through.
//! Formulas after I. Quilez, "Distance functions" and "Smooth minimum". Metres.

use glam::DVec3;

/// A ball swept from `from` to `to` while its radius changes: the hull of two balls.
pub(super) fn round_cone(
    point: DVec3,
    from: impl Into<DVec3>,
    to: impl Into<DVec3>,
    radius_from: f64,
    radius_to: f64,
) -> f64 {
    let from = from.into();
    let axis = to.into() - from;
    let length_squared = axis.length_squared();
    let narrowing = radius_from - radius_to;
    let squared = length_squared - narrowing * narrowing;
    let inverse = 1.0 / length_squared;
    let relative = point - from;
    let along = relative.dot(axis);
    let beyond = along - length_squared;
    let across_squared = (relative * length_squared - axis * along).length_squared();
    let along_squared = along * along * length_squared;
    let beyond_squared = beyond * beyond * length_squared;
    let k = narrowing.signum() * narrowing * narrowing * across_squared;
    if beyond.signum() * squared * beyond_squared > k {
        return (across_squared + beyond_squared).sqrt() * inverse - radius_to;
    }
    if along.signum() * squared * along_squared < k {
        return (across_squared + along_squared).sqrt() * inverse - radius_from;
    }
    ((across_squared * squared * inverse).sqrt() + along * narrowing) * inverse - radius_from
}

/// An ellipsoid with half axes `radii`: close to exact near its surface.
pub(super) fn ellipsoid(point: DVec3, centre: impl Into<DVec3>, radii: impl Into<DVec3>) -> f64 {
    let (relative, radii) = (point - centre.into(), radii.into());
    let scaled = (relative / radii).length();
    let gradient = (relative / (radii * radii)).length();
    if gradient < 1e-12 { -radii.min_element() } else { scaled * (scaled - 1.0) / gradient }
}

/// A box with half sizes `half`, its edges rounded outwards by `round`.
pub(super) fn rounded_box(point: DVec3, centre: [f64; 3], half: [f64; 3], round: f64) -> f64 {
    let outside = (point - DVec3::from(centre)).abs() - DVec3::from(half);
    outside.max(DVec3::ZERO).length() + outside.max_element().min(0.0) - round
}

/// A frustum about the z axis from height `top` down to `bottom`, with elliptic sections: `depth` is the
/// half width along y over that along x.
pub(super) fn frustum(point: DVec3, top: [f64; 2], bottom: [f64; 2], depth: f64, round: f64) -> f64 {
    let [top_z, top_radius] = top;
    let [bottom_z, bottom_radius] = bottom;
    let across = point.x.hypot(point.y / depth);
    let fraction = ((point.z - bottom_z) / (top_z - bottom_z)).clamp(0.0, 1.0);
    let slope = (top_radius - bottom_radius) / (top_z - bottom_z);
    let side = (across - (bottom_radius + fraction * (top_radius - bottom_radius) - round)) * depth.min(1.0)
        / slope.hypot(1.0);
    let ends = (point.z - top_z + round).max(bottom_z + round - point.z);
    side.max(0.0).hypot(ends.max(0.0)) + side.max(ends).min(0.0) - round
}

/// The union of two solids with a fillet of width `k`.
pub(super) fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * k * 0.25
}

/// The intersection of two solids with an edge rounded over `k`.
pub(super) fn smooth_max(a: f64, b: f64, k: f64) -> f64 {
    -smooth_min(-a, -b, k)
}

/// Smooth noise in −1 … 1 with one feature a unit, the same for the same point everywhere.
pub(super) fn noise(point: DVec3) -> f64 {
    let cell = point.floor();
    let f = point - cell;
    let w = f * f * (DVec3::splat(3.0) - 2.0 * f);
    let (x, y, z) = (cell.x as i64, cell.y as i64, cell.z as i64);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let edge = |dy, dz| mix(lattice(x, y + dy, z + dz), lattice(x + 1, y + dy, z + dz), w.x);
    mix(mix(edge(0, 0), edge(1, 0), w.y), mix(edge(0, 1), edge(1, 1), w.y), w.z)
}

/// A random number in −1 … 1 for a point of the integer lattice.
pub(super) fn lattice(x: i64, y: i64, z: i64) -> f64 {
    let mut h = (x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (y as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F)
        ^ (z as u64).wrapping_mul(0x1656_67B1_9E37_79F9);
    h ^= h >> 29;
    h = h.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    h ^= h >> 32;
    h = h.wrapping_mul(0x94D0_49BB_1331_11EB);
    h ^= h >> 31;
    (h >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_cone_is_the_hull_of_its_balls() {
        let (a, b) = (DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.3, 0.0, 0.0));
        for i in 0..400 {
            let point = DVec3::new(lattice(i, 0, 0), lattice(i, 1, 0), 0.5 + lattice(i, 2, 0));
            let nearest = (0..=4000)
                .map(|step| {
                    let t = f64::from(step) / 4000.0;
                    point.distance(a.lerp(b, t)) - (0.2 + t * (0.05 - 0.2))
                })
                .fold(f64::INFINITY, f64::min);
            let found = round_cone(point, a, b, 0.2, 0.05);
            assert!((found - nearest).abs() < 1e-5, "{point} {found} {nearest}");
        }
    }

    #[test]
    fn noise_stays_in_range_and_is_continuous() {
        for i in 0..500 {
            let at = DVec3::new(f64::from(i) * 0.37 - 80.0, f64::from(i) * 0.11, -3.3);
            let (here, there) = (noise(at), noise(at + DVec3::splat(1e-4)));
            assert!(here.abs() <= 1.0 && (here - there).abs() < 1e-2, "{at} {here} {there}");
        }
    }
}
