//! Experiments: a table or JSON on the screen, numbers and plots in files.

use backlit_tracking::io::images;
use serde_json::Value;

use crate::scene::Scene;

#[test]
fn the_single_limb_is_measured_plotted_and_told() {
    let scene = Scene::new();
    let said = scene.ok("experiment fig5.1 --out results");
    assert!(said.contains("10 m, cylinder") && said.contains("fig5.1-0.8m.png"), "{said}");
    let plot = images::read(&scene.path("results/fig5.1-10m.png")).unwrap();
    assert!(plot.width() > 600 && plot.height() > 300);
    let file = std::fs::read_to_string(scene.path("results/fig5.1.json")).unwrap();
    let printed = scene.ok("experiment fig5.1 --out again --json");
    assert_eq!(printed, file);
    let numbers: Value = serde_json::from_str(&file).unwrap();
    assert_eq!(numbers["format"], "backlit-experiment 1");
    let costs = numbers["report"]["parts"][0]["curves"][1]["costs"].as_array().unwrap();
    assert_eq!(costs.len(), 26);
}

#[test]
fn senseless_experiments_are_explained() {
    let scene = Scene::new();
    scene.fails("experiment fig9.9", 2, &["fig9.9"]);
    scene.fails("experiment fig5.1 --offset nan", 1, &["offset_m", "finite"]);
    scene.fails("experiment fig5.1 --distance 0", 1, &["fx"]);
}
