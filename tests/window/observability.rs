//! What the cameras see, through the real window on a tiny take: picking, swaying, ellipses, sets of cameras.

use backlit::context::preferences::Layout;
use backlit::features::observability::Observability;
use backlit_ui::style::theme::{Theme, size};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{Window, WindowState, arm, choose, click, freeze, press, undo};

const WIDTH: f32 = 1400.0;
const HEIGHT: f32 = 1500.0;
/// The harness leaves so much free around the window.
const MARGIN: f32 = 8.0;

fn open(theme: Theme) -> Window {
    let mut harness = arm().layout(Layout::Debug).theme(theme).sized(WIDTH, HEIGHT).open();
    click(&mut harness, "Run");
    harness
}

fn observability(harness: &Window) -> &Observability {
    &harness.state().inspector.features.observability
}

fn chart<'a>(harness: &'a Window) -> egui_kittest::Node<'a> {
    harness.get_by_label_contains("Singular values, direction")
}

#[test]
fn a_picked_direction_sways_until_the_pose_is_edited() {
    let mut harness = open(Theme::Dark);
    let found = observability(&harness).found().unwrap();
    assert_eq!(found.shown.directions.len(), 9);
    assert_eq!(found.shown.null_count(), 2, "the twists of both limbs");
    assert!(observability(&harness).swaying().is_none(), "still until asked");
    let document = harness.document().clone();

    // The middle of the chart is a direction that is seen.
    chart(&harness).click();
    harness.run_steps(3);
    let (_, direction) = observability(&harness).direction().unwrap();
    assert!(!direction.is_null && observability(&harness).is_playing());
    harness.run_steps(12);
    let swayed = observability(&harness).swayed_pose().unwrap();
    assert_ne!(swayed, *document.pose_at(0), "it has moved");
    let shown = &observability(&harness).found().unwrap().shown;
    let kinematics = |pose| backlit_tracking::body::Kinematics::new(&shown.model, pose);
    let (here, there) = (kinematics(&shown.pose), kinematics(&swayed));
    let farthest = here.ends().iter().zip(there.ends()).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(farthest > 1e-3 && farthest < 0.065, "no joint sways farther than 60 mm: {farthest}");
    assert_eq!(*harness.document(), document, "the document is not touched");

    click(&mut harness, "Hold");
    let held = observability(&harness).swayed_pose().unwrap();
    harness.run_steps(6);
    assert_eq!(observability(&harness).swayed_pose().unwrap(), held);
    click(&mut harness, "Put back");
    assert!(!observability(&harness).is_swaying());

    click(&mut harness, "Sway");
    harness.run_steps(3);
    assert!(observability(&harness).is_playing());
    press(&mut harness, Modifiers::NONE, Key::X);
    press(&mut harness, Modifiers::SHIFT, Key::Backspace);
    assert_ne!(harness.document(), &document);
    assert!(!observability(&harness).is_swaying(), "an edited pose stops it");
    assert!(!observability(&harness).is_stale(), "and is looked at again");
}

#[test]
fn directions_are_picked_by_keys_and_esc_puts_the_body_back() {
    let mut harness = open(Theme::Dark);
    let weakest = observability(&harness).picked().unwrap();
    assert_eq!(weakest, 6, "at first the weakest that is seen");
    press(&mut harness, Modifiers::NONE, Key::PageDown);
    press(&mut harness, Modifiers::NONE, Key::PageDown);
    assert_eq!(observability(&harness).picked(), Some(8));
    harness.get_by_label_contains("Direction 9 of 9: right forearm twist");
    harness.get_by_label_contains("No camera sees this.");
    harness.get_by_label_contains("No joint moves");
    press(&mut harness, Modifiers::SHIFT, Key::U);
    harness.run_steps(3);
    let swaying = observability(&harness).swaying().unwrap();
    assert_eq!(swaying.twisted, [1], "seams show what no outline does");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!observability(&harness).is_swaying());

    chart(&harness).focus();
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    assert_eq!(observability(&harness).picked(), Some(7));
    assert_eq!(harness.selection().frame, 0, "the arrow is the chart's");
    let steps = harness.runs()[0].steps.len();
    press(&mut harness, Modifiers::NONE, Key::Space);
    assert!(observability(&harness).is_playing());
    assert_eq!(harness.runs()[0].steps.len(), steps, "and so is Space");
}

#[test]
fn ellipses_and_sets_of_cameras() {
    let mut harness = open(Theme::Dark);
    choose(&mut harness, Role::CheckBox, "Uncertainty in the views");
    let (joints, others) = observability(&harness).ellipses().unwrap();
    assert_eq!((joints.len(), others), (3, None));
    let two = joints[2].worst_deviation_m();
    assert!(two > 0.0 && two.is_finite());
    // What is drawn says by how much it is larger than life, and the user may choose.
    let drawn = observability(&harness).ellipse_factor();
    choose(&mut harness, Role::ComboBox, &format!("Ellipses drawn Automatic, ×{drawn}"));
    choose(&mut harness, Role::Button, "×5");
    assert!(harness.query_all_by_label_contains("σ, drawn ×5").next().is_some());
    assert_eq!(observability(&harness).ellipse_factor(), 5);

    harness.get_by_role_and_label(Role::ListItem, "Cameras 2").hover();
    harness.run_steps(3);
    let (joints, others) = observability(&harness).ellipses().unwrap();
    assert_eq!(others, Some(&[1][..]));
    assert!(joints[2].worst_deviation_m() > two, "one camera knows less");

    let before = harness.document().clone();
    choose(&mut harness, Role::ListItem, "Cameras 2");
    assert_eq!(harness.document().used_cameras().collect::<Vec<_>>(), [1]);
    assert_eq!(observability(&harness).found().unwrap().shown.cameras, [1], "looked at again");
    undo(&mut harness);
    assert_eq!(*harness.document(), before, "undone as one");
}

#[test]
fn figures_are_not_made_where_nobody_looks() {
    let mut harness = arm().sized(WIDTH, 900.0).open();
    assert!(observability(&harness).found().is_none());
    press(&mut harness, Modifiers::NONE, Key::U);
    assert!(observability(&harness).ellipses().is_some());
}

#[test]
fn both_sections() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(theme);
        press(&mut harness, Modifiers::NONE, Key::PageDown);
        harness.set_render_cursor(false);
        let top =
            |harness: &Window, title: &str| harness.get_by_role_and_label(Role::Button, title).rect().top();
        freeze(&mut harness);
        let right = WIDTH - MARGIN;
        let left = right - size::RIGHT_PANEL_DEBUG;
        let (first, second) = (top(&harness, "Observability"), top(&harness, "Camera subsets"));
        let status_bar = HEIGHT - MARGIN - size::STATUS_BAR;
        let basin = harness.query_by_role_and_label(Role::Button, "Basin");
        let end = basin.map_or(status_bar, |head| head.rect().top()).min(status_bar);
        for (name, from, to) in [("observability", first, second), ("camera_subsets", second, end)] {
            let rect = Rect::from_x_y_ranges(left..=right, from..=to);
            snapshots.part(&mut harness, rect, &format!("panel_{name}_{}", theme_name(theme)));
        }
    }
}
