//! Whole workflows through the real window, by label and role, on a tiny take.

use backlit::app::settings::Settings;
use backlit::app::settings_file as settings;
use backlit::context::preferences::Layout;
use backlit_document::project::read_project;
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::storage::NoStorage;
use crate::support::take;
use crate::support::window::{
    Window, WindowState, arm, at, centre, choose, click, command, drag, empty, grab, press, release, save,
    settle, undo, wait_until,
};

fn iou(harness: &Window) -> f64 {
    harness.session().iou().unwrap()
}

#[test]
fn from_a_take_to_a_track_and_back_to_the_saved_file() {
    let mut harness = arm().open();
    let rough = iou(&harness);
    assert!(rough > 0.2 && rough < 0.9, "the start is near, not there: {rough}");

    drag(&mut harness, "right wrist, Camera 1", vec2(6.0, -60.0));
    let dragged = harness.document().pose_at(0).clone();
    assert_ne!(dragged, *harness.document().start);
    assert_eq!(harness.document().keys.len(), 1, "a drag sets a key pose, once");

    click(&mut harness, "Step");
    click(&mut harness, "Step");
    let runs = harness.runs();
    assert_eq!((runs.len(), runs[0].steps.len()), (1, 3), "the second step goes on");
    let stepped = harness.document().pose_at(0).clone();

    click(&mut harness, "Step back");
    assert_eq!(harness.selection().step.map(|step| step.step), Some(1));
    assert_eq!(*harness.document().pose_at(0), stepped, "looking back changes nothing");

    click(&mut harness, "Run");
    let runs = harness.runs();
    assert_eq!(runs.len(), 2, "from an earlier step a new run begins");
    assert!(runs[1].ending.is_some() && runs[1].steps.len() > 3);
    assert!(iou(&harness) > 0.8, "fitted: {}", iou(&harness));

    press(&mut harness, Modifiers::NONE, Key::Y);
    assert_eq!(harness.document().fit.renderer.name(), "cylinder");
    undo(&mut harness);
    assert_eq!(harness.document().fit.renderer.name(), "capsule");
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(harness.document().fit.renderer.name(), "cylinder");
    press(&mut harness, Modifiers::NONE, Key::C);

    click(&mut harness, "Track forward");
    let document = harness.document();
    assert_eq!(document.estimates.len(), take::FRAMES);
    assert!(document.estimates.values().all(|found| !found.lost && found.iou.unwrap() > 0.75));
    assert_eq!(harness.selection().frame, take::FRAMES - 1, "the screen follows");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm.backlit");
    save(&mut harness, &path);
    assert_eq!(read_project(&path).unwrap().document, *harness.document());
    harness.get_by_label_contains("Saved to arm.backlit");

    undo(&mut harness);
    assert_eq!(harness.document().fit.renderer.name(), "capsule");
    assert_eq!(harness.document().estimates.len(), 1, "a track is undone as one");
}

#[test]
fn a_project_of_a_folder_is_reopened_equal() {
    let folder = tempfile::tempdir().unwrap();
    take::write_to(folder.path());
    let mut harness = at(folder.path()).open();
    drag(&mut harness, "right elbow, Camera 2", vec2(20.0, 20.0));
    press(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    let path = folder.path().join("work.backlit");
    save(&mut harness, &path);
    let (saved, runs) = (harness.document().clone(), harness.runs().to_vec());
    assert!(runs.len() == 1 && runs[0].steps.len() > 3);
    let mut again = at(&path).open();
    assert_eq!(*again.document(), saved);
    assert_eq!(again.runs(), runs, "runs are kept in the project");
    press(&mut again, Modifiers::NONE, Key::Enter);
    settle(&mut again);
    assert_eq!(again.runs()[1].number, 2, "the next run is another one");
}

#[test]
fn a_drag_is_seen_in_all_views_and_esc_puts_it_back() {
    let mut harness = arm().open();
    let before = harness.document().clone();
    let other = centre(&harness, "right wrist, Camera 2");
    let from = centre(&harness, "right wrist, Camera 1");
    grab(&mut harness, from, &[vec2(0.0, 20.0), vec2(0.0, 60.0)]);
    harness.step();
    let moved = centre(&harness, "right wrist, Camera 2");
    assert!(moved.distance(other) > 5.0, "{other} {moved}");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    release(&mut harness, from + vec2(0.0, 60.0));
    assert_eq!(*harness.document(), before);
}

#[test]
fn a_track_that_is_cancelled_keeps_what_is_done() {
    let mut harness = arm().open();
    harness.get_by_role_and_label(Role::Button, "Track forward").click();
    wait_until(&mut harness, "a frame is tracked", |window| !window.document().estimates.is_empty());
    press(&mut harness, Modifiers::NONE, Key::Escape);
    let done = harness.document().estimates.len();
    assert!((1..=take::FRAMES).contains(&done));
    harness.get_by_label_contains(if done == take::FRAMES { "Tracked 3 frames" } else { "Stopped after" });
    // The notice's own button takes it back.
    harness.get_all_by_role_and_label(Role::Button, "Undo").last().unwrap().click();
    settle(&mut harness);
    assert!(harness.document().estimates.is_empty());
}

#[test]
fn angles_are_typed_and_limbs_are_picked_in_the_tree() {
    let mut harness = arm().open();
    choose(&mut harness, Role::ListItem, "Right forearm");
    let field = harness.get_by_label("Twist value");
    field.click();
    harness.run_steps(2);
    harness.get_by_label("Twist value").type_text("31.5");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    let document = harness.document();
    let limb = &document.model.limbs()[1];
    let angles = limb.angles(document.pose_at(0).rotations[1]);
    assert!((angles.twist.to_degrees() - 31.5).abs() < 1e-6, "{}", angles.twist.to_degrees());
}

#[test]
fn the_palette_finds_and_does() {
    let mut harness = arm().open();
    command(&mut harness, "report 2004");
    let fit = &harness.document().fit;
    assert_eq!(fit.as_preset(), Some(backlit_tracking::fit::Preset::Report));
    press(&mut harness, Modifiers::COMMAND, Key::K);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_role(Role::TextInput).is_none(), "Esc closes it");
}

/// A forearm that is too thin in the take's body is found as thick as it was drawn; one undo takes it back.
#[test]
fn the_body_is_fitted_to_tracked_frames_and_undone_at_once() {
    let folder = tempfile::tempdir().unwrap();
    take::write_to(folder.path());
    let body = folder.path().join("arm.toml");
    let thin = std::fs::read_to_string(&body).unwrap().replace("radius = 0.05", "radius = 0.035");
    std::fs::write(&body, thin).unwrap();
    let mut harness = at(folder.path()).open();
    click(&mut harness, "Track forward");
    let radius = |harness: &Window| harness.document().model.limbs()[1].radius;
    assert_eq!(radius(&harness), 0.035);
    command(&mut harness, "fit body to");
    assert!((radius(&harness) - 0.05).abs() < 0.006, "{}", radius(&harness));
    harness.get_by_label_contains("Fitted the body to 3 frames: IoU");
    assert_eq!(harness.document().estimates.len(), take::FRAMES, "poses stay");
    undo(&mut harness);
    assert_eq!(radius(&harness), 0.035);
}

#[test]
fn what_cannot_be_used_says_why() {
    let mut harness = empty().open();
    harness.get_by_label_contains("Open a take, or look around");
    harness.get_by_role_and_label(Role::Button, "Step").hover();
    harness.run_steps(60);
    harness.get_by_label_contains("Open a take first");
}

#[test]
fn a_folder_without_a_take_is_an_error_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let harness = at(folder.path()).open();
    let said = &harness.said()[0];
    assert!(said.contains("take.toml") && said.contains("no such file"), "{said}");
    harness.get_by_label(said);
    assert!(harness.session().take.is_none());
}

#[test]
fn unsaved_work_is_offered_at_the_next_start() {
    let (folder, data) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    take::write_to(folder.path());
    let open = || at(folder.path()).data_in(data.path()).open();
    let mut harness = open();
    drag(&mut harness, "right wrist, Camera 1", vec2(0.0, 30.0));
    let left = harness.document().clone();
    eframe::App::on_exit(harness.state_mut(), None);
    drop(harness);
    // What is named is opened at once; a notice leads to what was left.
    let mut harness = open();
    assert!(harness.session().take.is_some());
    assert_ne!(*harness.document(), left);
    click(&mut harness, "Unsaved work…");
    click(&mut harness, "Restore");
    assert_eq!(*harness.document(), left);
    eframe::App::on_exit(harness.state_mut(), None);
    drop(harness);
    let mut harness = open();
    click(&mut harness, "Unsaved work…");
    click(&mut harness, "Discard");
    assert!(harness.session().take.is_some());
    assert_ne!(*harness.document(), left);
    let again = empty().data_in(data.path()).open();
    assert!(again.query_by_role_and_label(Role::Button, "Restore").is_none());
}

#[test]
fn the_arrangement_is_kept() {
    let data = tempfile::tempdir().unwrap();
    let mut harness = arm().data_in(&data.path().join("folder")).open();
    press(&mut harness, Modifiers::NONE, Key::F2);
    press(&mut harness, Modifiers::COMMAND, Key::B);
    press(&mut harness, Modifiers::COMMAND, Key::T);
    eframe::App::save(harness.state_mut(), &mut NoStorage);
    drop(harness);
    let (kept, unread) = settings::read(&data.path().join("folder"));
    assert_eq!(unread, None);
    assert_eq!(kept, Settings { layout: Layout::Debug, panel: false, lanes: false, ..Settings::default() });
}

#[test]
fn the_debug_layout_shows_the_run_and_goes_to_its_steps() {
    let mut harness = arm().layout(Layout::Debug).open();
    harness.get_by_label("Press Space to step");
    click(&mut harness, "Run");
    harness.get_by_label("Convergence plot");
    let last = harness.runs()[0].steps.len() - 1;
    harness.get_by_label("Convergence plot").click();
    settle(&mut harness);
    let step = harness.selection().step.unwrap().step;
    assert!(step < last, "a click in the middle goes to a step there: {step} of {last}");
    click(&mut harness, "Branch");
    assert_eq!(harness.selection().step, None);
}
