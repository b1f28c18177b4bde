//! Calibrations as the tools wrote them, against what an independent reader finds in each.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use backlit_formats::calibration::{self, Calibration, CalibrationOptions};
use backlit_tracking::camera::{Camera, Distortion};
use glam::{DMat3, DVec2, DVec3};
use serde_json::Value;

use crate::footage::footage;

const TOLERANCE: f64 = 1e-6;

/// The folder of the files, beside the footage; without it the test is to be skipped.
pub(crate) fn formats() -> Option<PathBuf> {
    let formats = footage()?.with_file_name("formats");
    if formats.is_dir() {
        return Some(formats);
    }
    let is_required = std::env::var_os("BACKLIT_REQUIRE_DATA").is_some_and(|required| required == "1");
    assert!(
        !is_required,
        "BACKLIT_REQUIRE_DATA=1, and there are no files of other tools in {}",
        formats.display()
    );
    // Not by a macro: what those print of a test that passes is not shown.
    let mut screen = std::io::stderr();
    writeln!(screen, "SKIPPED files of other tools: there are none in {}", formats.display()).unwrap();
    None
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().unwrap()],
    }
}

/// What a file lacks must be told: the size where the expected one has none.
fn options(expected: &Value) -> CalibrationOptions {
    let has_size = expected["cameras"][0]["width"].is_u64();
    CalibrationOptions { size: (!has_size).then_some([1920, 1080]), ..CalibrationOptions::default() }
}

fn load(folder: &Path, expected: &Value) -> Result<Calibration, String> {
    let files: Vec<PathBuf> = expected["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|file| {
            let file = file.as_str().unwrap();
            let plain = folder.join(file);
            if plain.is_file() { plain } else { folder.join(expected["format"].as_str().unwrap()).join(file) }
        })
        .collect();
    let options = options(expected);
    let alone = calibration::load(&files[0], options).map_err(|error| error.to_string());
    if files.len() == 2 {
        // Both ways to the second file lead to the same, and either may come first.
        let [a, b] =
            [[0, 1], [1, 0]].map(|[a, b]| calibration::load_pair(&files[a], &files[b], options).unwrap());
        assert_eq!(a, b);
        assert_eq!(a, alone.clone().unwrap());
        assert_eq!(a, calibration::load(&files[1], options).unwrap());
    }
    alone
}

/// Everything that is different, in words.
fn differences(camera: &Camera, expected: &Value) -> Vec<String> {
    let mut out = Vec::new();
    let mut check = |what: &str, found: &[f64], wanted: &[f64]| {
        let scale = wanted.iter().fold(1.0_f64, |scale, x| scale.max(x.abs()));
        let same = found.len() == wanted.len()
            && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= TOLERANCE * scale.min(1e3));
        if !same {
            out.push(format!("{}: {what} is {found:?}; expected {wanted:?}", camera.name()));
        }
    };
    let (width, height) = (camera.width() as f64, camera.height() as f64);
    let wanted_size =
        [("width", width), ("height", height)].map(|(key, own)| expected[key].as_f64().unwrap_or(own));
    check("size", &[width, height], &wanted_size);
    let k = camera.intrinsics();
    if expected["fx"].is_number() {
        let wanted = ["fx", "fy", "cx", "cy"].map(|key| expected[key].as_f64().unwrap());
        check("K", &[k.fx, k.fy, k.cx, k.cy], &wanted);
    } else {
        // Only the picture's angle is known: 0.6911112070083618 across.
        let fx = width / 2.0 / (0.5_f64 * 0.6911112070083618).tan();
        check("K", &[k.fx, k.fy, k.cx, k.cy], &[fx, fx, width / 2.0 - 0.5, height / 2.0 - 0.5]);
    }
    let lens = &expected["distortion"];
    let model = lens["model"].as_str().unwrap_or_default();
    assert_eq!(
        model.contains("fisheye"),
        matches!(camera.distortion(), Distortion::Fisheye { .. }),
        "{model}"
    );
    if !model.contains("fitted") {
        let mut wanted = numbers(&lens["coefficients"]);
        let mut found: Vec<f64> =
            camera.distortion().coefficients().iter().map(|(_, value)| *value).collect();
        let count = wanted.len().max(found.len());
        wanted.resize(count, 0.0);
        found.resize(count, 0.0);
        check("distortion", &found, &wanted);
    }
    let place = camera.camera_from_world();
    let (rotation, translation) = if expected["rotation"].is_null() {
        (DMat3::IDENTITY, DVec3::ZERO)
    } else {
        let rows: [f64; 9] = numbers(&expected["rotation"]).try_into().unwrap();
        (DMat3::from_cols_array(&rows).transpose(), DVec3::from_slice(&numbers(&expected["translation"])))
    };
    check("R", &place.rotation.to_cols_array(), &rotation.to_cols_array());
    check("t", &place.translation.to_array(), &translation.to_array());
    check("centre", &camera.centre().to_array(), &(-(rotation.transpose() * translation)).to_array());
    out
}

#[test]
fn every_file_is_read_as_an_independent_reader_reads_it() {
    let Some(formats) = formats() else { return };
    let mut tables: Vec<PathBuf> = std::fs::read_dir(formats.join("expected/calibration"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .collect();
    tables.sort();
    let (mut wrong, mut compared) = (Vec::new(), 0);
    for table in &tables {
        let expected: Value = serde_json::from_str(&std::fs::read_to_string(table).unwrap()).unwrap();
        let title = table.file_stem().unwrap().to_string_lossy().into_owned();
        let found = match load(&formats.join("calibration"), &expected) {
            // MATLAB's files have skew, which no camera of ours has, and are refused in words.
            Err(message) if title == "matlab_dannce" && message.contains("MATLAB's files are not read") => {
                continue;
            }
            Err(message) => {
                wrong.push(format!("{title}: {message}"));
                continue;
            }
            Ok(found) => found,
        };
        let mut wanted = 0;
        for expected in expected["cameras"].as_array().unwrap() {
            let name = expected["name"].as_str().unwrap();
            let is_unusable = expected["kind"].as_str().is_some_and(|kind| kind.contains("no video"))
                || expected["camera_model"] == "omni";
            let index = found.rig.index(name);
            if is_unusable {
                let is_left_out = found.left_out.iter().any(|left| left.name == name);
                if index.is_ok() || !is_left_out {
                    wrong.push(format!("{title}: {name} should be left out, and said so"));
                }
                continue;
            }
            wanted += 1;
            match index {
                Ok(index) => {
                    let differences = differences(&found.rig.cameras()[index], expected);
                    wrong.extend(differences.into_iter().map(|text| format!("{title}: {text}")));
                    compared += 1;
                }
                Err(error) => wrong.push(format!("{title}: {error}")),
            }
        }
        // Of one file only the first twenty pictures are listed.
        let listed = if title.contains("nerfstudio_opencv") { 1098 } else { wanted };
        if found.rig.count() != listed {
            wrong.push(format!("{title}: {} cameras; expected {listed}", found.rig.count()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(tables.len() >= 22 && compared >= 60, "{} files, {compared} cameras", tables.len());
}

/// OpenCV's lens cannot be Vicon's exactly. The expected file's own fit is up to 6 px off in the corners.
#[test]
fn the_lens_of_vicon_is_met_within_a_fraction_of_a_pixel() {
    let Some(formats) = formats() else { return };
    let text = std::fs::read_to_string(formats.join("expected/calibration/vicon_xcp__testCalibration.json"))
        .unwrap();
    let expected: Value = serde_json::from_str(&text).unwrap();
    let path = formats.join("calibration/vicon_xcp/testCalibration.xcp");
    let rig = calibration::read(&path, CalibrationOptions::default()).unwrap();
    let mut compared = 0;
    for camera in rig.cameras() {
        let expected =
            expected["cameras"].as_array().unwrap().iter().find(|other| other["name"] == camera.name());
        let expected = expected.unwrap();
        let k = numbers(&expected["vicon_distortion"]["k"]);
        let centre = DVec2::from_slice(&numbers(&expected["vicon_distortion"]["centre"]));
        for index in 0..81_u32 {
            let place = DVec2::new(f64::from(index % 9), f64::from(index / 9)) / 8.0;
            let measured = place * DVec2::new(camera.width() as f64 - 1.0, camera.height() as f64 - 1.0);
            let r2 = measured.distance_squared(centre);
            let ideal = centre + (measured - centre) * (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])));
            let pinhole = camera.intrinsics();
            let bent = camera.distortion().distort(pinhole.plane_from_pixel(ideal));
            let error = pinhole.pixel_from_plane(bent).distance(measured);
            assert!(error < 0.4, "{} at {measured}: {error} px", camera.name());
            compared += 1;
        }
    }
    assert_eq!(compared, 5 * 81);
}
