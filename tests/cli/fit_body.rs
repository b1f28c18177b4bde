//! `backlit fit-body` on the small take of `backlit track`: a body that waves before a wall.

use backlit_formats::model_file;
use backlit_tracking::body::Model;

use crate::track;

fn radius(model: &Model, limb: &str) -> f64 {
    model.limbs()[model.limb_index(limb).unwrap()].radius
}

/// From a body that is a tenth too small and too slim, with keypoints and without.
#[test]
fn a_body_of_wrong_size_grows_to_the_silhouettes() {
    let scene = track::take();
    let slim = scene.model.with_sizes(|limb| {
        let limb = &scene.model.limbs()[limb];
        [0.9 * limb.length, 0.8 * limb.radius]
    });
    model_file::write(&scene.path("slim.toml"), &slim.unwrap()).unwrap();
    for keypoints in ["", " --without-keypoints"] {
        let command = format!("fit-body wave --model slim.toml --frames 0..=4 --count 3{keypoints}");
        let report = scene.json(&format!("{command} --out person.toml --json"));
        assert_eq!(report["frames"], serde_json::json!([0, 2, 4]));
        assert!(report["iou"]["after"].as_f64().unwrap() > 0.95, "{report}");
        let person = model_file::read(&scene.path("person.toml")).unwrap();
        for limb in ["right upper arm", "left forearm", "head"] {
            let (found, truth) = (radius(&person, limb), radius(&scene.model, limb));
            // A pixel of these small pictures is 18 mm.
            assert!((found - truth).abs() < 0.015, "{limb}{keypoints}: {found} {truth}");
        }
    }
    let said = scene.ok("fit-body wave --frames 0,3 --proportions 20 --out again.toml");
    assert!(
        said.contains("IoU") && said.contains("upper arm, length") && said.contains("again.toml"),
        "{said}"
    );
}

/// Nothing is known: the first body and its pose are grown.
#[test]
fn a_body_is_acquired_where_nothing_is_known() {
    let scene = track::take();
    let report = scene.json("fit-body wave --acquire --without-keypoints --frames 0..=4 --count 3 --json");
    assert!(report["iou"]["after"].as_f64().unwrap() > 0.8, "{report}");
    scene.fails("fit-body wave --acquire --start pose.json", 2, &["--start", "--acquire"]);
}

#[test]
fn what_cannot_be_fitted_is_explained() {
    let scene = track::take();
    scene.fails("fit-body wave --frames 2,9", 1, &["--frames", "frame 9"]);
    scene.fails("fit-body wave --frames two", 2, &["--frames", "3,40,85"]);
    scene.fails("fit-body wave --proportions 0", 2, &["--proportions", "from 0.000001"]);
    scene.fails("fit-body wave --out nowhere/person.toml", 1, &["nowhere"]);
    scene.fails("fit-body wave --model nobody", 1, &["nobody", "upper_body"]);
    scene.fails("fit-body wave --model full_body --without-keypoints --cameras back", 1, &["back"]);
}
