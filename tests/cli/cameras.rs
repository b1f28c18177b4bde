//! `backlit cameras`: a calibration told, and the same in the formats of other tools.

use std::fs;

use backlit_formats::calibration::{self, CalibrationOptions};

use crate::scene::Scene;

#[test]
fn cameras_go_to_other_tools_and_come_back() {
    let scene = Scene::new();
    let read = |name: &str| {
        let options = CalibrationOptions { size: Some([128, 96]), metres_per_unit: 1.0 };
        calibration::read(&scene.path(name), options).unwrap()
    };
    let before = read("cameras.json");
    let table = scene.ok("cameras cameras.json");
    assert!(table.contains("front") && table.contains("side") && table.contains("128"), "{table}");
    // What is printed as JSON is a calibration again.
    scene.write("printed.json", &scene.ok("cameras cameras.json --json"));
    assert_eq!(read("printed.json").cameras(), before.cameras());

    for (format, file) in [
        ("opencv-yaml", "c.yml"),
        ("opencv-xml", "c.xml"),
        ("opencv-json", "c.json"),
        ("pose2sim", "Calib.toml"),
        ("anipose", "calibration.toml"),
        ("easymocap", "easymocap"),
    ] {
        scene.ok(&format!("cameras cameras.json --to {format} --out {file}"));
        let back = read(file);
        for (before, back) in before.cameras().iter().zip(back.cameras()) {
            assert_eq!(before.name(), back.name(), "{format}");
            assert!(before.centre().distance(back.centre()) < 1e-6, "{format}");
            assert!((before.intrinsics().fx - back.intrinsics().fx).abs() < 1e-6, "{format}");
            assert_eq!(before.distortion().is_none(), back.distortion().is_none(), "{format}");
        }
    }
    assert!(scene.path("easymocap/intri.yml").is_file());

    scene.fails("cameras cameras.json --to fbx --out c", 2, &["--to", "opencv-yaml"]);
    scene.fails("cameras cameras.json --to anipose", 2, &["--out"]);
    scene.fails("cameras nothing.toml", 1, &["nothing.toml"]);
    fs::write(scene.path("empty.toml"), "").unwrap();
    scene.fails("cameras empty.toml", 1, &["empty.toml"]);
}
