//! Files with values that are not numbers, or with absurd sizes, are refused with the field's name.

use std::path::Path;

use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::model_file;
use backlit_formats::pose_file::{self, Quaternions};
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::DVec3;

/// The files of `render` and `fit` take the same checks.
#[test]
fn files_with_such_numbers_are_errors_that_name_the_field() {
    let model = builtin::single_limb();
    let pinhole = Intrinsics { fx: 40.0, fy: 41.0, cx: 11.5, cy: 8.5 };
    let place = CameraFromWorld::looking_at(DVec3::new(0.3, 0.2, 2.0), DVec3::new(0.0, 0.2, 0.0), DVec3::Y);
    let camera = Camera::new("camera", [24, 18], pinhole, Distortion::None, place).unwrap();
    let rig = Rig::new(vec![camera]).unwrap();
    let cameras = calibration::backlit::to_text(&rig);
    for (field, from, to) in [
        ("fx", "\"fx\": 40", "\"fx\": 0"),
        ("fy", "\"fy\": 41", "\"fy\": -41"),
        ("width", "\"width\": 24", "\"width\": 0"),
        ("height", "\"height\": 18", "\"height\": 2147483648"),
    ] {
        let changed = cameras.replacen(from, to, 1);
        assert_ne!(changed, cameras, "{from} is not in {cameras}");
        let error =
            calibration::parse(Path::new("cameras.json"), changed.as_bytes(), CalibrationOptions::default());
        let text = error.unwrap_err().to_string();
        assert!(text.contains(field) && text.contains("cameras.json"), "{field}: {text}");
    }
    let text = model_file::to_text(&model);
    for field in ["length", "radius"] {
        let line = text.lines().find(|line| line.starts_with(field)).unwrap();
        for value in ["0.0", "-1", "nan", "inf", "1e200"] {
            let changed = text.replacen(line, &format!("{field} = {value}"), 1);
            let error =
                model_file::parse(Path::new("body.toml"), changed.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(field) && error.contains("body.toml"), "{field} = {value}: {error}");
        }
    }
    let pose = pose_file::to_text(&model, &Pose::rest(&model));
    for bad in ["1e999", "NaN", "null", "1e200"] {
        let changed = format!("{{\"format\": \"backlit-pose 1\", \"root\": [0, {bad}, 0]}}");
        let found =
            pose_file::parse(Path::new("pose.json"), changed.as_bytes(), &model, Quaternions::Normalised);
        assert!(found.unwrap_err().to_string().contains("pose.json"), "{bad}");
    }
    assert!(pose_file::parse(Path::new("pose.json"), pose.as_bytes(), &model, Quaternions::Raw).is_ok());
}
