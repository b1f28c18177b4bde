//! `backlit join`: pieces of a take that overlap become one track.

use std::fs;
use std::ops::Range;

use backlit_formats::export::{TrackExport, track_json, track_read};
use backlit_tracking::body::Pose;
use backlit_tracking::track::{FrameEstimate, Track};
use serde_json::Value;

use crate::scene::Scene;

/// Writes a piece: a body that goes along x, beside its way by `aside` metres.
fn write(scene: &Scene, folder: &str, frames: Range<usize>, aside: f64) {
    let frames = frames.map(|frame| {
        let mut pose = scene.pose();
        pose.root.x += 0.01 * frame as f64;
        pose.root.y += aside;
        (frame, FrameEstimate::of_pose(frame, pose))
    });
    let track = Track { frames: frames.collect() };
    let export =
        TrackExport { name: "a", frame_rate: 30.0, model: &scene.model, cameras: &[], track: &track };
    fs::create_dir(scene.path(folder)).unwrap();
    fs::write(scene.path(&format!("{folder}/track.json")), track_json::to_text(&export)).unwrap();
}

#[test]
fn pieces_become_one_track() {
    let scene = Scene::new();
    write(&scene, "a", 0..40, 0.0);
    write(&scene, "b", 30..70, 0.02);
    write(&scene, "c", 60..100, 0.0);
    fs::write(
        scene.path("a/summary.json"),
        r#"{"made": {"take": "/films/a", "command": "", "settings": {}}}"#,
    )
    .unwrap();
    let summary: Value = serde_json::from_str(&scene.ok("join c a b --out whole --strict --json")).unwrap();
    assert_eq!((&summary["frames"], &summary["lost"]), (&Value::from(100), &Value::from(0)));
    assert_eq!(summary["made"]["take"], "/films/a");
    assert!(summary["seams"].as_array().unwrap().iter().all(|seam| seam["meets"] == true), "{summary}");
    let path = scene.path("whole/track.json");
    let whole = track_read::read(&path, Some(&scene.model)).unwrap();
    let pose = |frame: usize| -> &Pose { &whole.track.frames[&frame].pose };
    let way = |frame: usize| pose(frame).root.y - scene.pose().root.y;
    assert!([way(10), way(50) - 0.02, way(90)].iter().all(|off| off.abs() < 1e-9));
    assert!(
        (0..100).all(|frame| (pose(frame).root.x - scene.pose().root.x - 0.01 * frame as f64).abs() < 1e-9)
    );
    assert!(scene.path("whole/joints.csv").is_file() && scene.path("whole/summary.json").is_file());
}

#[test]
fn pieces_that_do_not_meet_are_told() {
    let scene = Scene::new();
    write(&scene, "a", 0..40, 0.0);
    write(&scene, "far", 30..70, 1.0);
    write(&scene, "later", 50..70, 0.0);
    let alone = scene.ok("join a --out alone --strict --json");
    let alone: Value = serde_json::from_str(&alone).unwrap();
    assert_eq!(
        (&alone["frames"], &alone["seams"], &alone["doubtful"]),
        (&40.into(), &Value::Array(vec![]), &Value::Null)
    );
    let text = scene.ok("join a far --out whole");
    let summary = fs::read_to_string(scene.path("whole/summary.json")).unwrap();
    assert!(summary.contains("\"doubtful\": \"at frame"), "{summary}");
    assert!(text.contains("1000.0") && text.contains("no"), "{text}");
    scene.fails("join a far --out whole --strict", 3, &["--strict", "1000 mm apart"]);
    assert!(scene.path("whole/track.json").is_file());
    scene.fails("join a later --out whole", 1, &["a", "later", "no frame in common"]);
    scene.fails("join --out whole", 2, &["TRACK"]);
    scene.fails("join a nothing --out whole", 1, &["nothing"]);
}
