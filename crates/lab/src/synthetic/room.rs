//! The room: a box of walls with furniture of blocks, cylinders and ellipsoids, met by rays in closed form.

use glam::DVec3;

use super::shading::Surface;

/// Half the room's breadth and depth, metres.
pub(super) const HALF: f64 = 3.6;
/// The ceiling's height, metres.
pub(super) const HEIGHT: f64 = 2.75;

#[derive(Debug, Clone, Copy)]
pub(super) enum Shape {
    /// Half sizes.
    Block(DVec3),
    /// Upright: radius and half height.
    Cylinder(f64, f64),
    /// Half axes.
    Ellipsoid(DVec3),
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) shape: Shape,
    pub(super) centre: DVec3,
    /// Sine and cosine of the turn about the vertical.
    pub(super) turn: [f64; 2],
    pub(super) surface: Surface,
}

/// Where a ray meets the room.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoomHit {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    /// The point and the normal in the piece's own axes, from its middle.
    pub(super) local: DVec3,
    pub(super) half: DVec3,
    pub(super) surface: Surface,
}

/// A furnished room around the origin, floor at z = 0.
#[derive(Debug, Clone)]
pub struct Room {
    pub(super) pieces: Vec<Piece>,
}

impl Room {
    /// Where a ray (unit `direction`) first meets the room. Pieces that hold the origin are not seen.
    pub(super) fn intersect(&self, origin: DVec3, direction: DVec3) -> RoomHit {
        let (mut best, mut which) = (f64::INFINITY, None);
        for (index, piece) in self.pieces.iter().enumerate() {
            if let Some(t) = piece.enter(origin, direction).filter(|t| *t < best) {
                (best, which) = (t, Some(index));
            }
        }
        if let Some(index) = which {
            let position = origin + direction * best;
            return self.pieces[index].hit(position);
        }
        shell(origin, direction)
    }

    /// Whether something stands between two points of the room.
    pub(super) fn blocks(&self, from: DVec3, to: DVec3) -> bool {
        let way = to - from;
        let length = way.length();
        let direction = way / length;
        self.pieces.iter().any(|piece| {
            !matches!(piece.surface, Surface::Glow | Surface::Sky)
                && piece.enter(from, direction).is_some_and(|t| t < length - 1e-3)
        })
    }
}

impl Piece {
    fn local(&self, v: DVec3) -> DVec3 {
        let [sin, cos] = self.turn;
        DVec3::new(cos * v.x + sin * v.y, cos * v.y - sin * v.x, v.z)
    }

    fn half(&self) -> DVec3 {
        match self.shape {
            Shape::Block(half) | Shape::Ellipsoid(half) => half,
            Shape::Cylinder(radius, half) => DVec3::new(radius, radius, half),
        }
    }

    /// Where the ray comes in from outside.
    fn enter(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let (o, d) = (self.local(origin - self.centre), self.local(direction));
        let half = self.half();
        let inverse = d.recip();
        let (a, b) = ((-half - o) * inverse, (half - o) * inverse);
        let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
        if near > far || near <= 1e-9 {
            return None;
        }
        let quadratic = |o: DVec3, d: DVec3| {
            let (aa, bb, cc) = (d.length_squared(), o.dot(d), o.length_squared() - 1.0);
            let root = bb * bb - aa * cc;
            (root >= 0.0 && aa > 0.0).then(|| ((-bb - root.sqrt()) / aa, (-bb + root.sqrt()) / aa))
        };
        match self.shape {
            Shape::Block(_) => Some(near),
            Shape::Ellipsoid(radii) => quadratic(o / radii, d / radii).map(|(t, _)| t).filter(|t| *t > 1e-9),
            Shape::Cylinder(radius, half) => {
                let flat = DVec3::new(1.0, 1.0, 0.0) / radius;
                let (side_in, side_out) = quadratic(o * flat, d * flat)?;
                let (low, high) = ((-half - o.z) * inverse.z, (half - o.z) * inverse.z);
                let (t, out) = (side_in.max(low.min(high)), side_out.min(low.max(high)));
                (t < out && t > 1e-9).then_some(t)
            }
        }
    }

    fn hit(&self, position: DVec3) -> RoomHit {
        let local = self.local(position - self.centre);
        let half = self.half();
        let local_normal = match self.shape {
            Shape::Block(half) => {
                let near = (local.abs() - half).to_array();
                let axis = (0..3).fold(0, |best, axis| if near[axis] > near[best] { axis } else { best });
                DVec3::AXES[axis] * local[axis].signum()
            }
            Shape::Ellipsoid(radii) => (local / (radii * radii)).normalize(),
            Shape::Cylinder(radius, half) => {
                if local.z.abs() - half > local.x.hypot(local.y) - radius {
                    DVec3::Z * local.z.signum()
                } else {
                    DVec3::new(local.x, local.y, 0.0).normalize()
                }
            }
        };
        let normal = turned(self.turn, local_normal);
        RoomHit { position, normal, local, half, surface: self.surface }
    }
}

/// Turned about the vertical, by sine and cosine.
pub(super) fn turned([sin, cos]: [f64; 2], v: DVec3) -> DVec3 {
    DVec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
}

/// Floor, ceiling and walls, seen from inside.
fn shell(origin: DVec3, direction: DVec3) -> RoomHit {
    let half = DVec3::new(HALF, HALF, HEIGHT * 0.5);
    let middle = DVec3::new(0.0, 0.0, HEIGHT * 0.5);
    let wall = half * DVec3::new(direction.x.signum(), direction.y.signum(), direction.z.signum());
    let t = ((wall - (origin - middle)) / direction).to_array();
    let axis = (0..3).fold(0, |best, axis| if t[axis] < t[best] { axis } else { best });
    let position = origin + direction * t[axis];
    let normal = -DVec3::AXES[axis] * direction[axis].signum();
    let surface = match (axis, direction[axis] > 0.0) {
        (2, false) => Surface::Floor,
        (2, true) => Surface::Ceiling,
        (0, false) => Surface::Wall(0.62, 0.6, 0.55),
        (0, true) => Surface::Wall(0.42, 0.5, 0.52),
        (1, true) => Surface::Wall(0.6, 0.57, 0.52),
        _ => Surface::Wall(0.56, 0.57, 0.56),
    };
    RoomHit { position, normal, local: position, half, surface }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::solid::lattice;

    #[test]
    fn every_ray_from_the_middle_meets_something_that_faces_it() {
        let room = Room::default();
        let origin = DVec3::new(0.0, 0.0, 1.2);
        for i in 0..2000 {
            let direction = DVec3::new(lattice(i, 0, 1), lattice(i, 1, 1), lattice(i, 2, 1)).normalize();
            let hit = room.intersect(origin, direction);
            assert!(hit.position.is_finite() && (hit.normal.length() - 1.0).abs() < 1e-9);
            assert!(hit.normal.dot(direction) < 1e-9, "{:?}", hit.surface);
            assert!(hit.position.x.abs() < HALF + 1e-9 && hit.position.z > -1e-9);
        }
    }
}
