//! The closest points of two segments.

use glam::DVec3;

/// Below this (m²) a segment is a point, and two directions are parallel.
const TINY: f64 = 1e-12;

/// Fractions (s, t) of the closest points p0 + s (p1 − p0) and q0 + t (q1 − q0), both within 0 … 1.
///
/// After C. Ericson, "Real-Time Collision Detection" (2005), 5.1.9. Parallel segments have many closest
/// points; one pair of them is returned.
///
/// ```
/// use backlit_tracking::geometry::segments::closest_fractions;
/// use glam::DVec3;
///
/// let up = DVec3::new(0.5, 1.0, 0.2);
/// assert_eq!(closest_fractions(DVec3::ZERO, DVec3::X, up, up + DVec3::Y), (0.5, 0.0));
/// ```
pub fn closest_fractions(p0: DVec3, p1: DVec3, q0: DVec3, q1: DVec3) -> (f64, f64) {
    let (a, b, between) = (p1 - p0, q1 - q0, p0 - q0);
    let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
    let (along_a, along_b) = (a.dot(between), b.dot(between));
    if aa <= TINY {
        return (0.0, if bb <= TINY { 0.0 } else { (along_b / bb).clamp(0.0, 1.0) });
    }
    if bb <= TINY {
        return ((-along_a / aa).clamp(0.0, 1.0), 0.0);
    }
    let denominator = aa * bb - ab * ab;
    let s = if denominator > TINY * aa * bb {
        ((ab * along_b - along_a * bb) / denominator).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let t = (ab * s + along_b) / bb;
    match t {
        t if t < 0.0 => ((-along_a / aa).clamp(0.0, 1.0), 0.0),
        t if t > 1.0 => (((ab - along_a) / aa).clamp(0.0, 1.0), 1.0),
        t => (s, t),
    }
}

/// Distance of a point from a segment.
pub(crate) fn distance(point: DVec3, from: DVec3, to: DVec3) -> f64 {
    let (axis, off) = (to - from, point - from);
    let along = (off.dot(axis) / axis.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    off.distance(axis * along)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z)| DVec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn no_other_points_are_closer(p0 in point(), p1 in point(), q0 in point(), q1 in point()) {
            let distance = |s: f64, t: f64| p0.lerp(p1, s).distance(q0.lerp(q1, t));
            let (s, t) = closest_fractions(p0, p1, q0, q1);
            prop_assert!((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t));
            let found = distance(s, t);
            for i in 0..=20 {
                for j in 0..=20 {
                    prop_assert!(found <= distance(f64::from(i) / 20.0, f64::from(j) / 20.0) + 1e-9);
                }
            }
        }
    }

    #[test]
    fn points_and_parallels_have_an_answer() {
        let (o, x) = (DVec3::ZERO, DVec3::X);
        assert_eq!(closest_fractions(o, o, x, x), (0.0, 0.0));
        assert_eq!(closest_fractions(o, x, x * 0.3, x * 0.3), (0.3, 0.0));
        let (s, t) = closest_fractions(o, x, o + DVec3::Y, x + DVec3::Y);
        assert_eq!((x * s).distance(x * t + DVec3::Y), 1.0);
    }
}
