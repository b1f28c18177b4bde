//! What a take has to say for itself when a command opens it: files outside its folder, pictures behind a gap.

use std::fs;
use std::path::Path;
use std::process::Command;

/// A take with the built-in take's pictures, which stay where they are.
fn take(folder: &Path) {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take");
    fs::copy(assets.join("start.json"), folder.join("start.json")).unwrap();
    let text = fs::read_to_string(assets.join("take.toml")).unwrap();
    let footage = format!("footage = {:?}\nframe_rate", assets.to_str().unwrap());
    fs::write(folder.join("take.toml"), text.replacen("frame_rate", &footage, 1)).unwrap();
}

/// What a command that succeeds says on standard error.
fn said(arguments: &[&str]) -> String {
    let out = Command::new(env!("CARGO_BIN_EXE_backlit")).args(arguments).output().unwrap();
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(out.status.success(), "{said}");
    said
}

#[test]
fn files_outside_the_takes_folder_are_told_once() {
    let folder = tempfile::tempdir().unwrap();
    take(folder.path());
    let out = folder.path().join("out");
    let [take, out] = [folder.path(), &out].map(|path| path.to_str().unwrap());
    for arguments in [
        &["track", take, "--out", out, "--frames", "0..2"][..],
        &["track", take, "--out", out, "--frames", "0..3", "--resume"],
        &["fit", take, "--frame", "1"],
    ] {
        let said = said(arguments);
        let told: Vec<&str> = said.lines().filter(|line| line.contains("outside its own folder")).collect();
        assert_eq!(told.len(), 1, "{arguments:?}: {said}");
        assert!(told[0].starts_with("note: the take reads outside its own folder: "), "{told:?}");
        assert!(told[0].contains("assets/take/cameras.json, and 9 more paths that it names"), "{told:?}");
    }
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take");
    let said = said(&["track", own.to_str().unwrap(), "--out", out, "--frames", "0..1"]);
    assert!(!said.contains("outside"), "{said}");
}

#[test]
fn pictures_behind_a_gap_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take");
    fs::create_dir_all(folder.path().join("cam1")).unwrap();
    let files = ["cameras.json", "start.json", "cam1/empty_000.jpg", "cam1/empty_001.jpg"];
    let frames = [0, 1, 3].map(|frame| format!("cam1/frame_{frame:03}.jpg"));
    for file in files.into_iter().chain(frames.iter().map(String::as_str)) {
        fs::copy(assets.join(file), folder.path().join(file)).unwrap();
    }
    let text = fs::read_to_string(assets.join("take.toml")).unwrap();
    let one_camera: Vec<&str> = text.split("[[camera]]").take(2).collect();
    fs::write(folder.path().join("take.toml"), one_camera.join("[[camera]]")).unwrap();
    let out = folder.path().join("out");
    let said = said(&["silhouettes", folder.path().to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(said.contains("note: camera \"cam1\": pictures 2 to 2 are missing"), "{said}");
    assert!(!said.contains("outside"), "{said}");
}
