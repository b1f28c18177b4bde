//! The README's pictures, of the real window.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::desk::Desk;
use crate::window::Window;

/// Goes on to a later frame.
fn go_on_to(window: &mut Window<'_>, frame: u64) {
    while let Some(left) = frame.checked_sub(window.state()["frame"].as_u64().unwrap_or(0)) {
        let (key, by) = match left {
            0 => return,
            1..=9 => ("Right", 1),
            _ => ("shift+Right", 10),
        };
        let to = frame - left + by;
        window.key_until_still(key, "a later frame", |state| state["frame"] == to);
    }
}

fn picture(window: &mut Window<'_>, folder: &Path, name: &str) {
    window.until("notices have gone", |state| state["notices"].as_array().is_none_or(Vec::is_empty));
    window.picture_in(folder, name);
}

/// The built-in take's pictures and calibration, as a camera system would leave them: no take file, no start.
fn recording(home: &Path) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take");
    let to = home.join("Monday");
    std::fs::create_dir_all(&to).unwrap();
    std::fs::copy(from.join("cameras.json"), to.join("cameras.json")).unwrap();
    for camera in ["cam1", "cam2", "cam3", "cam4"] {
        std::fs::create_dir_all(to.join(camera)).unwrap();
        for frame in 0..60 {
            let name = format!("{camera}/frame_{frame:03}.jpg");
            std::fs::copy(from.join(&name), to.join(&name)).unwrap();
        }
    }
    to
}

#[test]
fn readme() {
    let Some(folder) = std::env::var_os("BACKLIT_SCREENSHOTS").map(PathBuf::from) else {
        println!("skipped: no pictures are wanted (set BACKLIT_SCREENSHOTS to a folder)");
        return;
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    // One screen after the other: there is never more than one.
    for pictures in [debug, pose, new_take, demonstration] {
        pictures(&Desk::new().expect("pictures of the window need a virtual screen"), &folder);
    }
}

fn debug(desk: &Desk, folder: &Path) {
    let mut window = Window::of_built_in_take(desk);
    window.key_until_still("F2", "the debug layout", |state| state["layout"] == "debug");
    window.key_until_still("Return", "a run to its end", |state| !state["runs"][0]["ending"].is_null());
    picture(&mut window, folder, "debug-dark");
}

fn pose(desk: &Desk, folder: &Path) {
    let mut window = Window::of_built_in_take(desk);
    let is_tracked = |state: &Value| state["track"]["frames"] == state["take"]["frames"];
    window.key_until_still("ctrl+Return", "the whole take is tracked", is_tracked);
    window.key_until_still("Home", "the first frame", |state| state["frame"] == 0);
    go_on_to(&mut window, 24);
    picture(&mut window, folder, "pose-dark");
    window.command("dark or light");
    window.until_still("the light theme", |state| state["theme"] == "light");
    go_on_to(&mut window, 46);
    window.resize(1280, 800);
    picture(&mut window, folder, "pose-light");
}

fn new_take(desk: &Desk, folder: &Path) {
    let recording = recording(desk.home());
    let mut window = Window::of_built_in_take(desk);
    window.resize(1280, 800);
    desk.answer_dialogs_with(&recording);
    window.command("new take");
    window.until_still("the card", |state| state["over"] == "new take");
    window.click("Choose folder…");
    window.click("Frames a second");
    window.type_text("30\t");
    window.until_still("it is looked at again", |_| true);
    picture(&mut window, folder, "new-take");
}

fn demonstration(desk: &Desk, folder: &Path) {
    let mut window = Window::of_built_in_take(desk);
    window.command("dark or light");
    window.until_still("the light theme", |state| state["theme"] == "light");
    let is_shown = |state: &Value| state["take"]["source"]["demonstration"].is_string();
    window.command("one limb three");
    window.until_still("the demonstration", is_shown);
    window.key_until_still("F3", "its laboratory", |state| state["layout"] == "demonstrate");
    picture(&mut window, folder, "demonstrate-fig51");
}
