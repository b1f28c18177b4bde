//! Work that an earlier start left unsaved: what is offered, and what becomes of each decision.

use std::fs::File;
use std::path::Path;
use std::time::{Duration, SystemTime};

use backlit::context::clock::Clock;
use backlit_document::Document;
use backlit_take::demonstration::Demonstration;
use backlit_ui::style::theme::{Theme, size};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::take;
use crate::support::window::{
    Setup, Window, WindowState, at, click, command, demonstration, drag, empty, press, save, settle,
};

/// 21 November 2026, 14:44 two hours east of Greenwich.
const NOW: u64 = 1_795_265_040;
const TWO_HOURS: i32 = 7200;

fn now() -> SystemTime {
    SystemTime::UNIX_EPOCH + Duration::from_secs(NOW)
}

/// A window whose unsaved work is kept in the folder.
fn in_folder(setup: Setup, folder: &Path) -> Setup {
    let clock = Clock::fixed(now(), TWO_HOURS).unwrap();
    setup.data_in(&folder.join("data")).with(|options| options.clock = clock)
}

/// A window without a take, which offers what was left.
fn offering(folder: &Path) -> Setup {
    in_folder(empty(), folder).sized(1100.0, 700.0)
}

/// A window on the take in the folder.
fn on_take(folder: &Path) -> Setup {
    in_folder(at(&folder.join("arm")), folder)
}

/// A window is closed with unsaved work, some seconds ago.
fn leave(folder: &Path, seconds_ago: u64, work: impl Fn(&mut Window)) -> Document {
    let mut harness = on_take(folder).data_in(&folder.join("new")).open();
    work(&mut harness);
    eframe::App::on_exit(harness.state_mut(), None);
    let document = harness.document().clone();
    drop(harness);
    let copy = folder.join("new/unsaved.backlit");
    File::options()
        .write(true)
        .open(&copy)
        .unwrap()
        .set_modified(now() - Duration::from_secs(seconds_ago))
        .unwrap();
    // Among the others, as another window would have written it.
    let data = folder.join("data");
    std::fs::create_dir_all(&data).unwrap();
    let number = 1 + std::fs::read_dir(&data)
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().path().extension().is_some_and(|ending| ending == "backlit"))
        .count();
    for ending in ["backlit", "about.json", "png"] {
        let from = folder.join("new/unsaved").with_extension(ending);
        std::fs::rename(from, data.join(format!("unsaved-{number}.{ending}"))).unwrap();
    }
    document
}

fn leave_two(folder: &Path) -> [Document; 2] {
    take::write_to(&folder.join("arm"));
    let older = leave(folder, 86_400 + 5 * 3600, |harness| {
        press(harness, Modifiers::NONE, Key::ArrowRight);
        press(harness, Modifiers::COMMAND, Key::Enter);
        save(harness, &folder.join("wave.backlit"));
        drag(harness, "right wrist, Camera 1", vec2(0.0, -30.0));
    });
    let newer = leave(folder, 720, |harness| drag(harness, "right wrist, Camera 1", vec2(0.0, 30.0)));
    [older, newer]
}

fn titles(harness: &Window) -> Vec<String> {
    let labels = harness.get_all_by_role(Role::Label).filter_map(|node| node.accesskit_node().value());
    labels.filter(|text| text.starts_with("Today") || text.starts_with("Yesterday")).collect()
}

#[test]
fn copies_are_offered_with_time_picture_and_work_the_newest_first() {
    let mut snapshots = Snapshots::default();
    let folder = tempfile::tempdir().unwrap();
    leave_two(folder.path());
    for theme in Theme::ALL {
        let mut harness = offering(folder.path()).theme(theme).open();
        assert_eq!(titles(&harness), ["Today 14:32, 12 minutes ago", "Yesterday 09:44, 29 hours ago"]);
        harness.get_by_label("At frame 0 of 3: 1 pose set by hand");
        harness.get_by_label("At frame 2 of 3: 1 pose set by hand, 1 tracked");
        harness.get_by_label("Never saved to a file");
        harness.get_by_label("Unsaved changes of wave.backlit");
        harness.get_by_role_and_label(Role::Button, "Restore arm, today 14:32, 12 minutes ago");
        assert_eq!(harness.get_all_by_label("Silhouette and body, arm").count(), 2);
        harness.set_render_cursor(false);
        let cards = Rect::from_min_size(pos2(250.0, size::TOOLBAR), vec2(600.0, 430.0));
        snapshots.part(&mut harness, cards, &format!("recovery_{}", theme_name(theme)));
    }
}

#[test]
fn each_copy_is_restored_discarded_or_left_for_later() {
    let folder = tempfile::tempdir().unwrap();
    let [older, newer] = leave_two(folder.path());
    let open = || offering(folder.path()).open();
    let mut harness = open();
    click(&mut harness, "Decide later");
    assert!(titles(&harness).is_empty());
    harness.get_by_label("Open a take, or look around in the built-in one");
    drop(harness);

    let mut harness = open();
    click(&mut harness, "Discard arm, today 14:32, 12 minutes ago");
    assert_eq!(titles(&harness), ["Yesterday 09:44, 29 hours ago"]);
    harness.get_by_label_contains("can still be opened as a project");
    click(&mut harness, "Undo discard");
    assert_eq!(titles(&harness).len(), 2);
    click(&mut harness, "Discard arm, today 14:32, 12 minutes ago");
    // Of one copy alone the buttons need not say which.
    click(&mut harness, "Restore");
    assert_eq!(*harness.document(), older);
    assert_eq!(harness.selection().frame, 2);
    drop(harness);
    let aside = folder.path().join("data/left-1.backlit");
    let harness = at(&aside).open();
    assert_eq!(*harness.document(), newer, "what was discarded is a project");
}

#[test]
fn a_named_take_is_opened_at_once_and_a_notice_tells_of_what_was_left() {
    let folder = tempfile::tempdir().unwrap();
    let [_, newer] = leave_two(folder.path());
    let open = || on_take(folder.path()).sized(1100.0, 700.0).open();
    let mut harness = open();
    assert!(harness.session().take.is_some(), "nothing stands before the take");
    harness.get_by_label("Unsaved work of 2 windows is kept, the last arm, today 14:32, 12 minutes ago.");
    click(&mut harness, "Unsaved work…");
    assert_eq!(titles(&harness), ["Today 14:32, 12 minutes ago", "Yesterday 09:44, 29 hours ago"]);
    click(&mut harness, "Restore arm, today 14:32, 12 minutes ago");
    assert_eq!(*harness.document(), newer);
    assert!(titles(&harness).is_empty(), "the card has closed");
    drop(harness);

    let mut harness = open();
    click(&mut harness, "Unsaved work…");
    click(&mut harness, "Discard all");
    assert!(harness.session().take.is_some() && !harness.state().inspector.state.history.is_dirty());
    drop(harness);
    let harness = open();
    assert!(harness.query_by_label_contains("is kept").is_none(), "nothing is offered any more");
}

#[test]
fn opening_another_take_says_that_the_work_is_kept_and_offers_the_way_back() {
    let folder = tempfile::tempdir().unwrap();
    take::write_to(&folder.path().join("arm"));
    let mut harness = on_take(folder.path()).open();
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 30.0));
    let work = harness.document().clone();
    harness.get_by_role_and_label(Role::Button, "File").click();
    harness.run_steps(2);
    harness.get_all_by_label_contains("Open built-in take").next().unwrap().click();
    settle(&mut harness);
    assert_ne!(harness.document().take, work.take);
    harness.get_by_label_contains("Unsaved work is kept: arm, ");
    // A demonstration closes what was said in passing, and leaves what waits for a decision.
    command(&mut harness, "One limb");
    settle(&mut harness);
    harness.get_by_label_contains("Unsaved work is kept: arm, ");
    click(&mut harness, "Unsaved work…");
    click(&mut harness, "Restore");
    assert_eq!(*harness.document(), work);
}

#[test]
fn of_a_demonstration_nothing_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = in_folder(demonstration(Demonstration::OneCamera), folder.path()).open();
    press(&mut harness, Modifiers::NONE, Key::F1);
    drag(&mut harness, "head, Camera 1", vec2(0.0, 30.0));
    assert!(harness.state().inspector.state.history.is_dirty());
    eframe::App::on_exit(harness.state_mut(), None);
    drop(harness);
    let harness = offering(folder.path()).open();
    assert!(titles(&harness).is_empty());
    assert!(!folder.path().join("data/unsaved.backlit").exists());
}

#[test]
fn work_whose_take_is_gone_stays_on_offer() {
    let folder = tempfile::tempdir().unwrap();
    leave_two(folder.path());
    std::fs::rename(folder.path().join("arm"), folder.path().join("moved")).unwrap();
    let mut harness = offering(folder.path()).open();
    click(&mut harness, "Restore arm, today 14:32, 12 minutes ago");
    harness.get_by_label_contains("there is no such file");
    assert_eq!(titles(&harness).len(), 2);
}

/// Over a take, too, what nine windows have left is seen by more than one at a time.
#[test]
fn of_nine_copies_as_many_are_seen_as_have_room() {
    let folder = tempfile::tempdir().unwrap();
    leave_two(folder.path());
    let data = folder.path().join("data");
    for number in 3..10 {
        for ending in ["backlit", "about.json", "png"] {
            let to = data.join(format!("unsaved-{number}.{ending}"));
            std::fs::copy(data.join(format!("unsaved-1.{ending}")), to).unwrap();
        }
    }
    let mut window = on_take(folder.path()).sized(1366.0, 1000.0).open();
    click(&mut window, "Unsaved work…");
    let below = window.get_by_label("Discard all").rect().top();
    let rows = window.get_all_by_label_contains("Restore arm");
    let seen = rows.filter(|row| row.rect().is_positive() && row.rect().bottom() < below).count();
    let rows: Vec<_> = window.get_all_by_label_contains("Restore arm").map(|row| row.rect()).collect();
    assert!(seen >= 5, "{seen} of nine copies are seen above {below}: {rows:?}");
}

#[test]
fn without_a_picture_or_anything_beside_it_a_copy_is_still_offered() {
    let folder = tempfile::tempdir().unwrap();
    leave_two(folder.path());
    let data = folder.path().join("data");
    std::fs::write(data.join("unsaved-1.png"), b"not a picture").unwrap();
    std::fs::remove_file(data.join("unsaved-2.png")).unwrap();
    std::fs::write(data.join("unsaved-2.about.json"), "{").unwrap();
    let harness = offering(folder.path()).open();
    assert_eq!(titles(&harness).len(), 2);
    assert_eq!(harness.get_all_by_label("No picture, arm").count(), 2);
}
