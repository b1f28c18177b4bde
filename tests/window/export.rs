//! Exports through the real window: the dialog, the files, progress and stopping.

use std::path::Path;

use backlit::app::settings::Settings;
use backlit::features::export::{ExportChoices, SeriesFormat};
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{Window, WindowState, arm, choose, click, command, point, press, type_over};

fn open(settings: Settings) -> Window {
    arm().settings(settings).sized(1200.0, 800.0).open()
}

/// Gives the dialog a path and presses Export.
pub(crate) fn export_to(harness: &mut Window, field: &str, path: &Path) {
    let at = harness.get_by_role_and_label(Role::TextInput, field).rect().center();
    point(harness, at);
    type_over(harness, field, &path.display().to_string());
    click(harness, "Export");
}

#[test]
fn a_view_is_exported_at_the_size_that_was_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = open(Settings::default());
    command(&mut harness, "export view");
    let path = folder.path().join("front.png");
    harness.get_by_role_and_label(Role::RadioButton, "3×").click();
    harness.run_steps(2);
    export_to(&mut harness, "File", &path);
    harness.get_by_label_contains("Exported front.png");
    let picture = image::open(&path).unwrap().to_rgb8();
    // 64 × 48 pixels of footage, and a legend of one row or more below.
    assert_eq!(picture.width(), 192);
    assert!((144..=300).contains(&picture.height()), "{}", picture.height());
    // Missing is orange, and there is some.
    let is_orange = |p: &&image::Rgb<u8>| p[0] > 150 && p[1] > 60 && p[1] < 140 && p[2] < 60;
    assert!(picture.pixels().filter(is_orange).count() > 50);
}

#[test]
fn the_window_is_exported_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = open(Settings { theme: Theme::Light, ..Settings::default() });
    click(&mut harness, "Solver");
    let path = folder.path().join("window.png");
    command(&mut harness, "export window");
    export_to(&mut harness, "File", &path);
    let exported = image::open(&path).unwrap().to_rgb8();
    assert_eq!(exported.dimensions(), (1200, 800));
    // The notice that says so is not in it, nor the margin that a harness leaves around the window.
    choose(&mut harness, Role::Button, "Close notice");
    harness.state_mut().inspector.freeze_times();
    harness.step();
    let shown = image::DynamicImage::ImageRgba8(harness.render().unwrap()).to_rgb8();
    let section = harness.get_by_role_and_label(Role::Button, "Solver").rect();
    let of = |picture: &image::RgbImage, offset: i64| {
        let (x, y) = (section.left() as i64 + 10, section.top() as i64 + 4);
        let mut sum = 0_i64;
        for dy in 0..20 {
            for dx in 0..60 {
                sum += i64::from(picture.get_pixel((x + dx + offset) as u32, (y + dy) as u32)[0]);
            }
        }
        sum
    };
    // About the same ink where the section's title is: open sections are open in the export too.
    let (a, b) = (of(&shown, 0), of(&exported, 8));
    assert!((a - b).abs() < a / 10, "{a} {b}");
}

#[test]
fn iterations_become_numbered_pictures_or_a_gif() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = open(Settings::default());
    click(&mut harness, "Step");
    click(&mut harness, "Step");
    let steps = folder.path().join("steps");
    command(&mut harness, "export steps");
    harness.get_by_label_contains("3 pictures");
    export_to(&mut harness, "Folder", &steps);
    harness.get_by_label_contains("Exported 3 pictures to steps");
    let mut names: Vec<_> = std::fs::read_dir(&steps).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["step_0000.png", "step_0001.png", "step_0002.png"]);
    let pictures: Vec<_> = names.iter().map(|name| image::open(steps.join(name)).unwrap()).collect();
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2], "every step looks different");

    let gif = folder.path().join("steps.gif");
    command(&mut harness, "export steps");
    harness.get_by_role_and_label(Role::RadioButton, "GIF").click();
    harness.run_steps(2);
    export_to(&mut harness, "File", &gif);
    harness.get_by_label_contains("Exported 3 pictures to steps.gif");
    assert_eq!(&std::fs::read(&gif).unwrap()[..6], b"GIF89a");
    // What was chosen is kept.
    command(&mut harness, "export steps");
    let path = harness.get_by_role_and_label(Role::TextInput, "File").value().unwrap();
    assert!(path.ends_with(".gif") && Path::new(&path).starts_with(folder.path()), "{path}");
}

#[test]
fn frames_are_exported_and_an_export_can_be_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let export = ExportChoices { format: SeriesFormat::AnimatedPng, ..ExportChoices::default() };
    let mut harness = open(Settings { export, ..Settings::default() });
    click(&mut harness, "Track forward");
    let path = folder.path().join("frames.png");
    command(&mut harness, "export frames");
    harness.get_by_label_contains("3 pictures");
    export_to(&mut harness, "File", &path);
    harness.get_by_label_contains("Exported 3 pictures to frames.png");
    assert!(std::fs::read(&path).unwrap().windows(4).any(|chunk| chunk == b"acTL"));

    command(&mut harness, "export frames");
    let other = folder.path().join("other.png");
    type_over(&mut harness, "File", &other.display().to_string());
    harness.get_by_role_and_label(Role::Button, "Export").click();
    harness.run_steps(2);
    choose(&mut harness, Role::Button, "Stop export");
    let said = harness.last_said();
    assert!(said.starts_with("Stopped the export") || said.starts_with("Exported 3"), "{said}");
    assert_eq!(other.exists(), said.starts_with("Exported"), "{said}");
}

#[test]
fn a_folder_that_is_not_there_is_said_before_anything_is_done() {
    let mut harness = open(Settings::default());
    command(&mut harness, "export view");
    type_over(&mut harness, "File", "/no/such/folder/a.png");
    harness.get_by_label_contains("There is no folder /no/such/folder");
    choose(&mut harness, Role::Button, "Cancel");
    assert!(harness.query_by_role(Role::TextInput).is_none());
}

#[test]
fn the_dialog_looks_as_it_should() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let folder = std::path::PathBuf::from("/pictures");
        let export = ExportChoices { folder: Some(folder), ..ExportChoices::default() };
        let mut harness = open(Settings { theme, export, ..Settings::default() });
        harness.set_render_cursor(false);
        click(&mut harness, "Step");
        for (what, name) in [("export view", "view"), ("export steps", "iterations")] {
            command(&mut harness, what);
            harness.state_mut().inspector.freeze_times();
            harness.step();
            let card = Rect::from_min_size(pos2(350.0, 220.0), vec2(500.0, 360.0));
            snapshots.part(&mut harness, card, &format!("panel_export_{name}_{}", theme_name(theme)));
            press(&mut harness, Modifiers::NONE, Key::Escape);
        }
    }
}

#[test]
fn a_motion_is_written_in_several_formats_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = open(Settings::default());
    press(&mut window, Modifiers::NONE, Key::Enter);
    command(&mut window, "export motion");
    for format in ["CSV", "C3D"] {
        window.get_by_role_and_label(Role::CheckBox, format).click();
        window.run_steps(2);
    }
    export_to(&mut window, "Motion file", &folder.path().join("arm.bvh"));
    let mut written: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    written.sort();
    assert_eq!(written, ["arm.bvh", "arm.c3d", "arm.csv"]);
    window.get_by_label("Wrote arm.bvh, arm.c3d, arm.csv.");
    let table = std::fs::read_to_string(folder.path().join("arm.csv")).unwrap();
    assert!(table.contains(",right wrist,") && !table.contains("forearm"), "{}", &table[..200]);
}
