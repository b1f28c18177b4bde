//! Cameras as other readers of their files would have them.

use glam::{DMat3, DVec3};

use crate::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};

/// The camera of pictures that were turned clockwise by so many quarters. `None` where that is no camera.
#[must_use]
pub fn turned_for(camera: &Camera, quarters: usize) -> Option<Camera> {
    (0..quarters % 4).try_fold(camera.clone(), |camera, _| quarter_turned(&camera))
}

/// (x, y) becomes (height − 1 − y, x).
fn quarter_turned(camera: &Camera) -> Option<Camera> {
    let k = camera.intrinsics();
    let height = camera.height() as f64;
    let intrinsics = Intrinsics { fx: k.fy, fy: k.fx, cx: height - 1.0 - k.cy, cy: k.cx };
    let turn = DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z);
    let place = camera.camera_from_world();
    let place = CameraFromWorld { rotation: turn * place.rotation, translation: turn * place.translation };
    // The tangential part is r² p + 2 (p · v) v with p = (p2, p1), which turns with the picture.
    let lens = match *camera.distortion() {
        Distortion::OpenCv { k1, k2, p1, p2, k3 } => Distortion::OpenCv { k1, k2, p1: p2, p2: -p1, k3 },
        Distortion::Rational { k1, k2, p1, p2, k3, k4, k5, k6 } => {
            Distortion::Rational { k1, k2, p1: p2, p2: -p1, k3, k4, k5, k6 }
        }
        other => other,
    };
    let size = [camera.height() as u64, camera.width() as u64];
    Camera::new(camera.name(), size, intrinsics, lens, place).ok()
}

/// The same camera at another place.
pub(super) fn placed(camera: &Camera, rotation: DMat3, translation: DVec3) -> Option<Camera> {
    let place = CameraFromWorld { rotation, translation };
    camera.with_numbers(*camera.intrinsics(), *camera.distortion(), place).ok()
}

/// The same camera with another pinhole and lens.
pub(super) fn with_lens(camera: &Camera, intrinsics: Intrinsics, lens: Distortion) -> Option<Camera> {
    camera.with_numbers(intrinsics, lens, *camera.camera_from_world()).ok()
}

/// The pinhole, lens and place of another camera, under the own name.
pub(super) fn renamed(camera: &Camera, numbers: &Camera) -> Option<Camera> {
    camera.with_numbers(*numbers.intrinsics(), *numbers.distortion(), *numbers.camera_from_world()).ok()
}

/// The 23 other ways to name the axes of a right-handed world, as rotations.
pub(super) fn axis_turns() -> Vec<DMat3> {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let mut all = Vec::new();
    for x in axes {
        for y in axes.into_iter().filter(|y| x.dot(*y) == 0.0) {
            let turn = DMat3::from_cols(x, y, x.cross(y));
            if turn != DMat3::IDENTITY {
                all.push(turn);
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::fixtures;

    #[test]
    fn a_turned_camera_sees_points_where_the_turned_picture_has_them() {
        let lens = Distortion::OpenCv { k1: -0.05, k2: 0.14, p1: 6e-3, p2: 7e-3, k3: 0.01 };
        let camera = fixtures::lens_camera(
            lens,
            [272, 480],
            [420.0, 421.0, 134.0, 238.5],
            [3.0, -1.0, 1.5],
            DVec3::Z,
            DVec3::Z,
        );
        for point in [DVec3::new(0.2, 0.3, 1.4), DVec3::new(-0.4, 0.1, 0.2)] {
            let pixel = camera.project(point).unwrap();
            let turned = turned_for(&camera, 1).unwrap().project(point).unwrap();
            assert!(turned.distance(DVec2::new(479.0 - pixel.y, pixel.x)) < 1e-9);
            let half = turned_for(&camera, 2).unwrap().project(point).unwrap();
            assert!(half.distance(DVec2::new(271.0 - pixel.x, 479.0 - pixel.y)) < 1e-9);
        }
        assert_eq!(axis_turns().len(), 23);
        assert!(axis_turns().iter().all(|turn| (turn.determinant() - 1.0).abs() < 1e-12));
    }
}
