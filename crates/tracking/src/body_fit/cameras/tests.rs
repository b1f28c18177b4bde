use glam::DMat3;

use super::*;
use crate::fixtures;

fn rig() -> Vec<Arc<Camera>> {
    let place = |(index, angle): (usize, f64)| {
        let centre = DVec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 1.2 + 0.2 * index as f64);
        let camera = fixtures::camera([80, 120], [90.0, 91.0, 39.5, 59.5], centre, DVec3::Z, DVec3::Z);
        let (pinhole, place) = (*camera.intrinsics(), *camera.camera_from_world());
        Arc::new(Camera::new(&format!("c{index}"), [80, 120], pinhole, *camera.distortion(), place).unwrap())
    };
    [0.3, 1.9, 3.4, 5.0].into_iter().enumerate().map(place).collect()
}

fn set(choice: CameraChoice) -> CameraSet {
    CameraSet::new(rig(), choice, &CameraDeviations::default(), &[], BTreeMap::new(), 30.0)
}

/// A world that moves, turns and grows a little, and clocks that all are late, are no change of any camera.
#[test]
fn common_motions_of_all_cameras_are_held() {
    let set = set(CameraChoice { offset: true, ..CameraChoice::default() });
    let (turn, shift, growth) = (DVec3::new(1e-5, -2e-5, 3e-5), DVec3::new(4e-5, 1e-5, -2e-5), 2e-5);
    let step: Vec<f64> = (rig().iter())
        .flat_map(|camera| {
            let moved = shift + turn.cross(camera.centre()) + growth * camera.centre();
            let turned = -(camera.camera_from_world().rotation * turn);
            [turned.to_array(), moved.to_array()].concat().into_iter().chain([0.7])
        })
        .collect();
    assert!(step.iter().any(|x| x.abs() > 1e-5));
    let held = set.in_gauge(&step);
    assert!(held.iter().all(|x| x.abs() < 1e-9), "{held}");
    // A camera alone is not.
    let mut alone = vec![0.0; set.columns()];
    alone[1] = 1e-3;
    let moved = set.in_gauge(&alone);
    assert!((moved[1] - 1e-3).abs() < 8e-4 && moved.norm() > 3e-4, "{moved}");
    let again = set.in_gauge(moved.as_slice());
    assert!((again - moved).norm() < 1e-12);
}

/// A step and its way back by the columns' numbers.
#[test]
fn numbers_are_what_steps_change() {
    let choice = CameraChoice { focal_length: true, principal_point: true, offset: true, drift: true };
    let set = set(choice);
    let step: Vec<f64> = (0..set.columns()).map(|column| 1e-4 * (column as f64 * 1.3).sin()).collect();
    let states = set.retract(&vec![CameraState::default(); set.given.len()], &step);
    let (numbers, expected) = (set.numbers(&states), set.in_gauge(&step));
    for (number, expected) in numbers.iter().zip(expected.iter()) {
        assert!((number - expected).abs() < 1e-12);
    }
    let camera = set.camera(2, &states[2]).unwrap();
    let turned = camera.camera_from_world().rotation * set.given[2].camera_from_world().rotation.transpose();
    let turn = states[2].change.turn;
    assert!((turned - DMat3::from_quat(exp(turn))).to_cols_array().iter().all(|x| x.abs() < 1e-12));
    assert!(((camera.intrinsics().fx / 90.0).ln() - states[2].change.zoom).abs() < 1e-12);
    assert!(camera.centre().distance(set.given[2].centre() + states[2].change.shift) < 1e-12);
}
