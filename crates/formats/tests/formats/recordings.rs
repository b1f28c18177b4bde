//! Recordings of motion as tools wrote them, against what an independent reader finds.

use std::path::Path;

use backlit_formats::recording::{self, RecordingOptions};
use glam::DVec3;

use crate::calibration_files::formats;
use crate::keypoint_files::expected;

fn read(formats: &Path, file: &str) -> recording::Recording {
    let options = RecordingOptions { frame_rate: Some(30.0), ..RecordingOptions::default() };
    recording::read(&formats.join(file), &options).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn c3d_files_are_read_as_another_reader_reads_them() {
    let Some(formats) = formats() else { return };
    for (file, expected) in expected(&formats, "c3d.json").as_object().unwrap() {
        let recording = read(&formats, file);
        let names: Vec<&str> =
            expected["markers"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
        assert_eq!(recording.names, names, "{file}");
        assert_eq!(recording.times.len() as u64, expected["frames"].as_u64().unwrap(), "{file}");
        let first = expected["first_frame"].as_f64().unwrap() - 1.0;
        assert!((recording.times[0] - first / expected["rate"].as_f64().unwrap()).abs() < 1e-9, "{file}");
        let middle = recording.times.len() / 2;
        for (frame, key) in [(0, "first_frame_xyz_residual"), (middle, "middle_frame_xyz_residual")] {
            for (point, known) in recording.points[frame].iter().zip(expected[key].as_array().unwrap()) {
                let known: Vec<f64> =
                    known.as_array().unwrap().iter().map(|n| n.as_f64().unwrap_or(f64::NAN)).collect();
                let is_seen = known[3] >= 0.0 && known[..3] != [0.0; 3];
                assert_eq!(point.is_some(), is_seen, "{file}, frame {frame}: {known:?}");
                if let Some(point) = point {
                    assert!(
                        point.distance(1e-3 * DVec3::from_slice(&known)) < 2e-6,
                        "{file}: {point} {known:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn tables_of_coordinates_are_read_as_another_reader_reads_them() {
    let Some(formats) = formats() else { return };
    for (file, expected) in expected(&formats, "mot.json").as_object().unwrap() {
        let recording = read(&formats, file);
        assert_eq!(recording.times.len() as u64, expected["rows"].as_u64().unwrap(), "{file}");
        let columns: Vec<&str> =
            expected["columns"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
        for (row, key) in [(0, "first_row"), (recording.times.len() - 1, "last_row")] {
            let numbers: Vec<f64> =
                expected[key].as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).collect();
            assert!((recording.times[row] - numbers[0]).abs() < 1e-6, "{file}");
            for (name, number) in columns.iter().zip(numbers) {
                if let Some(curve) = recording.angles.get(*name) {
                    assert!((curve[row].to_degrees() - number).abs() < 2e-6, "{file}: {name}");
                }
            }
        }
    }
}

/// Joints of every tool are known by their names.
#[test]
fn joints_of_all_tools_are_known() {
    let Some(formats) = formats() else { return };
    let options = RecordingOptions::default();
    for (file, joints, angles) in [
        ("motion/trc/opencap_Squats_0.trc", 12, 0),
        ("motion/trc/pose2sim_static_0-12.trc", 12, 0),
        ("motion/trc/caliscope_xyz_SIMPLE_HOLISTIC.trc", 12, 0),
        ("motion/bvh/mixamo.bvh", 12, 0),
        ("motion/bvh/mocapbank.bvh", 12, 0),
        ("motion/bvh/pymo_AV_8Walk_Meredith.bvh", 12, 0),
        ("motion/mot/opencap_Squats_0.mot", 0, 8),
    ] {
        let trajectories = read(&formats, file).trajectories(Path::new(file), &options).unwrap();
        assert_eq!((trajectories.joints.len(), trajectories.angles.len()), (joints, angles), "{file}");
    }
    let ids = read(&formats, "motion/caliscope_csv/xyz_SIMPLE_HOLISTIC.csv");
    assert!(
        ids.trajectories(Path::new("a.csv"), &options).is_err() && ids.names.len() > 70,
        "{}",
        ids.names.len()
    );
}
