//! `backlit sphere-tree`: a mesh becomes nested spheres in a file, and what is no solid is told.

use std::fmt::Write;

use backlit_sphere_tree::isosurface;
use glam::DVec3;
use serde_json::Value;

use crate::scene::Scene;

#[test]
fn a_mesh_becomes_levels_of_spheres() {
    let scene = Scene::new();
    let egg = |p: DVec3| (p * DVec3::new(1.0, 1.0, 0.6)).length() - 0.5;
    let mesh = isosurface([DVec3::splat(-1.0), DVec3::splat(1.0)], 0.2, egg).unwrap();
    let mut obj = String::new();
    mesh.vertices().iter().for_each(|v| writeln!(obj, "v {} {} {}", v.x, v.y, v.z).unwrap());
    for [a, b, c] in mesh.triangles() {
        writeln!(obj, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    scene.write("egg.obj", &obj);
    let table = scene.ok("sphere-tree egg.obj --spheres 16 --levels 2 --out egg.json");
    assert!(table.contains("covered") && table.contains("100.00 %") && table.contains("egg.json"), "{table}");
    let tree: Value =
        serde_json::from_str(&std::fs::read_to_string(scene.path("egg.json")).unwrap()).unwrap();
    let levels = tree["levels"].as_array().unwrap();
    let counts: Vec<usize> = levels.iter().map(|level| level["spheres"].as_array().unwrap().len()).collect();
    assert!(counts.len() == 2 && counts[0] <= 4 && counts[1] <= 16, "{counts:?}");
    assert!(levels[0]["spheres"][0]["parent"].is_null());
    assert!(levels[1]["spheres"][0]["parent"].as_u64().unwrap() < counts[0] as u64);
    assert_eq!(levels[1]["spheres"][0]["centre"].as_array().unwrap().len(), 3);
    assert_eq!(levels[1]["error"]["coverage"], 1.0);
    let printed: Value =
        serde_json::from_str(&scene.ok("sphere-tree egg.obj --spheres 16 --levels 2 --out egg.json --json"))
            .unwrap();
    assert_eq!(printed["levels"][1]["error"], levels[1]["error"]);

    // The same as a body, which the sphere-tree renderer draws.
    scene.ok("sphere-tree egg.obj --spheres 16 --levels 2 --out egg.toml");
    let body = backlit_formats::model_file::read(&scene.path("egg.toml")).unwrap();
    assert_eq!(body.spheres_by_level(), counts);

    let first = obj.rfind("f ").unwrap();
    scene.write("open.obj", &obj[..first]);
    scene.fails("sphere-tree open.obj --out a.json", 1, &["open.obj", "not closed: 3 edges"]);
    scene.fails("sphere-tree no.obj --out a.json", 1, &["no.obj", "no such file"]);
    scene.fails("sphere-tree egg.obj --out a.txt", 1, &["a.txt", "expected .json or .toml"]);
    scene.fails("sphere-tree egg.obj --spheres 0 --out a.json", 2, &["--spheres", "1..=4096"]);
}
