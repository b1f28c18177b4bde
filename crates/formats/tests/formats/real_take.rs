//! The take of the real footage, `tests/takes/balancing`, and calibrations of the same cameras in two formats.

use std::path::{Path, PathBuf};

use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::{Take, model_file};
use backlit_tracking::body::builtin;
use glam::DVec2;

use crate::footage::footage;

fn take_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/takes/balancing")
}

#[test]
fn the_person_has_the_structure_of_the_full_body() {
    let person = model_file::read(&take_folder().join("body.toml")).unwrap();
    let body = builtin::full_body();
    for (limb, usual) in person.limbs().iter().zip(body.limbs()) {
        assert_eq!((&limb.name, limb.parent, limb.rotation), (&usual.name, usual.parent, usual.rotation));
        assert_eq!(limb.limits, usual.limits, "{}", limb.name);
    }
    assert_eq!(person.limbs().len(), body.limbs().len());
}

#[test]
fn the_take_opens_with_everything_in_it() {
    if footage().is_none() {
        return;
    }
    let take = Take::open(&take_folder()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((take.frame_count(), take.frame_rate(), take.rig().count()), (70, 60.0, 4));
    let reference = take.reference().unwrap();
    // Columns and rows that the person fills in frame 5.
    let boxes = [
        (60.0..150.0, 75.0..305.0),
        (95.0..190.0, 90.0..290.0),
        (105.0..201.0, 98.0..341.0),
        (30.0..170.0, 110.0..360.0),
    ];
    for (index, (camera, (columns, rows))) in take.rig().cameras().iter().zip(boxes).enumerate() {
        let last = take.frame(index, 69).unwrap();
        assert_eq!((last.width() as usize, last.height() as usize), (camera.width(), camera.height()));
        assert_eq!(take.background(index).unwrap().len(), 1);
        // The keypoints are where this camera sees the person.
        for (marker, _, position) in reference.frame(5) {
            let pixel = camera.project(position).unwrap();
            let name = &reference.markers()[marker].0;
            assert!(
                columns.contains(&pixel.x) && rows.contains(&pixel.y),
                "{} {name}: {pixel}",
                camera.name()
            );
        }
        assert_eq!(reference.frame(5).count(), reference.markers().len());
    }
}

#[test]
fn two_formats_of_one_calibration_agree() {
    let Some(footage) = footage() else { return };
    let size = CalibrationOptions { size: Some([544, 960]), ..CalibrationOptions::default() };
    for options in [CalibrationOptions::default(), size] {
        let matrices = calibration::read(&footage.join("calib/cameras_original.json"), options).unwrap();
        let qualisys = calibration::read(&footage.join("calib/Calib.qca.txt"), options).unwrap();
        assert_eq!(matrices.count(), 4);
        for (a, b) in matrices.cameras().iter().zip(qualisys.cameras()) {
            let name = a.name();
            assert_eq!((name, a.width(), a.height()), (b.name(), b.width(), b.height()));
            assert!(a.centre().distance(b.centre()) < 1e-6, "{name}: {} {}", a.centre(), b.centre());
            // Corners and edges of the picture, where a lens bends most, at several depths.
            let mut compared = 0;
            for (column, row, metres) in every(5, 5, [1.0, 3.0, 8.0]) {
                let pixel = DVec2::new(column * (a.width() as f64 - 1.0), row * (a.height() as f64 - 1.0));
                let Some(ray) = a.ray_in_world(pixel) else { continue };
                let point = a.centre() + metres * ray;
                let (p, q) = (a.project(point).unwrap(), b.project(point).unwrap());
                assert!(p.distance(pixel) < 1e-6 && p.distance(q) < 1e-6, "{name}: {pixel} {p} {q}");
                compared += 1;
            }
            assert_eq!(compared, 75, "{name}");
        }
    }
}

/// Places across and down a picture, 0 to 1, each at these depths.
fn every(across: usize, down: usize, depths: [f64; 3]) -> impl Iterator<Item = (f64, f64, f64)> {
    let place = |index: usize, count: usize| index as f64 / (count - 1) as f64;
    (0..across * down * depths.len()).map(move |index| {
        let (at, depth) = (index / depths.len(), depths[index % depths.len()]);
        (place(at % across, across), place(at / across, down), depth)
    })
}
