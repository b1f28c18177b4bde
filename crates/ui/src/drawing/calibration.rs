//! What a calibration shows in a camera's picture: its principal point, the axes of the world, a grid through the world's
//! origin, the edge of what the lens saw, and the sight ray of another camera's pixel (its epipolar line).

use backlit_tracking::camera::Camera;
use glam::{DVec2, DVec3};

/// Length of a world axis, metres.
const AXIS_M: f64 = 0.5;
/// Side of a cell of the grid, metres.
const GRID_CELL_M: f64 = 0.5;
/// Cells from the origin to the grid's edge.
const GRID_CELLS: i32 = 4;
/// Points along each side of the raw picture for the lens edge.
const EDGE_POINTS: usize = 24;

/// Marks of one camera, in pixel coordinates of its picture without distortion.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationMarks {
    /// Where the optical axis meets the picture.
    pub principal_px: DVec2,
    /// x, y and z of the world from its origin, half a metre each; `None` behind the camera.
    pub axes_px: [Option<[DVec2; 2]>; 3],
    /// Lines of a grid of half-metre cells through the world's origin, across the axis that is most nearly vertical
    /// in this camera.
    pub grid_px: Vec<[DVec2; 2]>,
    /// The border of the raw picture, closed; empty for a lens without distortion.
    pub lens_edge_px: Vec<DVec2>,
}

impl CalibrationMarks {
    /// The marks of a camera without distortion; `raw` is the camera as it was calibrated.
    pub fn new(camera: &Camera, raw: Option<&Camera>) -> Self {
        let intrinsics = camera.intrinsics();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let down_in_world = camera.camera_from_world().rotation.transpose().y_axis;
        let up =
            (0..3).max_by(|a, b| down_in_world[*a].abs().total_cmp(&down_in_world[*b].abs())).unwrap_or(2);
        let [along, across] = [axes[(up + 1) % 3], axes[(up + 2) % 3]];
        let reach = f64::from(GRID_CELLS) * GRID_CELL_M;
        let lines = (-GRID_CELLS..=GRID_CELLS).flat_map(|cell| {
            let at = f64::from(cell) * GRID_CELL_M;
            [(along, across), (across, along)]
                .map(|(run, side)| [side * at - run * reach, side * at + run * reach])
        });
        Self {
            principal_px: DVec2::new(intrinsics.cx, intrinsics.cy),
            axes_px: axes.map(|axis| project_segment(camera, [DVec3::ZERO, axis * AXIS_M])),
            grid_px: lines.filter_map(|ends| project_segment(camera, ends)).collect(),
            lens_edge_px: raw.map_or_else(Vec::new, |raw| lens_edge(camera, raw)),
        }
    }
}

/// Where the border of the raw picture comes to lie.
fn lens_edge(camera: &Camera, raw: &Camera) -> Vec<DVec2> {
    if raw.distortion().is_none() {
        return Vec::new();
    }
    let far = DVec2::new(raw.width() as f64 - 0.5, raw.height() as f64 - 0.5);
    let corners = [DVec2::splat(-0.5), DVec2::new(far.x, -0.5), far, DVec2::new(-0.5, far.y)];
    let sides = (0..4).flat_map(|side| {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        (0..EDGE_POINTS).map(move |point| from.lerp(to, point as f64 / EDGE_POINTS as f64))
    });
    let ideal = |px: DVec2| {
        let plane = raw.distortion().undistort(raw.intrinsics().plane_from_pixel(px))?;
        Some(camera.intrinsics().pixel_from_plane(plane)).filter(|px| px.is_finite())
    };
    sides.filter_map(ideal).collect()
}

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

    fn camera(distortion: Distortion) -> Camera {
        let intrinsics = Intrinsics { fx: 300.0, fy: 300.0, cx: 160.0, cy: 120.0 };
        let place = CameraFromWorld::looking_at(DVec3::new(3.0, -2.0, 1.5), DVec3::Z * 0.5, DVec3::Z);
        Camera::new("camera", [320, 240], intrinsics, distortion, place).unwrap()
    }

    #[test]
    fn axes_begin_at_the_origin_and_the_grid_lies_on_the_floor() {
        let camera = camera(Distortion::None);
        let marks = CalibrationMarks::new(&camera, Some(&camera));
        let origin = camera.project(DVec3::ZERO).unwrap();
        for (axis, ends) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(marks.axes_px) {
            let [from, to] = ends.unwrap();
            assert!(from.distance(origin) < 1e-9 && to.distance(camera.project(axis * 0.5).unwrap()) < 1e-9);
        }
        assert_eq!((marks.grid_px.len(), marks.lens_edge_px.len()), (18, 0));
        let corner = camera.project(DVec3::new(-2.0, -2.0, 0.0)).unwrap();
        assert!(marks.grid_px.iter().flatten().any(|px| px.distance(corner) < 1e-6), "z is up");
    }

    #[test]
    fn a_barrel_lens_saw_beyond_the_picture_and_its_edge_bulges() {
        let raw = camera(Distortion::OpenCv { k1: -0.2, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 });
        let marks = CalibrationMarks::new(&raw.without_distortion(), Some(&raw));
        let corner = marks.lens_edge_px[0];
        assert!(corner.x < -1.0 && corner.y < -1.0, "{corner}");
        let raw_corner = raw.distortion().distort(raw.intrinsics().plane_from_pixel(corner));
        assert!(raw.intrinsics().pixel_from_plane(raw_corner).distance(DVec2::splat(-0.5)) < 1e-6);
    }

    fn camera_at(centre: DVec3, target: DVec3) -> Camera {
        crate::drawing::input::tests::camera([320, 240], [400.0, 160.0, 120.0], centre, target, DVec3::Z)
    }

    fn distance_from_line(point: DVec2, [a, b]: [DVec2; 2]) -> f64 {
        ((b - a).perp_dot(point - a) / (b - a).length()).abs()
    }

    #[test]
    fn the_point_itself_lies_on_the_solid_part() {
        let first = camera_at(DVec3::new(4.0, 0.0, 1.0), DVec3::Z);
        let second = camera_at(DVec3::new(-1.0, 4.0, 1.5), DVec3::Z);
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
        let first = camera_at(DVec3::new(4.0, 0.0, 1.0), DVec3::Z);
        let facing = camera_at(DVec3::new(-4.0, 0.1, 1.0), DVec3::Z);
        let ray = sight_ray(&first, 0, DVec2::new(160.0, 120.0), 4.0, &facing).unwrap();
        assert!(ray.line_px.iter().all(|px| px.is_finite()));
        let away = camera_at(DVec3::new(4.1, 0.0, 1.0), DVec3::new(9.0, 0.0, 1.0));
        assert_eq!(sight_ray(&first, 0, DVec2::new(160.0, 120.0), 4.0, &away), None);
    }
}
