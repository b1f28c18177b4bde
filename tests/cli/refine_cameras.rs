//! `backlit refine-cameras`: one camera of a take is turned, and the person's silhouettes turn it back.

use backlit_lab::synthetic::two_people;
use backlit_tracking::body::builtin;
use glam::{DMat3, DVec3};

use crate::scene::Scene;

/// What is turned, degrees.
const TURNED: f64 = 1.5;

fn rotation(cameras: &serde_json::Value, camera: usize) -> DMat3 {
    let row = |row: usize| {
        DVec3::from_array(
            [0, 1, 2].map(|at| cameras["cameras"][camera]["rotation"][row][at].as_f64().unwrap()),
        )
    };
    DMat3::from_cols(row(0), row(1), row(2)).transpose()
}

/// By how much two cameras are turned against each other beside how they should be, degrees.
fn apart(cameras: &serde_json::Value, right: &serde_json::Value) -> f64 {
    let between = |cameras| rotation(cameras, 2) * rotation(cameras, 0).transpose();
    let off = between(cameras) * between(right).transpose();
    (0.5 * (off.x_axis.x + off.y_axis.y + off.z_axis.z - 1.0)).clamp(-1.0, 1.0).acos().to_degrees()
}

#[test]
fn a_turned_camera_is_turned_back_and_the_body_is_written() {
    let scene = Scene::new();
    std::fs::create_dir(scene.path("take")).unwrap();
    two_people::write(&scene.path("take"), &builtin::full_body(), [160, 160], &[0]).unwrap();
    let path = scene.path("take/cameras.json");
    let right: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let mut cameras = right.clone();
    let turned = DMat3::from_rotation_y(TURNED.to_radians()) * rotation(&right, 2);
    // The centre stays where it is.
    let centre = |at: usize| right["cameras"][2]["translation"][at].as_f64().unwrap();
    let back = DMat3::from_rotation_y(TURNED.to_radians()) * DVec3::new(centre(0), centre(1), centre(2));
    for row in 0..3 {
        cameras["cameras"][2]["rotation"][row] = serde_json::json!(turned.row(row).to_array());
    }
    cameras["cameras"][2]["translation"] = serde_json::json!(back.to_array());
    std::fs::write(&path, cameras.to_string()).unwrap();
    assert!((apart(&cameras, &right) - TURNED).abs() < 1e-6);

    let said = scene.ok("refine-cameras take --count 6 --out refined.json --body-out body.toml");
    assert!(said.contains("wrote the cameras to refined.json"), "{said}");
    assert!(said.contains("held as calibrated: where the whole rig stands"), "{said}");
    let left = apart(&scene.read_json("refined.json"), &right);
    assert!(left < 0.4, "{left}° are left\n{said}");
    assert!(scene.path("body.toml").exists());

    scene.fails("refine-cameras take --cameras cam1", 1, &["used: 1", "2 or more"]);
    scene.fails("refine-cameras take --free zoom", 2, &["--free", "focal-length", "drift"]);
    scene.fails("refine-cameras take --count 2", 2, &["--count", "3 to 64"]);
}
