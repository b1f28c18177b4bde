//! `backlit track` of a take in one of whose backgrounds something is put down.

use crate::disturbed_take;
use crate::scene::Scene;

#[test]
fn a_background_that_changes_is_told_and_learnt_again() {
    let scene = Scene::new();
    disturbed_take::write(&scene.path("take"), 3, 20);
    let [printed, said] = scene.told("track take --frames 10.. --every 2 --json --out learnt");
    let told = "cam3: a thing stands in the picture from frame 20 (0.67 s) on";
    assert!(said.lines().any(|line| line.starts_with(told)), "{said}");
    let learnt: serde_json::Value = serde_json::from_str(&printed).unwrap();
    assert!(learnt["background_changes"][0].as_str().unwrap().starts_with(told));
    assert!(scene.ok("check take").lines().any(|line| line.starts_with(told)), "the check says it too");
    let [printed, said] =
        scene.told("track take --frames 10.. --every 2 --json --no-relearn --out as-it-was");
    assert!(!said.contains("cam3"), "{said}");
    let before: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let iou = |track: &serde_json::Value| track["iou"]["by_camera"]["cam3"].as_f64().unwrap();
    assert!(iou(&learnt) > iou(&before) + 0.02, "{} {}", iou(&learnt), iou(&before));
    assert!(scene.told("track take --frames 0..20 --out clean")[1].is_empty(), "nothing has changed yet");
}
