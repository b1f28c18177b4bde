//! From another tool's project to a tracked person, by two commands and without a hand; and what `import` says.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::footage::footage;
use crate::scene::Scene;

/// The mean distance of a joint from the project's own markers, which are themselves off by 8 to 17 pixels in places. All 70
/// frames have 43.2.
const MEAN_ERROR_MM: f64 = 50.0;
/// Smallest mean overlap: 0.891 over all frames.
const IOU: f64 = 0.87;

/// A whole project, where it is there.
fn project() -> Option<PathBuf> {
    let project = footage()?.with_file_name("formats").join("project_pose2sim_single");
    project.is_dir().then_some(project)
}

#[test]
fn a_project_of_another_tool_becomes_a_tracked_person() {
    let Some(project) = project() else { return };
    let scene = Scene::new();
    let [take, results] = ["take", "results"].map(|name| scene.path(name).display().to_string());
    let [found, said] = scene.told(&format!("import {} --out {take} --json", project.display()));
    let found: Value = serde_json::from_str(&found).unwrap();
    assert_eq!((&found["project"], &found["frames"]), (&"a Pose2Sim project".into(), &70.into()), "{found}");
    // The calibration is 10 to 20 pixels off; what keypoints make of it is said.
    assert!(found["adjusted_px"][1].as_f64().unwrap() < 8.0, "{found}");
    assert!(said.contains("--keep-cameras"), "{said}");
    if found["cameras"].as_array().unwrap().len() < 4 {
        eprintln!("SKIPPED: one of the videos needs ffmpeg");
        return;
    }
    let table = project.join("pose-3d/S00_P00_T01_BalancingTrial_0-70.trc");
    // Every fifth frame: faster, and harder than all of them.
    let track = format!("track {take} --out {results} --reference {} --every 5 --json", table.display());
    let summary = scene.json(&track);
    assert_eq!((&summary["frames"], &summary["lost"]), (&14.into(), &0.into()), "{summary}");
    let number = |pointer: &str| summary.pointer(pointer).and_then(Value::as_f64).unwrap();
    assert!(number("/joint_error_mm/mean") <= MEAN_ERROR_MM, "{summary}");
    assert!(number("/iou/mean") >= IOU, "{summary}");

    // The background again, without the person that was tracked.
    let [_, said] = scene.told(&format!("background {take} --without {results} --out plates"));
    let learnt = said.lines().filter(|line| line.contains("was learnt again without the body")).count();
    assert_eq!(learnt, 4, "{said}");
    assert!(
        said.contains("note: the take reads outside its own folder: "),
        "the footage stays where it is: {said}"
    );
    assert!(scene.path("plates/cam03.png").is_file());
}

#[test]
fn what_is_not_there_to_import_is_said() {
    let scene = Scene::new();
    fs::create_dir(scene.path("empty")).unwrap();
    scene.fails("import empty --dry-run", 1, &["empty", "expected"]);
    scene.fails("background empty --without empty --out empty", 1, &["track.json"]);
}
