//! What a calibration says, drawn into the camera's picture: its principal point, the axes of the world, a grid through
//! the world's origin, and the edge of what the lens saw.

use backlit_tracking::camera::Camera;
use glam::{DVec2, DVec3};

use super::sight_ray::project_segment;

/// Length of a world axis, metres.
const AXIS_M: f64 = 0.5;
/// Side of a cell of the grid, metres.
pub const GRID_CELL_M: f64 = 0.5;
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
}
