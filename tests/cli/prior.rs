//! `backlit prior`: what motion files say, and a track that asks them.

use std::fs;
use std::path::Path;

use backlit_formats::motion::{self, Motion, MotionFormat, MotionOptions};
use backlit_formats::prior_file;
use backlit_tracking::body::{Parameters, Pose, builtin};

use crate::scene::Scene;

/// A body that swings its arms and legs, as this program writes it.
fn swinging(path: &Path) {
    let model = builtin::full_body();
    let columns = Parameters::Tangent.columns(model.rotation_count());
    let pose = |frame: usize| {
        let swing = 0.3 * (0.2 * frame as f64).sin();
        let step: Vec<f64> =
            (0..columns).map(|i| if i < 6 { 0.0 } else { swing * (i as f64).cos() }).collect();
        Pose::rest(&model).retract(Parameters::Tangent, &step)
    };
    let poses = (0..120).map(|frame| (frame, pose(frame))).collect();
    let motion = Motion::of_poses("swing", model.clone(), 30.0, poses);
    motion::write(path, MotionFormat::Bvh, &motion, &MotionOptions::default()).unwrap();
}

#[test]
fn a_prior_is_learnt_and_used() {
    let scene = Scene::new();
    fs::create_dir_all(scene.path("motions/more")).unwrap();
    swinging(&scene.path("motions/more/swing.bvh"));
    let said = scene.ok("prior --train motions --out people.json --components 3 --source ours");
    assert!(said.contains("1 motion files, 4 s") && said.contains("right arm"), "{said}");
    let prior = prior_file::read(&scene.path("people.json")).unwrap();
    assert_eq!((prior.parts.len(), prior.source.as_str()), (5, "ours"));
    let json = scene.ok("prior --train motions --out people.json --components 3 --json");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&json).unwrap()["files"], 1);

    scene.fails(
        "prior --train motions --out people.json --components 0",
        2,
        &["--components", "from 1 to 1000"],
    );
    scene.fails("prior --train nowhere --out people.json", 1, &["nowhere"]);
    scene.fails("prior --train motions --out no/people.json", 1, &["no folder no"]);
    fs::write(scene.path("motions/bad.bvh"), "HIERARCHY\nROOT a\n{ OFFSET x 0 0 }\n").unwrap();
    scene.fails("prior --train motions --out people.json", 1, &["bad.bvh, line 3", "OFFSET"]);
    assert!(scene.ok("track --help").contains("people"));
    scene.fails("track nowhere --out out --prior cameras.json", 1, &["nowhere"]);
}
