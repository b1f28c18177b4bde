//! `backlit compare`: a track beside its own exports, which differ from it in axes, unit and names, and beside what is off.

use std::fs;

use backlit_formats::export::{TrackExport, track_json};
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::track::{FrameEstimate, Track};
use glam::{DQuat, DVec3};
use serde_json::Value;

use crate::scene::Scene;

/// Writes the track of a person who moves, later by `late` seconds and moved aside, metres.
fn write_track(scene: &Scene, folder: &str, late: f64, aside: DVec3) {
    let model = builtin::full_body();
    let frames = (0..60).map(|frame| {
        let time = frame as f64 / 30.0 + late;
        let mut pose = Pose::rest(&model);
        for (index, rotation) in pose.rotations.iter_mut().enumerate() {
            let angle = 0.3 * (3.0 * time + 1.7 * index as f64).sin();
            *rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), angle) * *rotation;
        }
        pose.root = DVec3::new(0.4 * time, 0.1 * (2.0 * time).sin(), 0.9) + aside;
        (frame, FrameEstimate::of_pose(frame, pose))
    });
    let track = Track { frames: frames.collect() };
    let export = TrackExport { name: "a", frame_rate: 30.0, model: &model, cameras: &[], track: &track };
    fs::create_dir(scene.path(folder)).unwrap();
    fs::write(scene.path(&format!("{folder}/track.json")), track_json::to_text(&export)).unwrap();
}

fn json(scene: &Scene, line: &str) -> Value {
    serde_json::from_str(&scene.ok(&format!("compare {line} --json"))).unwrap()
}

#[test]
fn a_track_is_its_exports_and_differs_from_what_is_off() {
    let scene = Scene::new();
    write_track(&scene, "a", 0.0, DVec3::ZERO);
    write_track(&scene, "b", 0.25, DVec3::new(0.03, 0.0, 0.04));
    scene.ok("export a --to bvh,trc,c3d,npz,csv --out motion");
    scene.ok("export a --to mot --names opensim --out motion");
    let ends = ["bvh", "trc", "c3d", "npz", "csv"].map(|end| format!("motion/track.{end}"));
    let all = json(&scene, &format!("a {} motion/track.mot", ends.join(" ")));
    let references = all["references"].as_array().unwrap();
    for (reference, end) in references.iter().zip(&ends) {
        assert_eq!(reference["frames"], 60, "{end}");
        let mean = reference["joint_error_mm"]["raw"]["mean"].as_f64().unwrap();
        assert!(mean < 0.1, "{end}: {mean}");
        assert_eq!(reference["clock"]["measured"], false, "{end}");
        assert_eq!(reference["angles_degrees"].as_array().unwrap().len(), 8, "{end}");
    }
    assert!(
        references[5]["joint_error_mm"].is_null()
            && references[5]["angles_degrees"].as_array().unwrap().len() == 8
    );

    let other = &json(&scene, "a b --out compared")["references"][0];
    let seconds = other["clock"]["seconds"].as_f64().unwrap();
    assert!((seconds + 0.25).abs() < 0.01 && other["clock"]["measured"] == true, "{seconds}");
    let table = fs::read_to_string(scene.path("compared/errors.csv")).unwrap();
    assert!(table.starts_with("reference,frame,joint,raw_mm,root_aligned_mm,procrustes_mm\nb,"), "{table}");
    assert!(fs::read_to_string(scene.path("compared/angles.csv")).unwrap().contains("left knee flexion"));
    let known = &json(&scene, "a b --offset -0.25 --same-world --frames 20..40")["references"][0];
    let raw = &known["joint_error_mm"]["raw"];
    // The other is where this one is later, and beside it: 50 mm beside and 100 mm behind by 0.4 m/s.
    assert!((raw["mean"].as_f64().unwrap() - 50.0).abs() < 3.0, "{raw}");

    let text = scene.ok("compare a b motion/track.trc");
    for words in [
        "a/track.json beside b",
        "is 0.2",
        "s early (measured from the motion)",
        "left knee flexion",
        "Procrustes",
    ] {
        assert!(text.contains(words), "{words} in {text}");
    }
}

#[test]
fn what_cannot_be_compared_is_told() {
    let scene = Scene::new();
    write_track(&scene, "a", 0.0, DVec3::ZERO);
    fs::write(scene.path("ids.csv"), "frame,point_id,x,y,z\n0,4,0,0,0\n1,4,0,0,1\n").unwrap();
    scene.fails("compare a ids.csv", 1, &["ids.csv", "frame rate", "--frame-rate"]);
    scene.fails("compare a ids.csv --frame-rate 30", 1, &["ids.csv", "names", "4", "RElbow"]);
    scene.fails("compare a ids.csv --frame-rate 30 --joint 5=left_knee", 1, &["ids.csv", "5"]);
    scene.fails("compare a ids.csv --joint 5=nose", 2, &["--joint", "left or right"]);
    scene.fails("compare a", 2, &["REFERENCE"]);
    scene.fails("compare a nothing.trc", 1, &["nothing.trc", "no such file"]);
    scene.fails("compare a ids.txt", 1, &["ids.txt", "trc, c3d"]);
    scene.fails("compare a a --frames 100..", 1, &["--frames"]);
}
