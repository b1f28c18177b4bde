//! A limb's surface as triangles: a cylinder with half a sphere on each end.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Corners around the limb.
const AROUND: usize = 16;
/// Rings from a pole to where the cylinder begins.
const RINGS: usize = 4;

/// Corners, their outward normals, and triangles, seen from outside against the clock.
#[derive(Debug, Default)]
pub(super) struct Surface {
    pub(super) corners: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The surface of the capsule from `start` to `end`.
pub(super) fn surface(start: DVec3, end: DVec3, radius: f64) -> Surface {
    let along = (end - start).try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = along.any_orthonormal_pair();
    // A right-handed frame u, v, along, whichever hand the pair was of.
    let v = if u.cross(v).dot(along) < 0.0 { -v } else { v };
    let mut out = Surface::default();
    // Rings from the pole at the start to the pole at the end; each half sphere has its own equator.
    for ring in 0..2 * (RINGS + 1) {
        let (centre, step) = if ring <= RINGS { (start, ring) } else { (end, ring - 1) };
        let latitude = PI * (step as f64 / (2 * RINGS) as f64 - 0.5);
        for corner in 0..AROUND {
            let longitude = TAU * corner as f64 / AROUND as f64;
            let outwards = u * longitude.cos() + v * longitude.sin();
            let normal = (outwards * latitude.cos() + along * latitude.sin()).normalize();
            out.corners.push(centre + normal * radius);
            out.normals.push(normal);
        }
    }
    let index = |ring: usize, corner: usize| (ring * AROUND + corner % AROUND) as u32;
    for ring in 0..2 * RINGS + 1 {
        for corner in 0..AROUND {
            let [a, b] = [index(ring, corner), index(ring, corner + 1)];
            let [c, d] = [index(ring + 1, corner), index(ring + 1, corner + 1)];
            // At a pole one of the two has no area.
            if ring != 0 {
                out.triangles.push([a, b, d]);
            }
            if ring != 2 * RINGS {
                out.triangles.push([a, d, c]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_is_closed_and_looks_outwards() {
        let (start, end, radius) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.4, 0.1, 0.9), 0.05);
        let Surface { corners, normals, triangles } = surface(start, end, radius);
        let along = (end - start).normalize();
        for (corner, normal) in corners.iter().zip(&normals) {
            let at = (*corner - start).dot(along).clamp(0.0, start.distance(end));
            assert!((corner.distance(start + along * at) - radius).abs() < 1e-12);
            assert!((normal.length() - 1.0).abs() < 1e-12);
        }
        let mut volume = 0.0;
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|index| corners[index as usize]);
            assert!((b - a).cross(c - a).dot(normals[triangle[0] as usize]) > 0.0);
            volume += a.dot(b.cross(c)) / 6.0;
        }
        let whole = PI * radius.powi(2) * (start.distance(end) + 4.0 / 3.0 * radius);
        assert!((0.9..1.0).contains(&(volume / whole)), "{}", volume / whole);
    }
}
