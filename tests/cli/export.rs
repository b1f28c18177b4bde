//! `backlit export`: a written track as motion files.

use std::fs;

use backlit_formats::export::{TrackExport, track_json};
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
