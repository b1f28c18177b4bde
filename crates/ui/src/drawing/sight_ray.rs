//! The sight ray of a pixel of one camera as another camera sees it (its epipolar line).

use backlit_tracking::camera::Camera;
use glam::{DVec2, DVec3};

/// The ray is drawn from here to there, metres from its camera.
const REACH_M: [f64; 2] = [0.1, 100.0];

/// Drawn solid this near to the joint's depth, metres.
const SOLID_M: f64 = 0.3;

/// What lies nearer than this in front of the other camera is cut off, metres.
const NEAREST_M: f64 = 0.05;

/// A ray in another camera's picture. Its ends can be far outside of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SightRay {
    /// Index of the camera whose ray it is.
    pub camera: usize,
    /// From near that camera to far away.
    pub line_px: [DVec2; 2],
    /// The part within 0.3 m of the joint's depth, if it is in front of this camera.
    pub solid_px: Option<[DVec2; 2]>,
}

/// The point of the world that a pixel shows at a depth along the optical axis.
pub fn point_at(camera: &Camera, px: DVec2, depth_m: f64) -> Option<DVec3> {
    let per_depth = 1.0 / camera.ray_in_camera(px)?.z;
    Some(camera.centre() + camera.ray_in_world(px)? * (depth_m * per_depth))
}

/// The ray through `px` of camera `from` (of index `from_index`) as camera `into` sees it; solid where its depth
/// from `from` is within 0.3 m of `depth_m`. Both cameras have ideal lenses, so it is straight. `None` when
/// nothing of it is in front of `into`.
pub fn sight_ray(
    from: &Camera,
    from_index: usize,
    px: DVec2,
    depth_m: f64,
    into: &Camera,
) -> Option<SightRay> {
    let direction = from.ray_in_world(px)?;
    let distance_per_depth = 1.0 / from.ray_in_camera(px)?.z;
    let along = |distance: f64| from.centre() + direction * distance;
    let solid = [-SOLID_M, SOLID_M].map(|offset| (depth_m + offset).max(REACH_M[0]) * distance_per_depth);
    Some(SightRay {
        camera: from_index,
        line_px: project_segment(into, REACH_M.map(along))?,
        solid_px: project_segment(into, solid.map(along)),
    })
}

/// A segment's picture, without what is behind the camera.
pub fn project_segment(camera: &Camera, mut ends: [DVec3; 2]) -> Option<[DVec2; 2]> {
    let depths = ends.map(|end| camera.depth(end));
    for (end, other) in [(0, 1), (1, 0)] {
        if depths[end] < NEAREST_M {
            if depths[other] <= NEAREST_M {
                return None;
            }
            let share = (NEAREST_M - depths[end]) / (depths[other] - depths[end]);
            // A little further, so that rounding leaves it in front.
            ends[end] = ends[end].lerp(ends[other], (share * (1.0 + 1e-9)).min(1.0));
        }
    }
    let [a, b] = ends.map(|end| camera.project(end).filter(|px| px.is_finite()));
    a.zip(b).map(<[DVec2; 2]>::from)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};

    use super::*;

    fn camera(centre: DVec3, target: DVec3) -> Camera {
        let intrinsics = Intrinsics { fx: 400.0, fy: 400.0, cx: 160.0, cy: 120.0 };
        let place = CameraFromWorld::looking_at(centre, target, DVec3::Z);
        Camera::new("camera", [320, 240], intrinsics, Distortion::None, place).unwrap()
    }

    fn distance_from_line(point: DVec2, [a, b]: [DVec2; 2]) -> f64 {
        ((b - a).perp_dot(point - a) / (b - a).length()).abs()
    }

    #[test]
    fn the_point_itself_lies_on_the_solid_part() {
        let first = camera(DVec3::new(4.0, 0.0, 1.0), DVec3::Z);
        let second = camera(DVec3::new(-1.0, 4.0, 1.5), DVec3::Z);
        let point = DVec3::new(0.3, -0.2, 1.3);
        let px = first.project(point).unwrap();
        let ray = sight_ray(&first, 0, px, first.depth(point), &second).unwrap();
        let seen = second.project(point).unwrap();
        let solid = ray.solid_px.unwrap();
        assert!(distance_from_line(seen, ray.line_px) < 1e-9 && distance_from_line(seen, solid) < 1e-9);
        let share = (seen - solid[0]).dot(solid[1] - solid[0]) / (solid[1] - solid[0]).length_squared();
        assert!((0.3..0.7).contains(&share), "{share}");
    }

    #[test]
    fn what_is_behind_the_other_camera_is_cut_off() {
        let first = camera(DVec3::new(4.0, 0.0, 1.0), DVec3::Z);
        let facing = camera(DVec3::new(-4.0, 0.1, 1.0), DVec3::Z);
        let ray = sight_ray(&first, 0, DVec2::new(160.0, 120.0), 4.0, &facing).unwrap();
        assert!(ray.line_px.iter().all(|px| px.is_finite()));
        let away = camera(DVec3::new(4.1, 0.0, 1.0), DVec3::new(9.0, 0.0, 1.0));
        assert_eq!(sight_ray(&first, 0, DVec2::new(160.0, 120.0), 4.0, &away), None);
    }
}
