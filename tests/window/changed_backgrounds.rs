//! A background that changes is learnt again when the take is tracked: a flag on the timeline, kept in the project, and undone.

use backlit_document::project::read_project;
use backlit_tracking::silhouette::Label;
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::disturbed_take;
use crate::support::window::{Window, WindowState, at, click, press, save, settle, undo};

const TOLD: &str = "cam2: a thing stands in the picture from frame 20 (0.67 s) on";

/// How many pixels of the second camera are background in the frame on the screen.
fn background(window: &Window) -> usize {
    let frame = window.session().frames.get(window.selection().frame).unwrap();
    frame.cameras[1].mask.as_ref().unwrap().count(Label::Background)
}

#[test]
fn a_thing_that_is_put_down_is_learnt_and_flagged() {
    let folder = tempfile::tempdir().unwrap();
    disturbed_take::write(folder.path(), 2, 20);
    let mut window = at(folder.path()).open();
    window.state_mut().inspector.state.go_to_frame(48);
    settle(&mut window);
    let before = (window.document().clone(), background(&window));
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    let said = window.said().join("\n");
    assert!(said.contains(TOLD), "{said}");
    let changes = window.document().changes.clone();
    let found: Vec<_> = changes.iter().map(|change| (change.camera, change.from, change.until)).collect();
    assert_eq!(found, [(1, 20, None)]);
    let flag = {
        let mut buttons = window.get_all_by_role(Role::Button);
        buttons.find_map(|button| button.accesskit_node().label().filter(|label| label.starts_with(TOLD)))
    };
    click(&mut window, &flag.expect("a flag on the timeline"));
    assert_eq!(window.selection().frame, 20);
    let project = folder.path().join("changed.backlit");
    save(&mut window, &project);
    assert_eq!(read_project(&project).unwrap().document.changes, changes);
    window.state_mut().inspector.state.go_to_frame(48);
    settle(&mut window);
    let learnt = background(&window);
    undo(&mut window);
    assert_eq!(
        (window.document(), background(&window)),
        (&before.0, before.1),
        "the track with what it learnt"
    );
    assert!(learnt > before.1 + 1000, "{learnt} of {}", before.1);
}
