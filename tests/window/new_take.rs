//! A new take through the real window: a folder is looked through, what is missing is asked for, the take opens.

use std::path::{Path, PathBuf};

use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::footage::footage;
use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Window, WindowState, click, command, empty, grab, press, release, settle, type_over,
};

/// Frames that are copied.
const FRAMES: usize = 24;
/// Where a track of real footage begins.
const LATE: usize = 55;

/// The pictures and the calibration of the built-in take, as a user who knows nothing of takes would have them.
fn recording(folder: &Path) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take");
    let to = folder.join("practice");
    std::fs::create_dir_all(to.join("calibration")).unwrap();
    std::fs::copy(from.join("cameras.json"), to.join("calibration/cameras.json")).unwrap();
    for camera in ["cam1", "cam2", "cam3", "cam4"] {
        std::fs::create_dir_all(to.join("images").join(camera)).unwrap();
        for frame in 0..FRAMES {
            let name = format!("frame_{frame:03}.jpg");
            let target = to.join("images").join(camera).join(&name);
            std::fs::copy(from.join(camera).join(&name), target).unwrap();
        }
    }
    to
}

fn look_at(harness: &mut Window, paths: Vec<PathBuf>) {
    harness.state_mut().inspector.new_take(paths);
    settle(harness);
}

#[test]
fn footage_becomes_a_take_without_a_file_by_hand() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = recording(folder.path());
    let mut harness = empty().sized(1280.0, 800.0).open();
    press(&mut harness, Modifiers::COMMAND, Key::N);
    harness.get_by_label_contains("Nothing is copied");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    look_at(&mut harness, vec![recorded]);
    harness.get_by_label_contains("24 frames of 4 cameras");
    harness.get_by_label("First picture of cam3");
    // Pictures do not say how many there are a second.
    harness.get_by_label("the footage does not say it");
    type_over(&mut harness, "Frames a second", "30");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    click(&mut harness, "Create take");
    assert!(harness.query_by_label("Create take").is_none(), "the card has closed");
    let take = folder.path().join("practice take");
    assert!(take.join("take.toml").is_file() && take.join("background/cam2.png").is_file());
    let session = harness.session();
    assert_eq!(session.frame_count(), FRAMES);
    harness.get_by_role_and_label(Role::Button, "Track forward");
}

/// From the folder of another tool to a tracked person, without a file by hand: start and sizes are found on the way.
#[test]
fn a_project_of_another_tool_becomes_a_tracked_person() {
    let project = footage().map(|footage| footage.with_file_name("formats/project_pose2sim_single"));
    let Some(project) = project.filter(|project| project.is_dir()) else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut harness = empty().sized(1280.0, 800.0).open();
    look_at(&mut harness, vec![project]);
    type_over(&mut harness, "Take goes to", &folder.path().join("take").display().to_string());
    click(&mut harness, "Create take");
    let frames = harness.session().frame_count();
    assert_eq!(frames, 70);
    if harness.document().cameras.len() < 4 {
        eprintln!("SKIPPED: one of the videos needs ffmpeg");
        return;
    }
    // The last frames: all of them take a minute.
    harness.state_mut().inspector.state.go_to_frame(LATE);
    settle(&mut harness);
    click(&mut harness, "Track forward");
    let found: Vec<_> = harness.document().estimates.range(LATE..).collect();
    assert_eq!(found.len(), frames - LATE);
    assert!(found.iter().all(|(_, estimate)| !estimate.lost));
    let iou = found.iter().filter_map(|(_, estimate)| estimate.iou).sum::<f64>() / found.len() as f64;
    assert!(iou >= 0.86, "mean IoU {iou}");
}

#[test]
fn nothing_on_the_card_moves_once_it_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = recording(folder.path());
    let mut harness = empty().sized(1600.0, 1000.0).open();
    look_at(&mut harness, vec![recorded]);
    let place = |harness: &Window| harness.get_by_label("Create take").rect();
    let before = place(&harness);
    // As when the pointer moves.
    harness.run_steps(3);
    assert_eq!(place(&harness), before);
}

/// What is found makes the card longer, not higher, and a click beside it does not throw away what was chosen.
#[test]
fn the_card_hangs_where_it_is_and_stays_while_it_is_filled_in() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = recording(folder.path());
    let mut window = empty().sized(1600.0, 1000.0).open();
    command(&mut window, "New take…");
    let place = |window: &Window| window.get_by_label("Choose folder…").rect().min;
    let before = place(&window);
    type_over(&mut window, "Footage", &recorded.display().to_string());
    press(&mut window, Modifiers::NONE, Key::Tab);
    settle(&mut window);
    window.get_by_label("First picture of cam1");
    assert_eq!(place(&window), before);
    let beside = pos2(20.0, 900.0);
    grab(&mut window, beside, &[]);
    release(&mut window, beside);
    settle(&mut window);
    assert_eq!(place(&window), before, "the card has closed or moved");
}

#[test]
fn what_cannot_be_used_is_said_on_the_card() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = empty().sized(1280.0, 800.0).open();
    look_at(&mut harness, vec![folder.path().to_owned()]);
    harness.get_by_label_contains("no video and no numbered pictures are there");
}

#[test]
fn the_card_in_both_themes() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = recording(folder.path());
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = empty().theme(theme).sized(1024.0, 640.0).open();
        harness.set_render_cursor(false);
        look_at(&mut harness, vec![recorded.clone()]);
        // The folder is another one each time.
        type_over(&mut harness, "Footage", "recordings/practice");
        type_over(&mut harness, "Take goes to", "recordings/practice take");
        let card = Rect::from_min_size(pos2(184.0, 96.0), vec2(656.0, 450.0));
        snapshots.part(&mut harness, card, &format!("panel_new_take_{}", theme_name(theme)));
    }
}
