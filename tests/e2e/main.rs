//! The real window on a virtual screen with software GL, driven by mouse and keyboard, and asked by the state that it
//! exports whether each act did what it should.
//!
//!     cargo test --test e2e -- --nocapture
//!
//! | variable | meaning |
//! |---|---|
//! | `BACKLIT_BIN` | the program [default: the one that is tested] |
//! | `BACKLIT_SHOTS` | folder for pictures of what the tests see [default: none are kept] |
//! | `BACKLIT_SCREENSHOTS` | folder for the README's pictures of the window [default: none are made] |
//! | `BACKLIT_DATA` | where the real footage lies; without it that part is skipped, or fails where `BACKLIT_REQUIRE_DATA=1` |
//!
//! The README's pictures are made again by
//!
//!     BACKLIT_SCREENSHOTS=screenshots cargo test --release --test e2e readme
//!
//! Needs no GPU and no desktop. Debian packages: xvfb xdotool imagemagick libx11-6 libx11-xcb1 libxcursor1 libxi6
//! libxkbcommon-x11-0 libegl1 libgl1-mesa-dri. Where a program is missing it says so and skips.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

mod clipboard;
mod desk;
#[path = "../../crates/tracking/tests/tracking/footage.rs"]
mod footage;
mod readme;
mod window;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::Value;

use desk::Desk;
use window::Window;

/// Frames a second of the built-in take.
const BUILT_IN_RATE: f64 = 30.0;
/// The first picture may have to be read, and a busy machine looks late: seconds.
const LATE: f64 = 8.0;

#[test]
fn every_act_does_what_it_should() {
    let Some(desk) = Desk::new() else { return };
    let mut window = Window::open(&desk, &[]);
    window.until_still("the built-in take is there", |_| true);
    window.picture("start");
    window.dismiss("Not now");
    posing(&mut window);
    stepping(&mut window);
    looking(&mut window);
    playing(&mut window);
    tracking(&mut window);
    let saved = saving(&desk, &mut window);
    window.quit();
    opening_again(&desk, &saved);
}

/// A drag moves the pose as one act that can be undone.
fn posing(window: &mut Window<'_>) {
    let start = window.state()["pose"].clone();
    window.press_at("right wrist, Camera 1");
    window.move_by(-6, -9);
    window.move_by(-30, -40);
    window.until("the hand holds the wrist", |state| state["held"] == true && state["pose"] != start);
    window.picture("drag");
    window.release();
    let dragged = window.until_still("the hand is empty", |state| state["held"] == false);
    assert_eq!(dragged["track"]["keys"], serde_json::json!([0]), "a drag sets a key pose");
    window.key_until_still("ctrl+z", "undo brings the pose back", |state| state["pose"] == start);
    window.key_until("ctrl+shift+z", "redo takes it away again", |state| state["pose"] == dragged["pose"]);

    window.press_at("left wrist, Camera 2");
    window.move_by(25, 10);
    window.until("another joint is held", |state| state["held"] == true && state["pose"] != dragged["pose"]);
    window.key_until("Escape", "Esc puts it back", |state| {
        state["held"] == false && state["pose"] == dragged["pose"]
    });
    window.release();
    window.key_until_still("ctrl+z", "the start again", |state| state["pose"] == start);
}

/// Steps, a run to its end, looking back, another renderer.
fn stepping(window: &mut Window<'_>) {
    let before = window.state();
    let stepped = window.key_until_still("space", "a step was made", |state| state["runs"][0]["steps"] == 1);
    assert!(number(&stepped["runs"][0]["cost"]) < number(&before["cost"]), "the first step lowers the cost");
    let ended =
        window.key_until_still("Return", "the run has ended", |state| !state["runs"][0]["ending"].is_null());
    assert!(number(&ended["iou"]) > 0.8, "the run fits: {}", ended["iou"]);
    window.key_until("comma", "an earlier step is looked at", |state| {
        !state["step"].is_null() && state["pose"] != ended["pose"]
    });
    window.key_until("Escape", "the newest step again", |state| {
        state["step"].is_null() && state["pose"] == ended["pose"]
    });
    for (key, renderer) in [("y", "cylinder"), ("s", "sphere-tree"), ("c", "capsule")] {
        window.key_until_still(key, &format!("{key} draws with another solid"), |state| {
            state["renderer"]
                .as_str()
                .is_some_and(|name| name.replace(' ', "-").eq_ignore_ascii_case(renderer))
        });
    }
}

/// View modes, layouts, sizes, themes, the palette.
fn looking(window: &mut Window<'_>) {
    for (key, mode) in [
        ("o", "footage"),
        ("d", "data"),
        ("m", "prediction"),
        ("r", "residual"),
        ("v", "report-overlay"),
        ("l", "owner-limb"),
        ("g", "gradient"),
        ("j", "jacobian-column"),
        ("t", "tinted"),
    ] {
        window.key_until_still(key, &format!("{key} shows {mode}"), |state| {
            state["cameras"][0]["mode"] == mode
        });
    }
    window.key_until("w", "W wipes", |state| !active(state)["wipe"].is_null());
    window.key_until("w", "and again does not", |state| active(state)["wipe"].is_null());
    window.key_until("1", "camera 1 fills the centre", |state| state["alone"] == "Camera 1");
    window.picture("alone");
    window.key_until("Escape", "and goes back", |state| state["alone"].is_null());
    for (key, layout) in [("F2", "debug"), ("F3", "demonstrate"), ("F1", "pose")] {
        window.key_until_still(key, &format!("{key} is the {layout} layout"), |state| {
            state["layout"] == layout
        });
        window.picture(layout);
    }
    window.resize(1100, 700);
    window.until_still("a small window", |_| true);
    window.picture("small");
    window.resize(1600, 1000);
    window.command("dark or light");
    window.until("the theme is light", |state| state["theme"] == "light" && state["over"].is_null());
    window.picture("light");
    window.key_until("ctrl+b", "the panel is gone", |state| state["panel"] == false);
    window.key_until("ctrl+b", "and back", |state| state["panel"] == true);
    // A narrow tile keeps it in its menu.
    window.click("More for Camera 1");
    window.click("Used in the fit");
    window.until("camera 1 is left out", |state| state["cameras"][0]["used"] == false);
    // Keys belong to the menu as long as it is open.
    window.key("Escape");
    window.until_gone("Close tile");
    window.key_until_still("ctrl+z", "and is used again", |state| state["cameras"][0]["used"] == true);
}

/// The film keeps the time of the take, stops by its key and at its end.
fn playing(window: &mut Window<'_>) {
    let start = window.key_until_still("Home", "the first frame", |state| state["frame"] == 0);
    window.key_until("p", "P plays", |state| state["playing"] == true && number(&state["frame"]) >= 3.0);
    let paused = window.key_until_still("p", "and again pauses", |state| state["playing"] == false);
    assert!(number(&paused["frame"]) < number(&start["take"]["frames"]) - 1.0, "it is under way");
    let last = number(&start["take"]["frames"]) - 1.0;
    window.key_until_still("End", "the last frame", |state| number(&state["frame"]) == last);
    let began = Instant::now();
    window.key_until("p", "at the end it begins again", |state| number(&state["frame"]) < last);
    let over = |state: &Value| state["playing"] == false && number(&state["frame"]) == last;
    window.until("and stops at the end", over);
    let (took, film) = (began.elapsed().as_secs_f64(), (last + 1.0) / BUILT_IN_RATE);
    assert!(took > 0.9 * film && took < film + LATE, "a film of {film} s took {took} s");
    window.key_until_still("Home", "the first frame again", |state| state["frame"] == 0);
}

/// The tracker runs, is stopped, and what it did stays.
fn tracking(window: &mut Window<'_>) {
    window.key_until_still("Right", "the next frame", |state| state["frame"] == 1);
    window.key_until_still("Home", "the first frame", |state| state["frame"] == 0);
    window.key_until("ctrl+Return", "the tracker runs", |state| number(&state["track"]["frames"]) >= 6.0);
    let stopped =
        window.key_until_still("Escape", "it has stopped", |state| state["track"]["running"].is_null());
    assert!(number(&stopped["track"]["frames"]) >= 6.0);
    window.key_until("n", "the worst frame", |state| {
        state["frame"] != stopped["frame"] || state["idle"] == true
    });
    window.picture("track");
}

/// Saves through the file dialog; the project and what was in it.
fn saving(desk: &Desk, window: &mut Window<'_>) -> (PathBuf, Value) {
    let path = desk.home().join("saved.backlit");
    desk.answer_dialogs_with(&path);
    let state = window.key_until("ctrl+s", "the project is saved", |state| {
        state["unsaved"] == false && !state["project"].is_null()
    });
    assert!(fs::metadata(&path).unwrap().len() > 1000);

    // The motion, by its card.
    let motion = desk.home().join("motion.bvh");
    window.command("export motion");
    window.until("the card is there", |state| state["over"] == "export");
    window.picture("export-motion");
    window.click("Motion file");
    window.key("ctrl+a");
    window.type_text(motion.to_str().unwrap());
    window.click("Export");
    window.until("the motion is written", |_| motion.is_file());
    let text = fs::read_to_string(&motion).unwrap();
    assert!(text.starts_with("HIERARCHY") && text.contains("Frames: "), "{text:.200}");
    (path, state)
}

/// The saved project opens as it was; killed in the middle of a drag, the next start offers that very pose.
fn opening_again(desk: &Desk, (path, saved): &(PathBuf, Value)) {
    let mut window = Window::open(desk, &[path.to_str().unwrap()]);
    let opened = window.until_still("the project is open", |_| true);
    assert_eq!(opened["track"], saved["track"]);
    assert_eq!(opened["theme"], "light", "the arrangement is kept");
    let before = window.key_until_still("Home", "the first frame", |state| state["frame"] == 0);
    window.press_at("left elbow, Camera 1");
    window.move_by(8, 8);
    window.move_by(30, 25);
    let held = window.until("a drag", |state| state["held"] == true && state["pose"] != before["pose"]);
    // Work of the last second may be lost, not more.
    std::thread::sleep(std::time::Duration::from_millis(2500));
    window.kill();

    let mut window = Window::open(desk, &[]);
    window.until("what was unsaved is offered", |state| {
        state["recovery"].as_array().is_some_and(|all| all.len() == 1)
    });
    window.picture("offer");
    window.click("Unsaved work…");
    window.click("Restore");
    let restored = window.until_still("it is back", |_| true);
    assert!(is_near(&restored["pose"], &held["pose"]), "{} instead of {}", restored["pose"], held["pose"]);
    assert_eq!(restored["unsaved"], true);
    window.quit();
}

#[test]
fn a_path_that_is_not_there_is_named() {
    let Some(desk) = Desk::new() else { return };
    let output = desk.program(&["no/such/take"]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && message.contains("no/such/take"), "{message}");
}

#[test]
fn real_footage_is_fitted() {
    if footage::footage().is_none() {
        return;
    }
    let Some(desk) = Desk::new() else { return };
    let take = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/takes/balancing");
    let mut window = Window::open(&desk, &[take.to_str().unwrap()]);
    window.until_still("the take is there", |_| true);
    let fitted =
        window.key_until_still("Return", "it is fitted", |state| !state["runs"][0]["ending"].is_null());
    assert!(number(&fitted["iou"]) > 0.8, "{}", fitted["iou"]);
    window.picture("real");
    window.quit();
}

/// The camera whose tile the keys are about.
fn active(state: &Value) -> &Value {
    &state["cameras"][state["camera"].as_u64().unwrap_or(0) as usize]
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Whether two poses are the same but for rounding in a file.
fn is_near(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| is_near(a, b)))
        }
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_near(a, b))
        }
        _ => (number(a) - number(b)).abs() < 1e-9,
    }
}
