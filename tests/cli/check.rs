//! `backlit check`: a take with right cameras, and the same with one whose focal length is wrong.

use backlit_lab::synthetic::two_people;
use backlit_tracking::body::builtin;

use crate::scene::Scene;

#[test]
fn a_wrong_focal_length_is_named_and_its_repair_is_written() {
    let scene = Scene::new();
    std::fs::create_dir(scene.path("take")).unwrap();
    two_people::write(&scene.path("take"), &builtin::full_body(), [160, 160], &[0]).unwrap();
    let said = scene.ok("check take --out mended.json");
    assert!(
        said.contains("nothing is wrong with the cameras") && said.contains("nothing to write"),
        "{said}"
    );
    assert!(!scene.path("mended.json").exists(), "nothing is to be mended");

    let path = scene.path("take/cameras.json");
    let mut cameras: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let right = cameras.clone();
    let fx = cameras["cameras"][2]["fx"].as_f64().unwrap();
    cameras["cameras"][2]["fx"] = (1.2 * fx).into();
    cameras["cameras"][2]["fy"] = (1.2 * fx).into();
    std::fs::write(&path, cameras.to_string()).unwrap();
    let said = scene.ok("check take --out mended.json");
    assert!(said.starts_with("cam3 has a wrong focal length: focal length 2"), "{said}");
    assert!(said.contains("wrote the repaired cameras to mended.json"), "{said}");
    let mended = scene.read_json("mended.json");
    let fx = |cameras: &serde_json::Value| cameras["cameras"][2]["fx"].as_f64().unwrap();
    assert!((fx(&mended) / fx(&right) - 1.0).abs() < 0.03, "{said}");
    let found = scene.json("check take --json");
    assert_eq!(found["findings"][0]["kind"], "focal-length", "{found}");

    scene.fails("check take --frames 1", 2, &["--frames", "2 to 1000000"]);
    scene.fails("check nowhere", 1, &["nowhere"]);
}
