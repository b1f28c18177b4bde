//! Where to put cameras: what more cameras bring, and from where.

use std::sync::Arc;

use backlit_tracking::body::builtin;
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::fit::FitOptions;
use backlit_tracking::observability::Noise;
use backlit_tracking::observability::plan::{
    CameraPlan, Floor, FloorArea, LOST_M, PLANNED_NOISE, PlaceFigures, camera_ring,
};
use glam::DVec3;

const FLOOR: Floor = Floor { up: DVec3::Z, height_m: 0.0 };
const DISTANCE: f64 = 4.0;
const HEIGHT: f64 = 1.3;

/// A camera at an angle about the middle of the floor, degrees.
fn camera(degrees: f64, distance: f64) -> Arc<Camera> {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let at = FLOOR.point([distance * cosine, distance * sine], HEIGHT);
    let intrinsics = Intrinsics { fx: 180.0, fy: 180.0, cx: 59.5, cy: 79.5 };
    let place = CameraFromWorld::looking_at(at, DVec3::new(0.0, 0.0, 0.9), DVec3::Z);
    let name = format!("at {degrees}");
    Arc::new(Camera::new(&name, [120, 160], intrinsics, Distortion::None, place).unwrap())
}

fn plan(cameras: &[Arc<Camera>], sets: &[&[usize]]) -> CameraPlan {
    let model = Arc::new(builtin::full_body());
    let sets = sets.iter().map(|set| set.to_vec()).collect();
    let area = FloorArea::new([0.0; 2], [2.0; 2], 2);
    let noise = Noise::white(PLANNED_NOISE);
    CameraPlan::new(&model, (FLOOR, &area), cameras, sets, noise, &FitOptions::default()).unwrap()
}

#[test]
fn a_camera_more_never_makes_a_deviation_larger() {
    let cameras = [0.0, 40.0, 90.0, 200.0].map(|degrees| camera(degrees, DISTANCE));
    let found = plan(&cameras, &[&[0], &[0, 1], &[0, 1, 2], &[0, 1, 2, 3]]);
    for place in [[0.0, 0.0], [0.6, -0.4]] {
        for pair in found.at(place).windows(2) {
            let [fewer, more] = [pair[0], pair[1]];
            assert!(more.mean_m <= fewer.mean_m && more.known >= fewer.known, "{fewer:?} {more:?}");
            assert!(more.median_m <= fewer.median_m && more.worst.1 <= fewer.worst.1, "{fewer:?} {more:?}");
        }
    }
}

#[test]
fn cameras_that_look_along_one_line_are_worse_than_two_at_a_right_angle() {
    let cameras = [0.0, 90.0, 180.0].map(|degrees| camera(degrees, DISTANCE));
    let found = plan(&cameras, &[&[0, 1], &[0, 2], &[0]]).at([0.0, 0.0]);
    let [across, along, alone] = [0, 1, 2].map(|set: usize| found[set]);
    assert!(across.mean_m < 0.7 * along.mean_m, "{across:?} {along:?}");
    assert!(along.mean_m < alone.mean_m);
}

#[test]
fn what_no_camera_sees_has_no_bound() {
    let cameras = [0.0, 90.0].map(|degrees| camera(degrees, DISTANCE));
    let found = plan(&cameras, &[&[0, 1], &[]]);
    let unseen = |figures: &PlaceFigures| {
        (figures.mean_m - LOST_M).abs() < 1e-12 && figures.known == 0.0 && figures.median_m == f64::INFINITY
    };
    assert!(found.at([20.0, 30.0]).iter().all(unseen), "behind both");
    let middle = found.at([0.0, 0.0]);
    assert!(unseen(&middle[1]) && middle[0].known > 0.8, "{middle:?}");
}

#[test]
fn threads_change_no_bit() {
    let cameras = [0.0, 100.0, 230.0].map(|degrees| camera(degrees, DISTANCE));
    let plan = plan(&cameras, &[&[0, 1], &[0, 2], &[0, 1, 2]]);
    let of_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| plan.at([0.3, 0.1]))
    };
    assert_eq!(of_threads(1), of_threads(3));
}

#[test]
fn beside_a_lone_camera_the_best_place_is_about_a_right_angle_away() {
    let lone = camera(0.0, DISTANCE);
    let ring = camera_ring(&lone, &FLOOR, [0.0; 2], [DISTANCE, HEIGHT], 12, "place").unwrap();
    let mut cameras = vec![lone];
    cameras.extend(ring);
    let sets: Vec<Vec<usize>> = (1..=12).map(|added| vec![0, added]).collect();
    let sets: Vec<&[usize]> = sets.iter().map(Vec::as_slice).collect();
    let found = plan(&cameras, &sets).at([0.0, 0.0]);
    let best = (0..12).min_by(|&a, &b| found[a].mean_m.total_cmp(&found[b].mean_m)).unwrap();
    let degrees = (30.0 * best as f64 + 180.0).rem_euclid(360.0) - 180.0;
    assert!((degrees.abs() - 90.0).abs() <= 30.0, "{degrees}: {found:?}");
    assert!(found[best].mean_m < 0.7 * found[0].mean_m, "no better than the same place twice");
}

#[test]
fn pictures_finer_than_the_solver_is_meant_for_tell_no_more() {
    let mean = |times: u32| {
        let finer = [0.0, 80.0].map(|degrees| {
            let size = [120, 160].map(|side| side * u64::from(times));
            let scale = DVec3::splat(f64::from(times)).truncate();
            Arc::new(camera(degrees, DISTANCE).remapped(size, scale, DVec3::ZERO.truncate()).unwrap())
        });
        plan(&finer, &[&[0, 1]]).at([0.0, 0.0])[0].mean_m
    };
    // A forearm's radius is 1.8 pixels times this; the stages are meant for 4.6.
    let [coarse, fine, finest] = [1, 4, 8].map(mean);
    assert!((finest / fine - 1.0).abs() < 0.1, "{fine} {finest}");
    assert!(coarse > 1.5 * fine, "coarse pictures tell less: {coarse} {fine}");
}

#[test]
fn the_area_is_where_two_cameras_see_a_person() {
    let cameras = [0.0, 90.0, 180.0, 270.0].map(|degrees| camera(degrees, 6.0));
    let area = FloorArea::seen_by(&cameras, &FLOOR, 5).unwrap();
    assert!(area.middle.iter().all(|along| along.abs() < 0.3), "{area:?}");
    assert!(area.size_m.iter().all(|side| (1.5..6.1).contains(side)), "{area:?}");
    assert_eq!(area.cells, [5, 5]);
    let places = area.places();
    assert_eq!(places.len(), 25);
    let middle = FLOOR.place(FLOOR.point(places[12], 0.7));
    assert!((0..2).all(|axis| (middle[axis] - area.middle[axis]).abs() < 1e-9));
    let away = [camera(0.0, 6.0)].map(|camera| {
        let up = CameraFromWorld::looking_at(camera.centre(), camera.centre() + DVec3::Z, DVec3::X);
        Arc::new(Camera::new("up", [120, 160], *camera.intrinsics(), Distortion::None, up).unwrap())
    });
    assert_eq!(FloorArea::seen_by(&away, &FLOOR, 5), None, "it looks at the ceiling");
}
