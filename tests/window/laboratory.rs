//! The laboratory through the real window: keys, buttons, boxes, plot, marks, and what it leaves alone.

use backlit::context::preferences::Layout;
use backlit::features::laboratory::{Comparison, Laboratory, Lineup};
use backlit_take::demonstration::Demonstration;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Setup, Window, WindowState, arm, choose, click, demonstration, point, press, settle, undo,
};

const NONE: Modifiers = Modifiers::NONE;

fn open(setup: Setup) -> Window {
    let mut harness = setup.layout(Layout::Demonstrate).open();
    if harness.query_by_label("Close explanation").is_some() {
        click(&mut harness, "Close explanation");
    }
    harness
}

fn limb() -> Setup {
    demonstration(Demonstration::SingleLimb)
}

fn laboratory(harness: &Window) -> &Laboratory {
    &harness.state().inspector.features.laboratory
}

fn comparison(harness: &Window) -> &Comparison {
    laboratory(harness).comparison.as_ref().unwrap()
}

/// The step that is looked at, and the last one.
fn steps(harness: &Window) -> (usize, usize) {
    let comparison = comparison(harness);
    (comparison.cursor, comparison.last())
}

/// Chooses an entry of a box.
fn choose_entry(harness: &mut Window, name: &str, entry: &str) {
    harness.get_by_role_and_label(Role::ComboBox, name).click();
    harness.run_steps(2);
    harness.get_all_by_label(entry).last().unwrap().click();
    settle(harness);
}

/// Every picture is of the step that is looked at, and every gradient was checked there.
fn assert_whole(harness: &Window) {
    let comparison = comparison(harness);
    assert_eq!(comparison.stale().count(), 0);
    for fit in &comparison.contestants {
        let (_, pushed) = fit.pushed.as_ref().unwrap();
        assert!(pushed.pushing <= pushed.in_ramp);
        let checked = fit.checked.as_ref().unwrap();
        assert_eq!(Some(&checked.pose), fit.pose(comparison.cursor));
        let columns = fit.scene.fit.parameters.columns(fit.scene.model.rotation_count());
        assert_eq!(checked.progress.total, fit.scene.cameras.len() * columns, "every camera is checked");
        assert!(checked.progress.is_whole() && checked.progress.passes(), "{:?}", checked.progress);
        assert!(checked.progress.compared > 0 && checked.progress.worst.is_some());
    }
}

/// The caption says what its figures are of, and has a row a fit.
fn caption(harness: &Window, title: &str) {
    harness.get_by_label(title);
    let counts = comparison(harness).contestants.iter().map(|fit| {
        let (_, pushed) = fit.pushed.as_ref().unwrap();
        pushed.pushing.to_string()
    });
    for count in counts.filter(|count| count.len() < 4) {
        assert!(harness.get_all_by_label_contains(&format!("{count} of ")).next().is_some(), "{count}");
    }
}

#[test]
fn keys_go_through_the_steps_and_leave_the_take_alone() {
    let mut harness = open(limb());
    let before = harness.document().clone();
    assert_eq!(steps(&harness), (25, 25));
    assert_whole(&harness);
    let there = |harness: &mut Window, modifiers: Modifiers, key: Key| {
        press(harness, modifiers, key);
        assert_eq!(comparison(harness).stale().count(), 0);
        steps(harness).0
    };
    assert_eq!(there(&mut harness, NONE, Key::ArrowLeft), 24);
    assert_eq!(there(&mut harness, NONE, Key::Comma), 23);
    assert_eq!(there(&mut harness, NONE, Key::Home), 0);
    harness.get_by_label("Cylinder at 100.0 %");
    assert_eq!(there(&mut harness, NONE, Key::ArrowRight), 1);
    assert_eq!(there(&mut harness, Modifiers::SHIFT, Key::ArrowRight), 11);
    assert_eq!(there(&mut harness, Modifiers::SHIFT, Key::Space), 10);
    assert_eq!(there(&mut harness, NONE, Key::End), 25);
    assert_whole(&harness);

    let curves: Vec<Vec<f64>> = comparison(&harness).contestants.iter().map(|fit| fit.percents()).collect();
    press(&mut harness, Modifiers::COMMAND, Key::R);
    assert_eq!(steps(&harness), (0, 0));
    harness.get_by_label("Before the first step");
    assert_eq!(there(&mut harness, NONE, Key::Space), 1);
    click(&mut harness, "Step");
    assert_eq!(steps(&harness), (2, 2));
    press(&mut harness, NONE, Key::ArrowRight);
    assert_eq!(steps(&harness), (3, 3), "beyond the newest step an arrow makes one");
    press(&mut harness, NONE, Key::Enter);
    assert_eq!(steps(&harness), (25, 25));
    let again: Vec<Vec<f64>> = comparison(&harness).contestants.iter().map(|fit| fit.percents()).collect();
    assert_eq!(curves, again, "the same steps, bit by bit");

    assert_eq!(*harness.document(), before);
    undo(&mut harness);
    assert_eq!(*harness.document(), before, "there is nothing to undo");
    assert!(harness.runs().is_empty());
    assert_eq!(harness.selection().frame, 0);
}

#[test]
fn own_takes_with_several_cameras_and_every_lineup() {
    let mut harness = open(arm());
    assert_eq!(steps(&harness), (0, 0), "an own take waits");
    assert_whole(&harness);
    press(&mut harness, NONE, Key::Num2);
    assert_eq!(laboratory(&harness).choices.camera, 1);
    assert_whole(&harness);
    choose_entry(&mut harness, "Camera", "Camera 1");
    assert_eq!(laboratory(&harness).choices.camera, 0);
    choose_entry(&mut harness, "Limb", "Right forearm");
    choose_entry(&mut harness, "Motion", "twists");
    for fit in &comparison(&harness).contestants {
        let (_, pushed) = fit.pushed.as_ref().unwrap();
        assert_eq!(pushed.pushing, 0, "no silhouette tells a twist");
    }
    caption(&harness, "Before the first step");
    choose_entry(&mut harness, "Motion", "slides along its axis");
    for lineup in Lineup::ALL.into_iter().rev() {
        let name = lineup.words().name;
        choose_entry(&mut harness, "Compare", name);
        assert_eq!(laboratory(&harness).choices.lineup, lineup);
        harness.get_by_label(lineup.words().title);
        caption(&harness, "Before the first step");
        click(&mut harness, &format!("Run {}", lineup.words().all));
        let comparison = comparison(&harness);
        assert!(comparison.is_over(), "{name}");
        assert_eq!(comparison.cursor, comparison.last());
        assert!(comparison.contestants.iter().all(|fit| fit.percent(fit.last()).unwrap() < 100.0), "{name}");
        assert_whole(&harness);
        caption(&harness, "At their ends");
    }
    choose_entry(&mut harness, "Start", "Start 10° off");
    assert_eq!(steps(&harness), (0, 0), "another start begins again");
    caption(&harness, "Before the first step");

    let begun = comparison(&harness).id;
    press(&mut harness, NONE, Key::F1);
    press(&mut harness, NONE, Key::ArrowRight);
    assert_eq!((harness.selection().frame, comparison(&harness).id), (1, begun));
    press(&mut harness, NONE, Key::F3);
    assert!(comparison(&harness).id > begun, "another frame begins again");
    assert!(!harness.document().has_pose(1));
}

#[test]
fn the_plot_is_clicked_copied_and_saved_and_the_worst_pixel_is_marked() {
    let mut harness = open(limb());
    let plot = harness.get_by_label("Laboratory plot").rect();
    point(&mut harness, plot.left_top() + vec2(0.35 * plot.width(), 0.5 * plot.height()));
    let (cursor, last) = steps(&harness);
    assert!((4..15).contains(&cursor) && last == 25, "{cursor} of {last}");
    assert_whole(&harness);
    click(&mut harness, "Copy CSV");
    harness.get_by_label_contains("Copied the curves");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("curves.png");
    harness
        .state_mut()
        .inspector
        .ask(|features, context, requests| features.laboratory.save_plot(&path, context, requests));
    settle(&mut harness);
    assert!(image::open(&path).unwrap().width() > 400);

    let label = |harness: &Window| {
        let button = harness.get_all_by_label_contains("Gradient check of Capsule").next().unwrap();
        button.rect().center()
    };
    let at = label(&harness);
    point(&mut harness, at);
    assert_eq!(laboratory(&harness).choices.marked, Some(1));
    let worst = comparison(&harness).contestants[1].checked.as_ref().unwrap().progress.worst.clone().unwrap();
    let [x, y] = worst.pixel;
    let words = format!("Camera 1, pixel ({x}, {y}), column {}", worst.column);
    assert!(harness.get_all_by_label_contains(&words).next().is_some());
    point(&mut harness, at);
    assert_eq!(laboratory(&harness).choices.marked, None);
    choose(&mut harness, Role::RadioButton, "Log");
    assert!(laboratory(&harness).choices.is_log);
}

/// The worst pixel over all cameras: named with its camera, which a click shows.
#[test]
fn the_worst_pixel_of_all_cameras_is_shown_by_a_click() {
    let mut harness = open(arm());
    let worst = comparison(&harness).contestants[1].checked.as_ref().unwrap().progress.worst.clone().unwrap();
    let other = 1 - worst.camera;
    press(&mut harness, NONE, [Key::Num1, Key::Num2][other]);
    assert_eq!(laboratory(&harness).choices.camera, other);
    let button = harness.get_all_by_label_contains("Gradient check of Capsule").next().unwrap();
    let at = button.rect().center();
    harness
        .get_all_by_label(&format!("Gradient check, worst in camera {}", worst.camera + 1))
        .next()
        .unwrap();
    point(&mut harness, at);
    assert_eq!(
        (laboratory(&harness).choices.marked, laboratory(&harness).choices.camera),
        (Some(1), worst.camera)
    );
    assert_whole(&harness);
    press(&mut harness, NONE, [Key::Num1, Key::Num2][other]);
    point(&mut harness, at);
    assert_eq!(laboratory(&harness).choices.camera, worst.camera, "back to it, still marked");
    point(&mut harness, at);
    assert_eq!(laboratory(&harness).choices.marked, None);
}

/// At the least size of the window nothing of the caption has to be scrolled to, whatever is compared.
#[test]
fn caption_and_legend_have_room_in_the_least_window() {
    for setup in [limb(), arm()] {
        let mut harness = open(setup.sized(1100.0, 700.0));
        for lineup in Lineup::ALL {
            let name = lineup.words().name;
            choose_entry(&mut harness, "Compare", name);
            for run in [false, true] {
                if run {
                    press(&mut harness, NONE, Key::Enter);
                }
                let link = harness.get_by_label_contains("compare ").rect();
                let lowest = harness.get_by_label("Laboratory plot").rect().bottom();
                assert!(link.bottom() <= lowest, "{lineup:?}: {link} below {lowest}");
            }
        }
    }
}

#[test]
fn other_demonstrations_have_captions_too() {
    for which in [Demonstration::OneCamera, Demonstration::Bias] {
        let mut harness = open(demonstration(which).theme(Theme::Light).sized(1100.0, 700.0));
        press(&mut harness, NONE, Key::F3);
        press(&mut harness, NONE, Key::Enter);
        assert!(comparison(&harness).is_over());
        caption(&harness, "At their ends");
    }
}

#[test]
fn column_and_plot_look_as_they_did() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(limb().theme(theme).sized(1100.0, 700.0));
        press(&mut harness, NONE, Key::Home);
        press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
        let head = harness.get_by_label_contains("Capsule at ").rect();
        let upper = harness.get_by_label("Capsule, data and model").rect();
        let foot = harness.get_all_by_label_contains("Gradient check of Capsule").next().unwrap().rect();
        let column =
            Rect::from_min_max(egui::pos2(upper.left(), head.top() - 6.0), foot.max + vec2(14.0, 4.0));
        let plot = harness.get_by_label("Laboratory plot").rect();
        for (rect, name) in [(column, "column"), (plot, "plot")] {
            harness.state_mut().inspector.freeze_times();
            harness.step();
            snapshots.part(&mut harness, rect, &format!("laboratory_{name}_{}", theme_name(theme)));
        }
    }
}
