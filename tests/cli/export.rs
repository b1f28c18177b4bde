//! `backlit export`: a written track as motion files.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::Document;
use backlit_document::project::write_project;
use backlit_formats::export::{TrackExport, track_json};
use backlit_take::source::TakeSource;
use backlit_tracking::body::Kinematics;
use backlit_tracking::track::{FrameEstimate, Track};

use crate::scene::Scene;

#[test]
fn a_track_becomes_a_file_a_format() {
    let scene = Scene::new();
    let frames = [2, 3, 6].map(|frame| (frame, FrameEstimate::of_pose(frame, scene.pose())));
    let track = Track { frames: frames.into() };
    let export =
        TrackExport { name: "wave", frame_rate: 30.0, model: &scene.model, cameras: &[], track: &track };
    fs::create_dir(scene.path("results")).unwrap();
    fs::write(scene.path("results/track.json"), track_json::to_text(&export)).unwrap();
    scene.ok("export results --to bvh,trc,mot,c3d,glb,npz,csv --up y --frames 2..6 --out motion");
    for extension in ["bvh", "trc", "mot", "c3d", "glb", "npz", "csv"] {
        assert!(fs::metadata(scene.path(&format!("motion/track.{extension}"))).unwrap().len() > 100);
    }
    let rows = fs::read_to_string(scene.path("motion/track.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 2 * (1 + scene.model.limbs().len()));
    scene.ok(
        "export results/track.json --model upper_body --to csv --unit mm --up -y --axes z-up --out motion",
    );

    scene.fails("export results --to fbx --out motion", 2, &["--to", "fbx", "c3d"]);
    scene.fails("export results --to bvh --up w --out motion", 2, &["--up", "-z"]);
    scene.fails(
        "export results --to bvh --frames 4..6 --out motion",
        1,
        &["frames", "empty between 4 and 5"],
    );
    scene.fails("export results --to bvh --model full_body --out motion", 1, &["track.json", "frames[0]"]);
    scene.fails("export nowhere --to bvh --out motion", 1, &["nowhere"]);
}

/// What was set by hand is in it, nothing is computed, and the cameras say which way is up.
#[test]
fn the_poses_of_a_project_are_exported_as_they_are() {
    let scene = crate::track::take();
    let mut document = Document::new(scene.model.clone());
    document.take = Some(TakeSource::Path(PathBuf::from("wave")));
    // The last one lies beyond the take.
    document.keys = Arc::new([1, 3, 99].map(|frame| (frame, scene.pose())).into());
    write_project(&scene.path("mine.backlit"), &document, &[]).unwrap();
    scene.ok("export mine.backlit --to csv,trc --out motion");
    let rows = fs::read_to_string(scene.path("motion/mine.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 2 * (1 + scene.model.limbs().len()));
    let last = scene.model.limbs().last().unwrap();
    let end = *Kinematics::new(&scene.model, &scene.pose()).ends().last().unwrap();
    let row = rows.lines().find(|row| row.starts_with("3,") && row.contains(&last.name)).unwrap();
    let x: f64 = row.split(',').rev().nth(2).unwrap().parse().unwrap();
    assert!((x - end.x).abs() < 1e-9, "{row}; expected {end}");
    let of_cameras = fs::read(scene.path("motion/mine.trc")).unwrap();
    let same = ["y", "-y", "z"].map(|up| {
        scene.ok(&format!("export mine.backlit --to trc --up {up} --out other"));
        fs::read(scene.path("other/mine.trc")).unwrap() == of_cameras
    });
    assert!(same[0] != same[1] && !same[2], "{same:?}");

    scene.fails("export mine.backlit --to csv --model full_body --out motion", 1, &["--model is for tracks"]);
    document.take = Some(TakeSource::Path(PathBuf::from("gone")));
    write_project(&scene.path("lost.backlit"), &document, &[]).unwrap();
    scene.fails("export lost.backlit --to csv --out motion", 1, &["the project's take", "gone"]);
}
