//! `backlit sphere-tree`: a mesh becomes nested spheres in a file, and what is no solid is told.

use std::fmt::Write;

use backlit_formats::motion::{Axes, Motion, MotionFormat, MotionOptions};
use backlit_formats::{model_file, motion};
use backlit_sphere_tree::isosurface;
use backlit_tracking::body::{Kinematics, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::silhouette::{Label, Mask, Overlap};
use glam::{DQuat, DVec3};

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
    let tree = scene.read_json("egg.json");
    let levels = tree["levels"].as_array().unwrap();
    let counts: Vec<usize> = levels.iter().map(|level| level["spheres"].as_array().unwrap().len()).collect();
    assert!(counts.len() == 2 && counts[0] <= 4 && counts[1] <= 16, "{counts:?}");
    assert!(levels[0]["spheres"][0]["parent"].is_null());
    assert!(levels[1]["spheres"][0]["parent"].as_u64().unwrap() < counts[0] as u64);
    assert_eq!(levels[1]["spheres"][0]["centre"].as_array().unwrap().len(), 3);
    assert_eq!(levels[1]["error"]["coverage"], 1.0);
    let printed = scene.json("sphere-tree egg.obj --spheres 16 --levels 2 --out egg.json --json");
    assert_eq!(printed["levels"][1]["error"], levels[1]["error"]);

    // The same as a body, which the sphere-tree renderer draws.
    scene.ok("sphere-tree egg.obj --spheres 16 --levels 2 --out egg.toml");
    let body = model_file::read(&scene.path("egg.toml")).unwrap();
    assert_eq!(body.spheres_by_level(), counts);

    let first = obj.rfind("f ").unwrap();
    scene.write("open.obj", &obj[..first]);
    scene.fails("sphere-tree open.obj --out a.json", 1, &["open.obj", "not closed: 3 edges"]);
    scene.fails("sphere-tree no.obj --out a.json", 1, &["no.obj", "no such file"]);
    scene.fails("sphere-tree egg.obj --out a.txt", 1, &["a.txt", "expected .json or .toml"]);
    scene.fails("sphere-tree egg.obj --spheres 0 --out a.json", 2, &["--spheres", "from 1 to 4096"]);
}

/// The body that Backlit writes as a skinned mesh comes back as spheres, and looks the same at rest and with an arm bent.
#[test]
fn a_skinned_mesh_becomes_a_body_of_spheres() {
    let scene = Scene::new();
    let model = builtin::full_body();
    let written = Motion::of_poses("person", model.clone(), 30.0, [(0, Pose::rest(&model))].into());
    let options = MotionOptions { axes: Some(Axes::World), ..MotionOptions::default() };
    motion::write(&scene.path("person.glb"), MotionFormat::Glb, &written, &options).unwrap();
    let said = scene.ok("sphere-tree person.glb --skinned --spheres 800 --levels 2 --out person.toml");
    assert!(said.contains("limbs") && said.contains("person.toml"), "{said}");
    let body = model_file::read(&scene.path("person.toml")).unwrap();
    assert!(body.spheres_by_level()[1] > 500, "{:?}", body.spheres_by_level());

    let intrinsics = Intrinsics { fx: 400.0, fy: 400.0, cx: 160.0, cy: 160.0 };
    let place = CameraFromWorld::looking_at(DVec3::new(1.2, -3.0, 1.0), DVec3::ZERO, DVec3::Z);
    let camera = Camera::new("c", [320, 320], intrinsics, Distortion::None, place).unwrap();
    let covered = |body: &backlit_tracking::body::Model, pose: &Pose, renderer| {
        let kinematics = Kinematics::new(body, pose);
        prediction::covered(&View::new(body, &kinematics, &camera, renderer, Ramp::Half))
    };
    for bend in [0.0, 0.8] {
        let turn = DQuat::from_rotation_y(bend);
        let bent = |body: &backlit_tracking::body::Model, elbow: DVec3| {
            let mut pose = Pose::rest(body);
            let kinematics = Kinematics::new(body, &pose);
            let near = |limb: &usize| kinematics.starts()[*limb].distance(elbow);
            let limbs = 0..body.limbs().len();
            let fore = limbs.min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
            assert!(near(&fore) < 0.005, "{} m from the elbow", near(&fore));
            pose.rotations[body.limbs()[fore].rotation] = turn;
            pose
        };
        let rest = Kinematics::new(&model, &Pose::rest(&model));
        let elbow = rest.starts()[model.limb_index("right forearm").unwrap()];
        let capsules = covered(&model, &bent(&model, elbow), RendererKind::Capsule);
        let own = RendererKind::SphereTree { spheres: None };
        let spheres = covered(&body, &bent(&body, elbow), own);
        let label = |is_body: &bool| if *is_body { Label::Subject } else { Label::Background };
        let mask = Mask::new(320, 320, capsules.iter().map(label).collect()).unwrap();
        let levels: Vec<f32> = spheres.iter().map(|is_body| if *is_body { 0.0 } else { 255.0 }).collect();
        let iou = Overlap::between(&mask, &levels).unwrap().iou().unwrap();
        // Spheres cover the whole surface, so they stand out a little everywhere.
        assert!(iou > 0.92, "bent by {bend} rad: IoU {iou}");
    }
    scene.fails("sphere-tree person.glb --skinned --out a.json", 1, &["a.json", "expected --out BODY.toml"]);
    scene.write("plain.gltf", r#"{"asset": {"version": "2.0"}}"#);
    scene.fails("sphere-tree plain.gltf --skinned --out a.toml", 1, &["plain.gltf", "has no skinned mesh"]);
}
