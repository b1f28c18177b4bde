//! Poses on the system's clipboard: from frame to frame, and from one program to another.

use serde_json::Value;

use crate::desk::Desk;
use crate::is_near;
use crate::window::Window;

fn is_ready(state: &Value) -> bool {
    state["take"]["loaded"] == true && state["idle"] == true
}

/// A window with the built-in take.
fn open(desk: &Desk) -> Window<'_> {
    let mut window = Window::open(desk, &[]);
    window.until("the built-in take is there", is_ready);
    window.dismiss("Not now");
    window
}

/// Drags a wrist a little: a pose of its own for the frame.
fn pose_by_hand(window: &mut Window<'_>, by: [i32; 2]) -> Value {
    let before = window.state()["pose"].clone();
    window.press_at("right wrist, Camera 1");
    window.move_by(-6, -9);
    window.move_by(by[0], by[1]);
    window.until("the hand moves the wrist", |state| state["held"] == true && state["pose"] != before);
    window.release();
    let after = window.until("it lets go", |state| state["held"] == false && is_ready(state));
    after["pose"].clone()
}

#[test]
fn poses_are_copied_and_pasted() {
    let Some(desk) = Desk::new() else { return };
    let mut window = open(&desk);
    let copied = pose_by_hand(&mut window, [-25, -35]);
    window.key("ctrl+c");
    window.key("Right");
    window.until("the next frame", |state| state["frame"] == 1 && is_ready(state));
    let other = pose_by_hand(&mut window, [30, 30]);
    assert_ne!(other, copied);
    window.key("ctrl+v");
    window.until("Ctrl+V gives the frame the copied pose", |state| {
        is_near(&state["pose"], &copied) && state["undo"] == "Paste pose" && is_ready(state)
    });
    window.key("ctrl+z");
    window.until("Ctrl+Z takes it back", |state| state["pose"] == other && is_ready(state));

    // Another program has it from the system's clipboard only.
    let mut beside = open(&desk);
    let before = beside.state()["pose"].clone();
    assert!(!is_near(&before, &copied));
    beside.focus();
    beside.key("ctrl+v");
    beside.until("another window is given the pose", |state| is_near(&state["pose"], &copied));
    beside.key("ctrl+z");
    beside.until("and gives it back", |state| state["pose"] == before && is_ready(state));
    beside.quit();
    window.focus();
    window.quit();
}
