//! Files dropped on the window, and the cards around it: recent takes, the palette, About.

use std::path::{Path, PathBuf};

use backlit::app::settings::Settings;
use backlit_document::project::read_project;
use backlit_formats::pose_file;
use backlit_tracking::silhouette::Label;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{DroppedFile, DroppedFileHandle, HoveredFile, Key, Modifiers, Rect, Vec2, pos2, vec2};
use egui_kittest::kittest::Queryable;
use image::{GrayImage, Luma};

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::take;
use crate::support::window::{
    Window, WindowState, arm, around, at, choose, click, command, empty, press, save, settle, undo,
};

/// A take in a folder.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    take::write_to(folder.path());
    folder
}

fn open(path: &Path) -> Window {
    at(path).sized(1300.0, 860.0).open()
}

#[derive(Debug)]
struct File(PathBuf);

impl DroppedFile for File {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

pub(crate) fn drop_on(harness: &mut Window, paths: &[PathBuf]) {
    let file = |path: &PathBuf| -> DroppedFileHandle { std::sync::Arc::new(File(path.clone())) };
    harness.input_mut().dropped_files = paths.iter().map(file).collect();
    harness.step();
    harness.input_mut().dropped_files.clear();
    settle(harness);
}

fn hover(harness: &mut Window, path: &Path) {
    let file = HoveredFile { path: Some(path.to_owned()), ..HoveredFile::default() };
    harness.input_mut().hovered_files = vec![file];
    harness.run_steps(3);
}

fn subject_pixels(harness: &Window, camera: usize) -> usize {
    let frame = harness.session().frames.get(0).unwrap();
    frame.cameras[camera].mask.as_ref().unwrap().count(Label::Subject)
}

#[test]
fn a_calibration_replaces_the_cameras_and_is_undone() {
    let folder = folder();
    let mut harness = open(folder.path());
    let centre = |harness: &Window| harness.session().take.as_ref().unwrap().cameras[0].centre();
    let before = centre(&harness);
    let iou = harness.session().iou().unwrap();
    let text = std::fs::read_to_string(folder.path().join("cameras.json")).unwrap();
    // The first camera sees through the second one's place.
    let swapped = text.replace("front", "?").replace("above", "front").replace('?', "above");
    let path = folder.path().join("swapped.json");
    std::fs::write(&path, swapped).unwrap();
    drop_on(&mut harness, std::slice::from_ref(&path));
    assert_eq!(harness.last_said(), "The 2 cameras now come from swapped.json.");
    assert!(centre(&harness).distance(before) > 0.5);
    assert!(harness.session().iou().unwrap() < iou, "the body is not where these cameras see it");

    let project = folder.path().join("a.backlit");
    save(&mut harness, &project);
    let saved = read_project(&project).unwrap().document;
    assert_eq!(saved, *harness.document());
    let again = open(&project);
    assert!(centre(&again).distance(before) > 0.5, "a project brings its cameras");

    undo(&mut harness);
    assert!(centre(&harness).distance(before) < 1e-9);
    assert!((harness.session().iou().unwrap() - iou).abs() < 1e-12);
}

#[test]
fn a_calibration_of_another_rig_is_an_error_that_says_what_differs() {
    let folder = folder();
    let mut harness = open(folder.path());
    let before = harness.document().clone();
    let text = std::fs::read_to_string(folder.path().join("cameras.json")).unwrap();
    let path = folder.path().join("one.json");
    let first = text.find("{\"name\": \"above\"").unwrap();
    std::fs::write(&path, format!("{}]}}", text[..first].trim_end().trim_end_matches(','))).unwrap();
    drop_on(&mut harness, &[path]);
    assert!(
        harness.last_said().contains("one.json: has 1 camera (front); the take has 2 cameras (front, above)")
    );
    assert_eq!(*harness.document(), before);
}

#[test]
fn silhouettes_replace_those_of_the_frame_and_are_undone() {
    let folder = folder();
    let mut harness = open(folder.path());
    let before = subject_pixels(&harness, 0);
    let path = folder.path().join("masks/front.png");
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    GrayImage::from_fn(64, 48, |x, _| Luma([if x < 32 { 255 } else { 0 }])).save(&path).unwrap();
    drop_on(&mut harness, &[folder.path().join("masks")]);
    assert_eq!(harness.last_said(), "Replaced the silhouettes of frame 0 in camera 1.");
    assert_eq!(subject_pixels(&harness, 0), 32 * 48);
    let project = folder.path().join("a.backlit");
    save(&mut harness, &project);
    assert_eq!(subject_pixels(&open(&project), 0), 32 * 48, "a project brings its silhouettes");
    undo(&mut harness);
    assert_eq!(subject_pixels(&harness, 0), before);

    let stranger = folder.path().join("somebody.png");
    GrayImage::new(64, 48).save(&stranger).unwrap();
    drop_on(&mut harness, &[stranger]);
    assert!(
        harness.last_said().contains("somebody.png: no camera is called that"),
        "{}",
        harness.last_said()
    );
}

#[test]
fn poses_bodies_projects_and_takes_are_taken_in() {
    let (folder, other) = (folder(), folder());
    let mut harness = open(folder.path());
    let model = harness.document().model.clone();
    let pose = take::truth(&model, 2);
    let path = folder.path().join("truth.json");
    pose_file::write(&path, &model, &pose).unwrap();
    drop_on(&mut harness, &[path]);
    assert_eq!(harness.last_said(), "Frame 0 now has the pose of truth.json.");
    assert!(harness.document().pose_at(0).root.distance(pose.root) < 1e-12);
    undo(&mut harness);
    assert!(harness.document().keys.is_empty());

    let body = folder.path().join("long.toml");
    let text = std::fs::read_to_string(folder.path().join("arm.toml")).unwrap();
    std::fs::write(&body, text.replace("length = 0.3\n", "length = 0.4\n")).unwrap();
    drop_on(&mut harness, std::slice::from_ref(&body));
    assert_eq!(harness.document().model.limbs()[0].length, 0.4);
    std::fs::write(&body, text.replace("right forearm", "tail")).unwrap();
    drop_on(&mut harness, &[body]);
    assert!(harness.last_said().contains("other limbs"), "{}", harness.last_said());

    drop_on(&mut harness, &[other.path().to_owned()]);
    assert_eq!(harness.document().model.limbs()[0].length, 0.3, "another take is open");
    let strange = folder.path().join("notes.txt");
    std::fs::write(&strange, "hello").unwrap();
    drop_on(&mut harness, &[strange]);
    assert!(harness.last_said().contains("notes.txt: expected a take"), "{}", harness.last_said());
}

#[test]
fn what_will_happen_is_said_before_the_file_is_let_go() {
    let folder = folder();
    let mut harness = open(folder.path());
    hover(&mut harness, &folder.path().join("cameras.json"));
    harness.get_by_label("Drop: Replace the take’s cameras with these");
    harness.input_mut().hovered_files.clear();
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Drop:").is_none());
    let mut empty = empty().sized(1100.0, 700.0).open();
    hover(&mut empty, &folder.path().join("cameras.json"));
    empty.get_by_label("Drop: Open a take first");
    hover(&mut empty, folder.path());
    empty.get_by_label("Drop: Open this take");
}

#[test]
fn recent_takes_that_are_gone_say_so_and_can_be_removed() {
    let (here, gone) = (folder(), PathBuf::from("/no/such/take"));
    let recent = vec![here.path().to_owned(), gone.clone()];
    let look = Settings { recent, ..Settings::default() };
    let mut harness = empty().settings(look).sized(1100.0, 700.0).open();
    harness.get_by_label("missing");
    click(&mut harness, "Remove take from the recent takes");
    assert!(harness.query_by_label("missing").is_none());
    let name = here.path().file_name().unwrap().to_string_lossy().into_owned();
    choose(&mut harness, Role::Link, &name);
    assert!(harness.session().take.is_some());
}

#[test]
fn the_palette_offers_first_what_was_used_last() {
    let folder = folder();
    let mut harness = open(folder.path());
    command(&mut harness, "mirr");
    press(&mut harness, Modifiers::COMMAND, Key::K);
    let top = |harness: &Window, text: &str| harness.get_by_label_contains(text).rect().top();
    assert!(top(&harness, "Edit: Mirror X") < top(&harness, "File: Open take…"));
    // Why something cannot be done stands beside it.
    harness.get_by_role(Role::TextInput).type_text("redo");
    harness.run_steps(2);
    let redo = harness.get_by_label("Edit: Redo There is nothing to redo");
    assert!(redo.rect().width() > 300.0);
}

#[test]
fn the_palette_takes_what_is_typed_before_it_is_drawn() {
    let mut harness = empty().sized(1300.0, 860.0).open();
    settle(&mut harness);
    // A slow frame has the keys that open it, the text and Enter almost at once.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    harness.step();
    for letter in "about".chars() {
        harness.event(egui::Event::Text(letter.to_string()));
    }
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    harness.get_by_label_contains("Markerless Motion Capture");
}

#[test]
fn about_copies_the_citation() {
    let mut harness = arm().sized(1300.0, 860.0).open();
    for (button, what) in
        [("Copy BibTeX", "Copied the BibTeX entry."), ("Copy citation", "Copied the citation.")]
    {
        command(&mut harness, "about");
        harness.get_by_label_contains("Markerless Motion Capture");
        click(&mut harness, button);
        assert_eq!(harness.last_said(), what);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn the_cards_look_as_they_should() {
    let mut snapshots = Snapshots::default();
    let folder = folder();
    for theme in Theme::ALL {
        let mut harness = at(folder.path()).theme(theme).sized(1300.0, 860.0).open();
        harness.set_render_cursor(false);
        hover(&mut harness, &folder.path().join("cameras.json"));
        harness.state_mut().inspector.freeze_times();
        harness.step();
        let card = around(&harness, "Drop: Replace the take’s cameras with these", Vec2::splat(16.0));
        snapshots.part(&mut harness, card, &format!("panel_drop_{}", theme_name(theme)));
        harness.input_mut().hovered_files.clear();
        command(&mut harness, "about");
        let card = Rect::from_min_size(pos2(390.0, 230.0), vec2(520.0, 400.0));
        snapshots.part(&mut harness, card, &format!("panel_about_{}", theme_name(theme)));
    }
}
