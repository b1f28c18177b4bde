//! Poses on the system's clipboard: from frame to frame, and from one program to another.

use serde_json::Value;

use crate::desk::Desk;
use crate::is_near;
use crate::window::Window;

/// Drags a wrist a little: a pose of its own for the frame.
fn pose_by_hand(window: &mut Window<'_>, by: [i32; 2]) -> Value {
    let before = window.state()["pose"].clone();
    window.press_at("right wrist, Camera 1");
    window.move_by(-6, -9);
    window.move_by(by[0], by[1]);
    window.until("the hand moves the wrist", |state| state["held"] == true && state["pose"] != before);
    window.release();
    let after = window.until_still("it lets go", |state| state["held"] == false);
    after["pose"].clone()
}

#[test]
fn poses_are_copied_and_pasted() {
    let Some(desk) = Desk::new() else { return };
    let mut window = Window::of_built_in_take(&desk);
    let copied = pose_by_hand(&mut window, [-25, -35]);
    window.key("ctrl+c");
    window.key_until_still("Right", "the next frame", |state| state["frame"] == 1);
    let other = pose_by_hand(&mut window, [30, 30]);
    assert_ne!(other, copied);
    window.key_until_still("ctrl+v", "Ctrl+V gives the frame the copied pose", |state| {
        is_near(&state["pose"], &copied) && state["undo"] == "Paste pose"
    });
    window.key_until_still("ctrl+z", "Ctrl+Z takes it back", |state| state["pose"] == other);

    // Another program has it from the system's clipboard only.
    let mut beside = Window::of_built_in_take(&desk);
    let before = beside.state()["pose"].clone();
    assert!(!is_near(&before, &copied));
    beside.focus();
    beside.key_until("ctrl+v", "another window is given the pose", |state| is_near(&state["pose"], &copied));
    beside.key_until_still("ctrl+z", "and gives it back", |state| state["pose"] == before);
    beside.quit();
    window.focus();
    window.quit();
}
