//! The convergence panel through the real window: runs named, hidden, removed, brought back, read out, exported.

use backlit::context::preferences::Layout;
use backlit::features::convergence::CurvesFile;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Window, WindowState, arm, choose, click, command, freeze, press, settle, type_over, undo, write_curves,
};

fn open(theme: Theme, width: f32, height: f32) -> Window {
    arm().layout(Layout::Debug).theme(theme).sized(width, height).open()
}

fn open_dark() -> Window {
    open(Theme::Dark, 1400.0, 900.0)
}

fn names(harness: &Window) -> Vec<String> {
    harness.runs().iter().map(|run| run.name.clone()).collect()
}

/// Runs the fit from the take's start with each renderer.
fn three_renderers(harness: &mut Window) {
    for key in [Key::C, Key::Y, Key::S] {
        press(harness, Modifiers::SHIFT, Key::Backspace);
        press(harness, Modifiers::NONE, key);
        press(harness, Modifiers::NONE, Key::Enter);
    }
}

#[test]
fn runs_are_named_by_what_differs_between_those_that_are_shown() {
    let mut harness = open_dark();
    click(&mut harness, "Run");
    assert_eq!(names(&harness), ["Robust"]);
    three_renderers(&mut harness);
    click(&mut harness, "Remove run 1");
    assert_eq!(names(&harness), ["Capsule", "Cylinder", "Sphere tree"]);
    harness.get_by_role_and_label(Role::ListItem, "Run 3: Cylinder");

    // What is hidden is not compared with.
    click(&mut harness, "Hide curve of run 3");
    click(&mut harness, "Hide curve of run 4");
    assert_eq!(names(&harness)[0], "Robust");
    click(&mut harness, "Show curve of run 3");

    // A name of one's own stays; an empty one says again what differs.
    click(&mut harness, "Rename run 3");
    type_over(&mut harness, "Name of run 3", "Flat ends");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(names(&harness)[1], "Flat ends");
}

#[test]
fn removed_runs_come_back_with_one_undo() {
    let mut harness = open_dark();
    three_renderers(&mut harness);
    let before = names(&harness);
    click(&mut harness, "Clear runs");
    assert!(names(&harness).is_empty());
    harness.get_by_label("Removed 3 runs.");
    click(&mut harness, "Undo remove runs");
    assert_eq!(names(&harness), before);

    let document = harness.document().clone();
    click(&mut harness, "Remove run 2");
    assert_eq!(names(&harness), ["Capsule", "Sphere tree"]);
    undo(&mut harness);
    assert_eq!(names(&harness), before);
    assert_eq!(*harness.document(), document, "the document is not what is undone");

    // Runs that were made since stay, and colours are not used twice.
    click(&mut harness, "Clear runs");
    click(&mut harness, "Run");
    command(&mut harness, "undo remove");
    let runs = harness.runs();
    assert_eq!(runs.iter().map(|run| run.number).collect::<Vec<_>>(), [1, 2, 3, 4]);
}

#[test]
fn a_branch_is_named_after_its_step_and_the_old_run_stays() {
    let mut harness = open_dark();
    click(&mut harness, "Run");
    for _ in 0..3 {
        press(&mut harness, Modifiers::NONE, Key::Comma);
    }
    let step = harness.selection().step.unwrap().step;
    click(&mut harness, "Branch");
    click(&mut harness, "Run");
    let expected = format!("From step {step} of run 1");
    let named = names(&harness);
    assert!(named[0] == "Start 1" && named[1].starts_with("From step"), "{named:?}, {expected}");
}

#[test]
fn the_slider_takes_arrow_keys_once_it_has_the_focus() {
    let mut harness = open_dark();
    click(&mut harness, "Run");
    let frame = harness.selection().frame;
    choose(&mut harness, Role::Slider, "Step");
    let at = harness.selection().step.unwrap().step;
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    assert_eq!(harness.selection().step.unwrap().step, at - 1);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert_eq!(harness.selection().step.unwrap().step, at + 1);
    assert_eq!(harness.selection().frame, frame);
    // Keys that it has no use for are the window's.
    press(&mut harness, Modifiers::NONE, Key::Space);
    settle(&mut harness);
    assert_eq!(names(&harness).len(), 2);
}

#[test]
fn the_plot_stands_where_the_views_do() {
    let mut harness = open_dark();
    click(&mut harness, "Run");
    let last = harness.runs()[0].steps.len() - 1;
    harness.get_by_label(&format!("Step {last} of {last}"));
    for _ in 0..3 {
        press(&mut harness, Modifiers::NONE, Key::Comma);
    }
    let step = harness.selection().step.unwrap().step;
    click(&mut harness, "Branch");
    assert_eq!(harness.selection().step, None);
    harness.get_by_label(&format!("Step {step} of {last}"));
    // Undone is the branch, then the fit.
    undo(&mut harness);
    harness.get_by_label(&format!("Step {last} of {last}"));
    undo(&mut harness);
    harness.get_by_label(&format!("Step 0 of {last}"));
}

#[test]
fn the_pointer_reads_a_step_out_and_a_click_goes_there() {
    let mut harness = open_dark();
    click(&mut harness, "Run");
    let plot = harness.get_by_label("Convergence plot").rect();
    let at = pos2(plot.left() + 0.3 * plot.width(), plot.center().y);
    // Every height of a column: some of them is near the curve.
    let found = (0..40).any(|row| {
        harness.event(Event::PointerMoved(pos2(at.x, plot.top() + plot.height() * row as f32 / 40.0)));
        harness.run_steps(2);
        harness.query_by_label("Step norm").is_some()
    });
    assert!(found, "no step is read out");
    harness.get_by_label("accepted");
    harness.get_by_label("Expected");
}

#[test]
fn curves_are_written_as_they_are_shown() {
    let mut harness = open_dark();
    three_renderers(&mut harness);
    let folder = tempfile::tempdir().unwrap();
    let (csv, png) = (folder.path().join("curves.csv"), folder.path().join("plot.png"));
    write_curves(harness.state_mut(), CurvesFile::Table, &csv);
    write_curves(harness.state_mut(), CurvesFile::Plot, &png);
    settle(&mut harness);
    harness.get_by_label("Wrote curves.csv, plot.png.");
    let text = std::fs::read_to_string(&csv).unwrap();
    let steps: usize = harness.runs().iter().map(|run| run.steps.len()).sum();
    assert_eq!(text.lines().count(), steps + 1);
    assert!(text.starts_with("run,name,") && text.contains("Sphere tree"));
    let picture = image::open(&png).unwrap();
    assert!(picture.width() > 400);
    write_curves(harness.state_mut(), CurvesFile::Table, &folder.path().join("no/such/folder/x.csv"));
    settle(&mut harness);
    harness.get_by_label_contains("x.csv: cannot be written: its folder is not there");
}

/// The panel alone, without times.
fn panel(snapshots: &mut Snapshots, harness: &mut Window, name: &str) {
    freeze(harness);
    let plot = harness.get_by_label("Convergence plot").rect();
    let slider = harness.get_by_role_and_label(Role::Slider, "Step").rect();
    let rect =
        Rect::from_min_max(plot.min - vec2(64.0, 34.0), pos2(plot.right() + 350.0, slider.bottom() + 4.0));
    snapshots.part(harness, rect, name);
}

#[test]
fn the_panel_with_three_runs() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(theme, 1240.0, 760.0);
        three_renderers(&mut harness);
        harness.state_mut().inspector.state.notices.close_all();
        panel(&mut snapshots, &mut harness, &format!("curves_three_runs_{}", theme_name(theme)));
    }
}
