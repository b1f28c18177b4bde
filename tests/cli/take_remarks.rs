//! What a take has to say for itself when a command opens it: files outside its folder, pictures behind a gap.

use std::fs;
use std::path::Path;

use crate::scene::{BUILT_IN, Scene};

/// A scene with some of the built-in take's files in `take`, and the text of its take file.
fn with_files(files: &[&str]) -> (Scene, String) {
    let scene = Scene::new();
    let assets = Path::new(BUILT_IN);
    fs::create_dir_all(scene.path("take/cam1")).unwrap();
    for file in files {
        fs::copy(assets.join(file), scene.path("take").join(file)).unwrap();
    }
    (scene, fs::read_to_string(assets.join("take.toml")).unwrap())
}

#[test]
fn files_outside_the_takes_folder_are_told_once() {
    // The pictures stay where they are.
    let (scene, text) = with_files(&["start.json"]);
    let footage = format!("footage = {BUILT_IN:?}\nframe_rate");
    scene.write("take/take.toml", &text.replacen("frame_rate", &footage, 1));
    for arguments in [
        "track take --out out --frames 0..2",
        "track take --out out --frames 0..3 --resume",
        "fit take --frame 1",
    ] {
        let [_, said] = scene.told(arguments);
        let told: Vec<&str> = said.lines().filter(|line| line.contains("outside its own folder")).collect();
        assert_eq!(told.len(), 1, "{arguments}: {said}");
        assert!(told[0].starts_with("note: the take reads outside its own folder: "), "{told:?}");
        assert!(told[0].contains("assets/take/cameras.json, and 9 more paths that it names"), "{told:?}");
    }
    let [_, said] = scene.told(&format!("track {BUILT_IN} --out out --frames 0..1"));
    assert!(!said.contains("outside"), "{said}");
}

#[test]
fn pictures_behind_a_gap_are_told() {
    let (scene, text) = with_files(&[
        "cameras.json",
        "start.json",
        "cam1/empty_000.jpg",
        "cam1/empty_001.jpg",
        "cam1/frame_000.jpg",
        "cam1/frame_001.jpg",
        "cam1/frame_003.jpg",
    ]);
    let one_camera: Vec<&str> = text.split("[[camera]]").take(2).collect();
    scene.write("take/take.toml", &one_camera.join("[[camera]]"));
    let [_, said] = scene.told("silhouettes take --out out");
    assert!(said.contains("note: camera \"cam1\": pictures 2 to 2 are missing"), "{said}");
    assert!(!said.contains("outside"), "{said}");
}
