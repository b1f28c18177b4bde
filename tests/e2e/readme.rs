//! The README's pictures, of the real window.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::desk::Desk;
use crate::window::Window;

/// A window with the built-in take, whose picture goes into a folder.
struct Sitting<'a> {
    window: Window<'a>,
    folder: &'a Path,
}

impl<'a> Sitting<'a> {
    fn new(desk: &'a Desk, folder: &'a Path) -> Self {
        let mut window = Window::open(desk, &[]);
        window.until("the built-in take is there", is_still);
        window.dismiss("Not now");
        Self { window, folder }
    }

    fn command(&mut self, name: &str, what: &str, is_so: impl Fn(&Value) -> bool) {
        self.window.key("ctrl+k");
        self.window.until("the palette is there", |state| state["over"] == "palette");
        self.window.type_text(name);
        self.window.key("Return");
        self.window.until(what, |state| is_so(state) && is_still(state));
    }

    fn key(&mut self, key: &str, what: &str, is_so: impl Fn(&Value) -> bool) {
        self.window.key(key);
        self.window.until(what, |state| is_so(state) && is_still(state));
    }

    /// Goes on to a later frame.
    fn go_on_to(&mut self, frame: u64) {
        while let Some(left) = frame.checked_sub(self.window.state()["frame"].as_u64().unwrap_or(0)) {
            let (key, by) = match left {
                0 => return,
                1..=9 => ("Right", 1),
                _ => ("shift+Right", 10),
            };
            let to = frame - left + by;
            self.key(key, "a later frame", |state| state["frame"] == to);
        }
    }

    fn picture(&mut self, name: &str) {
        self.window.until("notices have gone", |state| state["notices"].as_array().is_none_or(Vec::is_empty));
        self.window.picture_in(self.folder, name);
    }
}

fn is_still(state: &Value) -> bool {
    state["take"]["loaded"] == true && state["idle"] == true
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
    let mut sitting = Sitting::new(desk, folder);
    sitting.key("F2", "the debug layout", |state| state["layout"] == "debug");
    sitting.key("Return", "a run to its end", |state| !state["runs"][0]["ending"].is_null());
    sitting.picture("debug-dark");
}

fn pose(desk: &Desk, folder: &Path) {
    let mut sitting = Sitting::new(desk, folder);
    let is_tracked = |state: &Value| state["track"]["frames"] == state["take"]["frames"];
    sitting.key("ctrl+Return", "the whole take is tracked", is_tracked);
    sitting.key("Home", "the first frame", |state| state["frame"] == 0);
    sitting.go_on_to(24);
    sitting.picture("pose-dark");
    sitting.command("dark or light", "the light theme", |state| state["theme"] == "light");
    sitting.go_on_to(46);
    sitting.window.resize(1280, 800);
    sitting.picture("pose-light");
}

fn new_take(desk: &Desk, folder: &Path) {
    let recording = recording(desk.home());
    let mut sitting = Sitting::new(desk, folder);
    sitting.window.resize(1280, 800);
    desk.answer_dialogs_with(&recording);
    sitting.command("new take", "the card", |state| state["over"] == "new take");
    sitting.window.click("Choose folder…");
    sitting.window.click("Frames a second");
    sitting.window.type_text("30\t");
    sitting.window.until("it is looked at again", is_still);
    sitting.picture("new-take");
}

fn demonstration(desk: &Desk, folder: &Path) {
    let mut sitting = Sitting::new(desk, folder);
    sitting.command("dark or light", "the light theme", |state| state["theme"] == "light");
    let is_shown = |state: &Value| state["take"]["source"]["demonstration"].is_string();
    sitting.command("one limb three", "the demonstration", is_shown);
    sitting.key("F3", "its laboratory", |state| state["layout"] == "demonstrate");
    sitting.picture("demonstrate-fig51");
}
