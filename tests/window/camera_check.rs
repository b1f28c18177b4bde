//! The check of cameras through the real window: what is wrong is told, repaired, taken back, and saved.

use std::path::{Path, PathBuf};

use backlit_document::project::read_project;
use backlit_take::demonstration::Demonstration;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;
use serde_json::Value;

use crate::drop::drop_on;
use crate::readable::{SIZES, assert_readable, look_over};
use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Window, WindowState, at, built_in, choose, click, close_notices, command, demonstration, press, save,
    undo,
};

const WRONG: &str = "cam3 has a wrong focal length";
const REPAIR: &str = "Use repaired cameras";

/// The cameras of the built-in take with a focal length that is wrong by a twentieth, in a file.
fn wrong_cameras(folder: &Path) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take/cameras.json");
    let mut cameras: Value = serde_json::from_str(&std::fs::read_to_string(from).unwrap()).unwrap();
    for field in ["fx", "fy"] {
        let value = &mut cameras["cameras"][2][field];
        *value = (1.05 * value.as_f64().unwrap()).into();
    }
    let path = folder.join("wrong.json");
    std::fs::write(&path, cameras.to_string()).unwrap();
    path
}

/// The card on the built-in take seen by wrong cameras.
fn checked(theme: Theme, [width, height]: [f32; 2]) -> Window {
    let folder = tempfile::tempdir().unwrap();
    let mut window = built_in().theme(theme).sized(width, height).open();
    drop_on(&mut window, &[wrong_cameras(folder.path())]);
    close_notices(&mut window);
    window.set_render_cursor(false);
    command(&mut window, "Check cameras…");
    window
}

#[test]
fn a_wrong_camera_is_found_and_repaired_and_the_repair_is_saved() {
    let mut window = checked(Theme::Dark, [1366.0, 768.0]);
    let before = window.document().calibration.clone();
    choose(&mut window, Role::Link, WRONG);
    assert_eq!(window.selection().camera, 2, "a click on what was found selects the camera");
    click(&mut window, REPAIR);
    window.get_by_label_contains("In use now: cameras with this repaired: cam3 has");
    assert!(window.query_by_label(REPAIR).is_none(), "what was found is about other cameras");
    click(&mut window, "Undo repair");
    assert_eq!(window.document().calibration, before);
    click(&mut window, REPAIR);
    click(&mut window, "Check again");
    window.get_by_label_contains("Nothing is wrong with the cameras");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label("Check again").is_none(), "the card is closed");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("repaired.backlit");
    save(&mut window, &path);
    assert_eq!(read_project(&path).unwrap().document.calibration, window.document().calibration);
    let again = at(&path).open();
    assert_eq!(again.document().calibration, window.document().calibration, "no file of theirs is asked for");
    assert_eq!(again.said(), Vec::<String>::new());
    let focal = |window: &Window| window.session().take.as_ref().unwrap().cameras[2].intrinsics().fx;
    assert_eq!(focal(&again), focal(&window));
    undo(&mut window);
    assert_eq!(window.document().calibration, before, "one step back");
}

#[test]
fn every_word_of_the_card_can_be_read() {
    let mut wrong = Vec::new();
    for size in SIZES {
        let mut window = checked(Theme::Dark, size.into());
        look_over(&window, &format!("found at {size}"), &mut wrong);
        click(&mut window, REPAIR);
        look_over(&window, &format!("repaired at {size}"), &mut wrong);
    }
    assert_readable(&wrong);
}

#[test]
fn the_card_in_both_themes() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut window = checked(theme, [1024.0, 640.0]);
        let card = Rect::from_min_size(pos2(186.0, 96.0), vec2(652.0, 452.0));
        snapshots.part(&mut window, card, &format!("panel_camera_check_{}", theme_name(theme)));
        if theme == Theme::Dark {
            click(&mut window, REPAIR);
            snapshots.part(&mut window, card, "panel_camera_check_repaired");
        }
        let mut window = demonstration(Demonstration::Cues).theme(theme).sized(1024.0, 640.0).open();
        close_notices(&mut window);
        window.set_render_cursor(false);
        command(&mut window, "Check cameras…");
        // The card alone: the body behind it is still being drawn.
        let inside = Rect::from_min_size(pos2(196.0, 108.0), vec2(632.0, 192.0));
        snapshots.part(&mut window, inside, &format!("panel_camera_check_keypoints_{}", theme_name(theme)));
    }
}
