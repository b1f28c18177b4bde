//! The state that the window writes to a file, for tests that drive it from outside.

use std::path::Path;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use serde_json::{Value, json};

use crate::support::take;
use crate::support::window::{Window, arm, click, press, settle};

fn read(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn open(path: &Path) -> Window {
    arm().with(|options| options.state_file = Some(path.to_owned())).open()
}

#[test]
fn the_file_follows_what_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.json");
    let mut harness = open(&path);
    let first = read(&path);
    assert_eq!(first["format"], "backlit-state 1");
    let state = &first["state"];
    assert_eq!((&state["take"]["name"], &state["take"]["frames"]), (&json!("arm"), &json!(take::FRAMES)));
    assert_eq!(
        (&state["frame"], &state["idle"], &state["unsaved"]),
        (&json!(0), &json!(true), &json!(false))
    );
    assert!(state["iou"].as_f64().unwrap() > 0.2);

    // A joint is where its handle is.
    let widgets = first["widgets"].as_array().unwrap();
    let joint = widgets.iter().find(|widget| widget["name"] == "right wrist, Camera 1").unwrap();
    let shown = harness.get_by_label("right wrist, Camera 1").rect();
    assert!((joint["rect"][0].as_f64().unwrap() - f64::from(shown.left())).abs() < 0.11, "{joint} {shown}");
    assert!(widgets.iter().any(|widget| widget["name"] == "Redo" && widget["disabled"] == true));

    click(&mut harness, "Step");
    let stepped = read(&path);
    assert!(stepped["serial"].as_u64() > first["serial"].as_u64());
    assert_eq!(stepped["state"]["runs"][0]["steps"], 1);
    assert_eq!((&stepped["state"]["undo"], &stepped["state"]["unsaved"]), (&json!("Fit"), &json!(true)));
    assert_ne!(stepped["state"]["pose"], first["state"]["pose"]);

    press(&mut harness, Modifiers::NONE, Key::F2);
    press(&mut harness, Modifiers::COMMAND, Key::K);
    let over = read(&path);
    assert_eq!((&over["state"]["layout"], &over["state"]["over"]), (&json!("debug"), &json!("palette")));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    click(&mut harness, "Track forward");
    let tracked = read(&path);
    assert_eq!(tracked["state"]["track"]["frames"], take::FRAMES);
    assert_eq!(tracked["state"]["notices"][0]["action"], "Undo");
}

#[test]
fn nothing_new_is_nothing_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.json");
    let mut harness = open(&path);
    harness.state_mut().inspector.freeze_times();
    settle(&mut harness);
    let step = |harness: &mut Window| {
        harness.state_mut().inspector.freeze_times();
        harness.step();
    };
    step(&mut harness);
    let before = read(&path);
    for _ in 0..3 {
        step(&mut harness);
    }
    assert_eq!(read(&path), before);
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["state.json"]);
}
