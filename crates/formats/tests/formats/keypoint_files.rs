//! Keypoints of other tools: tables of markers and `OpenPose`'s JSON, as their tools wrote them.

use std::path::Path;

use backlit_formats::{keypoints, trc};
use backlit_tracking::silhouette::Label;
use glam::DVec3;
use serde_json::Value;

use crate::calibration_files::formats;

pub(crate) fn expected(formats: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(formats.join("expected/motion").join(name)).unwrap()).unwrap()
}

#[test]
fn tables_of_markers_are_read_as_their_tools_wrote_them() {
    let Some(formats) = formats() else { return };
    for (file, expected) in expected(&formats, "trc.json").as_object().unwrap() {
        let path = formats.join(file);
        if !path.is_file() {
            continue;
        }
        let table =
            trc::parse(&path, &std::fs::read(&path).unwrap()).unwrap_or_else(|error| panic!("{error}"));
        let names: Vec<&str> =
            expected["markers"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
        assert_eq!(table.markers, names, "{file}");
        assert_eq!(table.rows.len() as u64, expected["rows"].as_u64().unwrap(), "{file}");
        let row = &table.rows[0];
        assert_eq!(row.frame, expected["first_frame_number"].as_u64().unwrap(), "{file}");
        assert!((row.time - expected["first_time"].as_f64().unwrap()).abs() < 1e-3, "{file}");
        let metres = if expected["header"]["Units"] == "mm" { 1e-3 } else { 1.0 };
        let numbers: Vec<Option<f64>> =
            expected["first_row_xyz"].as_array().unwrap().iter().map(Value::as_f64).collect();
        for (point, three) in row.points.iter().zip(numbers.chunks(3)) {
            let known = three.iter().copied().collect::<Option<Vec<f64>>>();
            match (point, known) {
                (Some(point), Some(known)) => {
                    let known = DVec3::from_slice(&known) * metres;
                    assert!(point.distance(known) < 2e-6, "{file}: {point} {known}");
                }
                (point, known) => assert!(point.is_none() && known.is_none(), "{file}: {point:?} {known:?}"),
            }
        }
    }
}

#[test]
fn people_are_read_and_covered_generously() {
    let Some(formats) = formats() else { return };
    for (file, expected) in expected(&formats, "openpose_json.json").as_object().unwrap() {
        let people = keypoints::read(&formats.join(file)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(people.len() as u64, expected["people"].as_u64().unwrap(), "{file}");
        for (person, count) in people.iter().zip(expected["keypoints"].as_array().unwrap()) {
            assert_eq!(person.len() as u64, count.as_u64().unwrap(), "{file}");
        }
        let Some(mask) = keypoints::generous_mask(&people, [1088, 1920], 4) else { continue };
        let sure = people.iter().flatten().flatten().filter(|keypoint| keypoint.score > 0.3);
        for keypoint in sure.filter(|keypoint| keypoint.place.x > 0.0 && keypoint.place.y > 0.0) {
            let [x, y] = keypoint.place.to_array().map(|side| side as usize / 4);
            assert_eq!(mask.labels()[y * 272 + x], Label::Subject, "{file} {x} {y}");
        }
        let share = mask.count(Label::Subject) as f64 / (272.0 * 480.0);
        assert!((0.02..0.4).contains(&share), "{file}: {share:.2} of the picture");
    }
}

/// People may stand half or wholly outside of the picture, and numbers may be absurd.
#[test]
fn people_outside_of_the_picture_cover_nothing_of_it() {
    for (x, y) in [(-900.0, 40.0), (40.0, -900.0), (-900.0, -900.0), (5000.0, 9000.0), (-1e300, 1e300)] {
        let places = (0..6).flat_map(|k| [x + f64::from(k) * 20.0, y + f64::from(k % 3) * 30.0, 0.9]);
        let numbers: Vec<String> = places.map(|number| format!("{number:e}")).collect();
        let text = format!("{{\"people\": [{{\"pose_keypoints_2d\": [{}]}}]}}", numbers.join(", "));
        let people = keypoints::parse(Path::new("a.json"), text.as_bytes()).unwrap();
        let mask = keypoints::generous_mask(&people, [320, 240], 2).unwrap();
        assert_eq!(mask.count(Label::Subject), 0, "{x} {y}");
    }
}
