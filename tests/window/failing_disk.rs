//! Disks that refuse: it is said which file, why and what can be done; old files are untouched, and the window goes on.

use std::ffi::OsStr;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use backlit::app::Opening;
use backlit::features::convergence::CurvesFile;
use backlit_document::Document;
use backlit_document::project::{read_project, write_project};
use backlit_take::source::TakeSource;
use backlit_tracking::body::builtin;
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;

use crate::export::export_to;
use crate::support::storage::NoStorage;
use crate::support::take;
use crate::support::window::{
    PATIENCE, Window, WindowState, at, click, command, drag, press, save, settle, wait_until, write_curves,
};

/// Names the folder in which the process on a bad disk works.
const FOLDER: &str = "BACKLIT_TEST_BAD_DISK";
/// Why that disk refuses.
const REASON: &str = "BACKLIT_TEST_BAD_DISK_REASON";
/// The reason of a disk that is full, and can be emptied.
const FULL: &str = "the disk is full";

const FAILED: &str = "The copy of unsaved work was not written";
const WORKS: &str = "The copy of unsaved work is written again";

fn open(folder: &Path) -> Window {
    take::write_to(&folder.join("arm"));
    at(&folder.join("arm")).sized(1200.0, 800.0).data_in(&folder.join("data")).open()
}

/// Frames until something is said that begins so.
fn wait_for(harness: &mut Window, beginning: &str) {
    let start = Instant::now();
    while !harness.said().iter().any(|text| text.starts_with(beginning)) {
        assert!(start.elapsed() < PATIENCE, "never said: {beginning}");
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
}

/// Whether a path is named once; of a long one its beginning and its end are shown.
fn names(said: &str, path: &Path) -> bool {
    let path = path.display().to_string();
    let count = path.chars().count();
    let beginning: String = path.chars().take(50).collect();
    let end: String = path.chars().skip(count.saturating_sub(50)).collect();
    said.matches(&beginning).count() == 1 && said.contains(&end)
}

/// Places where nothing can be written, with what the reason is to say. Those that this system or user can write after
/// all are left out, and that is said.
fn bad_places(folder: &Path) -> Vec<(PathBuf, &'static str)> {
    let file = folder.join("file");
    std::fs::write(&file, "a file").unwrap();
    let named = folder.join("named");
    std::fs::create_dir_all(&named).unwrap();
    let mut places = vec![
        (file.join("x"), "what should be its folder is a file"),
        (folder.join("missing/x"), "its folder is not there"),
        (named, "folder of that name"),
        (folder.join("x".repeat(300)), "the name is too long"),
    ];
    let closed = folder.join("closed");
    std::fs::create_dir_all(&closed).unwrap();
    let mut permissions = std::fs::metadata(&closed).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&closed, permissions).unwrap();
    for (place, reason) in [(closed, "there is no permission"), ("/proc".into(), "")] {
        let probe = place.join("probe");
        if place.is_dir() && std::fs::write(&probe, "").is_err() {
            places.push((place.join("x"), reason));
        } else {
            let _ = std::fs::remove_file(probe);
            println!("skipped: {} can be written here", place.display());
        }
    }
    places
}

#[test]
fn a_project_that_cannot_be_written_is_said_and_the_work_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = open(folder.path());
    let good = folder.path().join("good.backlit");
    save(&mut harness, &good);
    let saved = read_project(&good).unwrap().document;
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 30.0));
    for (place, reason) in bad_places(folder.path()) {
        save(&mut harness, &place);
        let said = harness.last_said();
        assert!(said.starts_with("Not saved: ") && names(&said, &place), "{said}");
        assert!(said.contains(reason) && said.contains("Choose a"), "{said}");
        assert!(harness.state().inspector.state.history.is_dirty(), "{said}");
        harness.get_by_role_and_label(Role::Button, "Save as…");
        harness.state_mut().inspector.state.notices.close_all();
        harness.step();
    }
    assert_eq!(read_project(&good).unwrap().document, saved);
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 10.0));
    save(&mut harness, &good);
    assert_eq!(read_project(&good).unwrap().document, *harness.document());
}

#[test]
fn tables_and_plots_that_cannot_be_written_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = open(folder.path());
    click(&mut harness, "Step");
    for (place, reason) in bad_places(folder.path()) {
        for file in [CurvesFile::Table, CurvesFile::Plot] {
            write_curves(harness.state_mut(), file, &place);
            settle(&mut harness);
            let said = harness.last_said();
            assert!(said.starts_with("Not written: ") && names(&said, &place), "{said}");
            assert!(said.contains(reason) && said.contains("Choose a"), "{said}");
        }
    }
    let good = folder.path().join("curves.csv");
    write_curves(harness.state_mut(), CurvesFile::Table, &good);
    settle(&mut harness);
    assert!(good.exists());
}

#[test]
fn pictures_that_cannot_be_written_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = open(folder.path());
    // The dialog itself refuses a folder that is not there, and the name of a folder.
    let let_through = |place: &Path| place.parent().is_some_and(Path::is_dir) && !place.is_dir();
    for (place, reason) in bad_places(folder.path()).into_iter().filter(|(place, _)| let_through(place)) {
        command(&mut harness, "export view");
        export_to(&mut harness, "File", &place);
        let said = harness.last_said();
        assert!(said.starts_with("Not exported: ") && names(&said, &place), "{said}");
        assert!(said.contains(reason) && said.contains("Choose a"), "{said}");
        harness.state_mut().inspector.state.notices.close_all();
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn a_copy_that_cannot_be_written_is_said_once_and_again_when_it_works() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    let mut harness = open(folder.path());
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 30.0));
    let copy = data.join("unsaved.backlit");
    wait_until(&mut harness, "a copy is written", |_| copy.exists());
    settle(&mut harness);
    // The folder goes, and a file takes its place.
    std::fs::remove_dir_all(&data).unwrap();
    std::fs::write(&data, "a file").unwrap();
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, -20.0));
    wait_for(&mut harness, FAILED);
    // Two more tries at least.
    let again = Instant::now();
    while again.elapsed() < Duration::from_secs(5) {
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
    let failures: Vec<String> = harness.said().into_iter().filter(|text| text.starts_with(FAILED)).collect();
    assert_eq!(failures.len(), 1, "{failures:#?}");
    assert!(failures[0].contains(&data.display().to_string()), "{}", failures[0]);
    harness.get_by_role_and_label(Role::Button, "Save as…");
    std::fs::remove_file(&data).unwrap();
    wait_for(&mut harness, WORKS);
    assert_eq!(read_project(&copy).unwrap().document, *harness.document());
    harness.step();
    assert!(harness.query_by_label_contains(FAILED).is_none(), "the card has gone");
    assert!(harness.document().has_pose(0));
}

#[test]
fn work_that_can_be_kept_nowhere_is_not_left_at_the_first_try() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("data"), "a file").unwrap();
    let mut harness = open(folder.path());
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 30.0));
    let work = harness.document().clone();
    let other = folder.path().join("arm");
    harness.state_mut().open(Opening::of(&other));
    settle(&mut harness);
    assert_eq!(*harness.document(), work);
    wait_for(&mut harness, "Not opened: your work is not saved");
    harness.state_mut().open(Opening::of(&other));
    settle(&mut harness);
    assert_ne!(*harness.document(), work);

    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 30.0));
    let close = |harness: &mut Window| {
        let viewport = harness.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.events.push(egui::ViewportEvent::Close);
        harness.step();
        let output = harness.output().viewport_output.values();
        output.flat_map(|viewport| viewport.commands.clone()).any(|c| c == egui::ViewportCommand::CancelClose)
    };
    assert!(close(&mut harness), "it stays open");
    wait_for(&mut harness, "Not closed: your work is not saved");
    assert!(!close(&mut harness), "the user knows");
}

/// What a person does on a disk that takes nothing. Runs in a process of its own, to which this happens.
#[test]
fn work_on_a_bad_disk() {
    let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else { return };
    let reason = std::env::var(REASON).unwrap();
    let good = folder.join("good.backlit");
    let saved = std::fs::read(&good).unwrap();
    let mut harness = at(&folder.join("arm")).sized(1200.0, 800.0).data_in(&folder.join("data")).open();
    let filler = folder.join("filler");
    if reason == FULL {
        let mut file = File::create(&filler).unwrap();
        while file.write_all(&[1; 512]).is_ok() {}
    }
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 30.0));
    wait_for(&mut harness, FAILED);
    let failure = harness.said().into_iter().find(|text| text.starts_with(FAILED)).unwrap();
    assert!(failure.contains(&reason) && failure.contains("unsaved.backlit"), "{failure}");
    click(&mut harness, "Step");
    harness.state_mut().save_to(&good);
    write_curves(harness.state_mut(), CurvesFile::Plot, &folder.join("curves.png"));
    press(&mut harness, Modifiers::NONE, Key::F2);
    eframe::App::save(harness.state_mut(), &mut NoStorage);
    // The settings are few bytes: too many only for a disk that is full.
    let settings = (reason == FULL).then_some("The window’s settings were not saved");
    for beginning in ["Not saved: ", "Not written: "].into_iter().chain(settings) {
        wait_for(&mut harness, beginning);
        let text = harness.said().into_iter().find(|text| text.starts_with(beginning)).unwrap();
        assert!(text.contains(&reason), "{text}");
    }
    assert_eq!(std::fs::read(&good).unwrap(), saved, "the old file is whole");
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, -10.0));
    if reason == FULL {
        std::fs::remove_file(&filler).unwrap();
        wait_for(&mut harness, WORKS);
        save(&mut harness, &good);
        assert_eq!(read_project(&good).unwrap().document, *harness.document());
    }
    let parts = |folder: &Path| {
        let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        names.filter(|name| name.to_string_lossy().ends_with(".part")).count()
    };
    assert_eq!(parts(&folder) + parts(&folder.join("data")), 0, "nothing half is left");
}

/// Starts this program again for [`work_on_a_bad_disk`], by a command that makes the disk bad. That is given the folder
/// of the disk, one with what is to be on it, and what to run then. Where that is impossible, it is said.
#[cfg(unix)]
fn on_a_bad_disk(command: &[&str], reason: &str) {
    let folder = tempfile::tempdir().unwrap();
    let (disk, kept) = (folder.path().join("disk"), folder.path().join("kept"));
    std::fs::create_dir_all(&disk).unwrap();
    take::write_to(&kept.join("arm"));
    let mut document = Document::new(builtin::single_limb());
    document.take = Some(TakeSource::BuiltIn);
    write_project(&kept.join("good.backlit"), &document, &[]).unwrap();
    let run = |what: &[&OsStr]| {
        let mut process = Command::new(command[0]);
        process.args(&command[1..]).args([&disk, &kept]).args(what);
        process.env(FOLDER, &disk).env(REASON, reason).output()
    };
    if !run(&["true".as_ref()]).is_ok_and(|output| output.status.success()) {
        println!("skipped: this cannot be done here: {}", command.join(" "));
        return;
    }
    let program = std::env::current_exe().unwrap();
    let test = ["--exact".as_ref(), "failing_disk::work_on_a_bad_disk".as_ref()];
    let output = run(&[program.as_os_str(), test[0], test[1]]).unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("1 passed"), "{text}");
}

#[cfg(unix)]
#[test]
fn a_disk_that_is_full_harms_nothing_and_all_is_well_when_there_is_space_again() {
    let script = r#"mount -t tmpfs -o size=400k tmpfs "$0" && cp -r "$1/." "$0" && shift && exec "$@""#;
    on_a_bad_disk(&["unshare", "--map-root-user", "--mount", "sh", "-c", script], FULL);
}

#[cfg(unix)]
#[test]
fn a_file_that_may_not_become_that_large_leaves_the_old_one() {
    // The limit is an error only where the signal is ignored.
    let script = r#"cp -r "$1/." "$0" && shift && trap '' XFSZ && ulimit -f 2 && exec "$@""#;
    on_a_bad_disk(&["sh", "-c", script], "a file may not become that large there");
}
