//! `backlit observability` on the take that comes with the program.

use crate::scene::{BUILT_IN, Scene};

#[test]
fn directions_joints_and_sets_of_cameras_are_told() {
    let scene = Scene::new();
    let text = scene.ok(&format!("observability {BUILT_IN} --frame 3 --no-fit"));
    assert!(text.contains("36 of 48 directions are seen") && text.contains("right forearm twist"), "{text}");
    let names = "--cameras cam1,cam3";
    let answer = scene.json(&format!("observability {BUILT_IN} --frame 3 --no-fit {names} --json"));
    assert_eq!((answer["columns"].as_u64(), answer["null"].as_u64()), (Some(48), Some(12)));
    let directions = answer["directions"].as_array().unwrap();
    assert_eq!(directions.len(), 48);
    assert!(directions[0]["relative"].as_f64() == Some(1.0) && directions[47]["deviation"].is_null());
    assert_eq!(answer["subsets"].as_array().unwrap().len(), 15);
    scene.fails(&format!("observability {BUILT_IN} --cameras cam9"), 1, &["cam9"]);
}
