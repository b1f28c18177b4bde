//! `backlit fit` with masks and grey levels, and what it says of bad files.

use std::fs;

use backlit_formats::images;
use image::{DynamicImage, GrayImage, Luma};

use crate::scene::{FIT, RENDER, Scene};

#[test]
fn fit_finds_the_pose() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let text = scene.ok(&format!("{FIT} --out fitted.json"));
    assert!(text.contains("Stopped: ") && text.contains("stage"), "{text}");
    let (before, after) = (scene.error_mm("start.json"), scene.error_mm("fitted.json"));
    assert!(after < 0.5 * before, "{before} mm before, {after} mm after");

    // Grey levels made by the ramp that looks at them, without the priors: nothing but rounding is left.
    let grey = FIT.replace("--masks masks", "--measurement drawn");
    let options = "--preset report --ramp half --method lm --parameters tangent --iterations 80";
    scene.ok(&format!("{grey} {options} --out fitted.json"));
    let after = scene.error_mm("fitted.json");
    assert!(after < 20.0, "{before} mm before, {after} mm after");
}

#[test]
fn fit_answers_in_json() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let options = "--preset report --iterations 7 --no-stop --timing --json";
    let answer = scene.json(&format!("{FIT} {options}"));
    assert_eq!(answer["iterations"].as_array().unwrap().len(), 7);
    assert_eq!(answer["costs"].as_array().unwrap().len(), 8);
    assert_eq!(answer["termination"]["reason"], "step-limit");
    assert_eq!(answer["termination"]["words"], "7 steps done");
    assert_eq!(answer["us_per_iteration"]["count"], 7);
    assert!(answer["us_per_iteration"]["min"].as_f64() <= answer["us_per_iteration"]["median"].as_f64());
    assert_eq!(answer["pose"]["format"], "backlit-pose 1");
    assert_eq!(answer["empty_cameras"].as_array().unwrap().len(), 0);
    // Far beyond convergence, where a step can only fail.
    for method in ["gauss-newton", "lm"] {
        let options = format!("--ramp half --method {method} --iterations 90 --no-stop --json");
        let answer = scene.json(&format!("{FIT} {options}"));
        assert_eq!(answer["iterations"].as_array().unwrap().len(), 90, "{method}");
    }
}

#[test]
fn an_empty_mask_is_left_out_and_nothing_to_see_is_an_error() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let empty = DynamicImage::ImageLuma8(GrayImage::from_pixel(128, 96, Luma([0])));
    images::write_png(&scene.path("masks/side.png"), &empty).unwrap();
    let answer = scene.json(&format!("{FIT} --json"));
    assert_eq!(answer["empty_cameras"][0], "side");
    assert!(scene.ok(FIT).contains("side"));
    images::write_png(&scene.path("masks/front.png"), &empty).unwrap();
    scene.fails(FIT, 1, &["no camera has a silhouette", "front", "side"]);
}

#[test]
fn bad_files_are_named() {
    let scene = Scene::new();
    scene.masks();
    scene.start();
    let good = fs::read(scene.path("masks/front.png")).unwrap();
    fs::write(scene.path("masks/front.png"), &good[..good.len() / 2]).unwrap();
    scene.fails(FIT, 1, &["masks/front.png", "not a whole picture"]);
    let small = DynamicImage::ImageLuma8(GrayImage::new(32, 96));
    images::write_png(&scene.path("masks/front.png"), &small).unwrap();
    scene.fails(FIT, 1, &["masks/front.png", "32×96", "128×96"]);
    fs::remove_file(scene.path("masks/front.png")).unwrap();
    scene.fails(FIT, 1, &["masks/front.png", "no such file"]);

    scene.write("start.json", "{\"format\": \"backlit-pose 1\",\n\"root\": [0, NaN, 0], \"rotations\": {}}");
    scene.fails(FIT, 1, &["start.json, line 2", "root"]);
    scene.write(
        "start.json",
        "{\"format\": \"backlit-pose 1\", \"root\": [0, 0, 0],\n\"rotations\": {\"tail\": [1, 0, 0, 0]}}",
    );
    scene.fails(FIT, 1, &["start.json, line 2", "tail"]);

    let limb = |name: &str, parent: &str| {
        format!(
            "[[limb]]\nname = \"{name}\"\nparent = \"{parent}\"\ndirection = [0, 1, 0]\nlength = 1\nradius = 0.1\n"
        )
    };
    let model = |limbs: &str| {
        scene.write("body.toml", &format!("format = \"backlit-body 1\"\nname = \"b\"\n{limbs}"));
    };
    let render = RENDER.replace("upper_body", "body.toml");
    model(&(limb("a", "b") + &limb("b", "a")));
    scene.fails(&render, 1, &["body.toml, line ", "`parent`"]);
    model(&limb("a", "nobody"));
    scene.fails(&render, 1, &["body.toml, line 5", "nobody"]);
    scene.fails(&RENDER.replace("upper_body", "none.toml"), 1, &["none.toml", "full_body"]);
}
