//! `--person K`: one of two people in view is followed, by every command that takes it.

use backlit_lab::synthetic::two_people;
use backlit_tracking::body::builtin;
use image::GrayImage;

use crate::scene::Scene;

/// Pixels of the first camera's first silhouette: the subject's, and unknown ones.
fn pixels(scene: &Scene, folder: &str) -> [usize; 2] {
    let mask: GrayImage =
        image::open(scene.path(&format!("{folder}/cam1/frame_000000.png"))).unwrap().into_luma8();
    [255, 128].map(|level| mask.pixels().filter(|pixel| pixel[0] == level).count())
}

#[test]
fn every_command_follows_the_person_that_is_named_or_says_who_is_there() {
    let scene = Scene::new();
    std::fs::create_dir(scene.path("two")).unwrap();
    two_people::write(&scene.path("two"), &builtin::full_body(), [160, 160], &[0, 1]).unwrap();
    scene.ok("silhouettes two --out both --frames 0..=2");
    let [said, told] = scene.told("silhouettes two --out first --frames 0..=2 --person 1");
    assert!(told.contains("followed of 2 in view: person 1, frames 0 to 2, first at ("), "{said} {told}");
    let (both, first) = (pixels(&scene, "both"), pixels(&scene, "first"));
    assert!(both[1] == 0 && first[1] > 150 && first[0] + 150 < both[0], "{both:?} {first:?}");

    // They do not stand in one place.
    let [one, other] = ["1", "2"].map(|who| {
        scene.ok(&format!("track two --out t{who} --frames 0..=2 --person {who}"));
        let track = scene.read_json(&format!("t{who}/track.json"));
        [0, 1].map(|axis| track["frames"][2]["root"][axis].as_f64().unwrap())
    });
    assert!((one[0] - other[0]).hypot(one[1] - other[1]) > 0.5, "{one:?} {other:?}");
    let report = scene.json("fit-body two --person 2 --frames 0..=4 --count 2 --acquire --json");
    assert!(report["iou"]["after"].as_f64().unwrap() > 0.6, "{report}");

    let there = ["--person 3: there is no such person; in view are: person 1,", "; person 2, frames 0 to "];
    scene.fails("track two --out t --frames 0..=2 --person 3", 1, &there);
    scene.fails("silhouettes two --out s --person 0", 2, &["--person", "1 to 100"]);
    let few = ["--person: 2 cameras cannot tell people apart; expected 3 or more"];
    scene.fails("silhouettes two --out s --cameras cam1,cam2 --person 1", 1, &few);
}
