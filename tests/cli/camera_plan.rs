//! `backlit observability --plan`: of a take, of a calibration, and of cameras that are not there yet.

use backlit_lab::synthetic::two_people;
use backlit_tracking::body::builtin;

use crate::scene::{BUILT_IN, Scene};

/// A plan that takes no time.
const SMALL: &str = "--area 1x1 --places 1 --candidates 4 --heights 1.5";

#[test]
fn a_take_is_planned_with_a_table_numbers_and_a_picture() {
    let scene = Scene::new();
    let text = scene.ok(&format!("observability {BUILT_IN} --plan {SMALL} --picture plan.png"));
    for expected in ["cam1, cam2, cam3, cam4", "left out best: cam", "one more at", "12 bodies"] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let picture = image::open(scene.path("plan.png")).unwrap();
    assert!(picture.width() > picture.height(), "two maps side by side");

    let found = scene.json(&format!("observability {BUILT_IN} --plan {SMALL} --cameras cam3,cam1 --json"));
    assert_eq!((found["given"].as_u64(), found["cameras"].as_array().unwrap().len()), (Some(2), 6));
    assert_eq!(found["cameras"][0]["name"], "cam1", "in the take's order");
    assert_eq!(found["sets"].as_array().unwrap().len(), 3);
    let mean = |set: &serde_json::Value| set["mean_m"].as_f64().unwrap();
    let additions = found["additions"].as_array().unwrap();
    assert_eq!(additions.len(), 4);
    assert!(additions.windows(2).all(|pair| mean(&pair[0]) <= mean(&pair[1])), "the best first");
    assert!(mean(&additions[3]) <= mean(&found["sets"][2]), "more cameras are never worse");
}

#[test]
fn a_calibration_and_a_ring_need_no_footage() {
    let scene = Scene::new();
    std::fs::create_dir(scene.path("take")).unwrap();
    two_people::write(&scene.path("take"), &builtin::full_body(), [96, 96], &[0]).unwrap();
    std::fs::copy(scene.path("take/cameras.json"), scene.path("calibration.json")).unwrap();
    let of_file = scene.json(&format!("observability calibration.json --plan {SMALL} --floor 0 --json"));
    assert_eq!((of_file["given"].as_u64(), of_file["floor_m"].as_f64()), (Some(4), Some(0.0)));
    let ring = |more: &str| {
        let found =
            scene.json(&format!("observability --plan --ring 2 {SMALL} --size 320x240 {more} --json"));
        found["sets"][2]["mean_m"].as_f64().unwrap()
    };
    let usual = ring("--radius 4");
    assert!(ring("--radius 4 --field-of-view 6") > usual, "most of a body is not in the pictures");
    assert!(ring("--radius 4 --noise 800") > usual);

    scene.fails("observability --plan", 2, &["<TAKE>"]);
    scene.fails("observability --ring 3", 2, &["--plan"]);
    scene.fails(&format!("observability {BUILT_IN} --plan --ring 3"), 2, &["cannot be used with"]);
    scene.fails(&format!("observability {BUILT_IN} --plan --cameras cam9"), 1, &["cam9"]);
    scene.fails(&format!("observability {BUILT_IN} --plan --area 3"), 2, &["4x3"]);
    scene.fails("observability nowhere.toml --plan", 1, &["nowhere.toml"]);
    scene.fails(&format!("observability {BUILT_IN} --plan --picture nowhere/a.png"), 1, &["nowhere"]);
}
