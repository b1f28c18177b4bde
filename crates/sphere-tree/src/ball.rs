//! The sphere about some points of the surface that stands out of the solid least.
//!
//! A sphere about c that reaches all its points has the radius r(c) = max |v − c|. A ball of the depth −d(c) about c lies inside,
//! where d is the signed distance, so no point of the sphere is further outside than
//!
//! ```text
//! e(c) = r(c) + d(c)
//! ```
//!
//! (a straight line from c to a point outside crosses the surface at −d(c) or later). e is 0 for the sphere that the solid is
//! there. It is made small by moving away from the nearest surface and towards the farthest point.

use glam::DVec3;

use crate::surface::MeshSurface;

/// A sphere and how far it stands out at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ball {
    pub(crate) centre: DVec3,
    pub(crate) radius: f64,
    /// Signed distance of the centre from the surface.
    pub(crate) signed: f64,
}

impl Ball {
    /// How far it stands out of the solid, at most: e of the module's equation.
    pub(crate) fn error(&self) -> f64 {
        self.radius + self.signed
    }
}

/// How long a fit searches.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Effort {
    /// To compare candidates.
    Quick,
    /// To keep.
    Full,
}

/// A search for the best centre.
struct BallSearch<'a> {
    surface: &'a MeshSurface<'a>,
    points: &'a [DVec3],
    /// Places of the surface that were closest to centres so far.
    known: Vec<DVec3>,
    best: Ball,
    /// Direction in which the error falls at first.
    downhill: DVec3,
}

impl BallSearch<'_> {
    /// Takes a centre if it is better by more than a trifle. The surface is asked only if what is known of it does not say no.
    fn try_centre(&mut self, centre: DVec3) -> bool {
        let wanted = self.best.error() - 1e-6 * self.best.radius;
        let near = |places: &[DVec3]| {
            places.iter().map(|place| place.distance_squared(centre)).fold(f64::INFINITY, f64::min).sqrt()
        };
        let depth = near(&self.known);
        let mut far = (centre, 0.0);
        for &point in self.points {
            let distance = point.distance_squared(centre);
            if distance > far.1 {
                far = (point, distance);
            }
        }
        let radius = far.1.sqrt();
        if radius - depth >= wanted {
            return false;
        }
        let nearest = self.surface.nearest_within(centre, depth);
        self.known.push(nearest.point);
        let ball = Ball { centre, radius, signed: nearest.signed };
        if ball.error() >= wanted {
            return false;
        }
        let to_far = (far.0 - centre).normalize_or_zero();
        let outwards = if nearest.signed < 0.0 { 1.0 } else { -1.0 };
        let to_outside = outwards * (nearest.point - centre).normalize_or_zero();
        (self.best, self.downhill) = (ball, (to_far - to_outside).normalize_or_zero());
        true
    }
}

/// The best sphere that reaches `points` and begins at one of `starts`, by downhill steps and steps along the axes.
///
/// There must be a start.
pub(crate) fn fit(surface: &MeshSurface<'_>, points: &[DVec3], starts: &[DVec3], effort: Effort) -> Ball {
    let none = Ball { centre: starts[0], radius: 0.0, signed: f64::INFINITY };
    let mut search = BallSearch { surface, points, known: Vec::new(), best: none, downhill: DVec3::ZERO };
    starts.iter().for_each(|&start| {
        search.try_centre(start);
    });
    const AXES: [DVec3; 6] = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let (halvings, axes) = match effort {
        Effort::Quick => (3, &AXES[..0]),
        Effort::Full => (7, &AXES[..]),
    };
    let mut step = 0.25 * search.best.radius;
    for _ in 0..halvings {
        // Each length is used while it helps, but not for ever.
        for _ in 0..4 {
            let centre = search.best.centre;
            let downhill = search.downhill;
            let is_better = search.try_centre(centre + step * downhill)
                || axes.iter().any(|&axis| search.try_centre(centre + step * axis));
            if !is_better {
                break;
            }
        }
        step *= 0.5;
    }
    search.best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isosurface::isosurface;

    #[test]
    fn a_ball_is_found_from_part_of_its_surface() {
        let mesh = isosurface([DVec3::splat(-1.2), DVec3::splat(1.2)], 0.1, |p| p.length() - 1.0).unwrap();
        let surface = MeshSurface::new(&mesh);
        let points: Vec<DVec3> = mesh.vertices().iter().copied().filter(|p| p.x > 0.2).collect();
        let ball = fit(&surface, &points, &[DVec3::new(0.6, 0.1, -0.1)], Effort::Full);
        assert!(ball.error() < 0.03 && ball.centre.length() < 0.05, "{ball:?}");
        assert!(points.iter().all(|p| p.distance(ball.centre) <= ball.radius));
        // What a smallest enclosing sphere would give stands out much further.
        let middle = DVec3::new(0.2, 0.0, 0.0);
        assert!(points.iter().any(|p| p.distance(middle) + surface.signed_distance(middle) > 0.1));
    }
}
