//! What first users met, so that it stays mended: keys that do nothing say why, one measure for what is compared, menus that
//! stay in the window.

use backlit::context::preferences::Layout;
use backlit_take::demonstration::Demonstration;
use backlit_tracking::body::Kinematics;
use egui::{Key, Modifiers, Order, Vec2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::window::{
    Window, WindowState, arm, built_in, click, command, demonstration, drag, empty, open_menu, press, undo,
};

/// The smallest window, and the commonest laptop's.
const SMALL: [Vec2; 2] = [vec2(1024.0, 640.0), vec2(1366.0, 768.0)];
const MENUS: [&str; 6] = ["File", "Edit", "View", "Fit", "Demonstrate", "Help"];

fn debug() -> Window {
    arm().layout(Layout::Debug).open()
}

#[test]
fn a_key_that_cannot_act_says_why() {
    let mut window = empty().open();
    press(&mut window, Modifiers::NONE, Key::Space);
    window.get_by_label("Step cannot be used now. Open a take first.");
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    window.get_by_label("Track forward cannot be used now. Open a take first.");
    // Esc is for many things, and says nothing of the fit.
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label_contains("Stop cannot be used").is_none());
}

#[test]
fn a_tracked_frame_a_refit_and_a_search_have_one_measure() {
    let mut window = debug();
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    let rms = |window: &Window| {
        let state = window.state();
        state.inspector.document().estimates[&state.inspector.state.selection.frame].rms.unwrap()
    };
    let tracked = rms(&window);
    press(&mut window, Modifiers::NONE, Key::Enter);
    let fitted = rms(&window);
    // A fit goes on from where the tracker ended, and finds little more.
    assert!((0.7..1.01).contains(&(fitted / tracked)), "tracked {tracked}, fitted {fitted}");
    press(&mut window, Modifiers::COMMAND, Key::F);
    click(&mut window, "Refit");
    let best = window.get_by_label_contains("Pose 1: ");
    let text = best.accesskit_node().label().unwrap();
    let said = text.split("RMS ").nth(1).and_then(|rest| rest.split(',').next()).unwrap();
    let searched: f64 = said.parse().unwrap();
    assert!(text.ends_with("best") && (searched / fitted - 1.0).abs() < 0.1, "fitted {fitted}, {text}");
}

#[test]
fn runs_from_one_start_are_measured_alike() {
    let mut window = debug();
    press(&mut window, Modifiers::NONE, Key::Enter);
    for over in ["ramp", "preset", "renderer"] {
        command(&mut window, &format!("Run again with each {over}"));
    }
    let runs = window.runs();
    assert!(runs.len() >= 6, "{} runs", runs.len());
    let start = runs[0].steps[0].mismatch;
    for run in runs.iter().filter(|run| run.choices.fit.renderer == runs[0].choices.fit.renderer) {
        assert_eq!(run.steps[0].mismatch, start, "{}", run.name);
        assert!(run.steps.last().unwrap().mismatch < start, "{}", run.name);
    }
    // Runs by hand are measured like that too.
    press(&mut window, Modifiers::SHIFT, Key::Backspace);
    command(&mut window, "Report 2004");
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(window.runs().last().unwrap().steps[0].mismatch, start);
}

#[test]
fn menus_stay_within_the_window() {
    for size in SMALL {
        for menu in MENUS {
            let mut window = arm().sized(size.x, size.y).open();
            open_menu(&mut window, menu);
            let inside = window.ctx.content_rect();
            let areas: Vec<egui::Rect> = window.ctx.memory(|memory| {
                let layers = memory.layer_ids().filter(|layer| layer.order == Order::Foreground);
                layers.filter_map(|layer| memory.area_rect(layer.id)).collect()
            });
            assert!(areas.iter().any(|area| area.height() > 60.0), "{menu} is not open: {areas:?}");
            let out = areas.iter().find(|area| !inside.contains_rect(**area));
            assert_eq!(out, None, "{menu} at {size}");
        }
    }
}

/// Where there is room a menu shows all of its rows; its last one can be seen and clicked.
#[test]
fn menus_end_where_the_window_is_tall() {
    let last = ["Quit", "Next joint", "Camera alone", "Ways to begin", "Restart laboratory", "About Backlit"];
    for (menu, last) in MENUS.into_iter().zip(last) {
        let mut window = arm().sized(1366.0, 1000.0).open();
        open_menu(&mut window, menu);
        let areas: Vec<egui::Rect> = window.ctx.memory(|memory| {
            let layers = memory.layer_ids().filter(|layer| layer.order == Order::Foreground);
            layers.filter_map(|layer| memory.area_rect(layer.id)).collect()
        });
        let seen = window
            .get_all_by_label_contains(last)
            .any(|row| areas.iter().any(|area| area.contains_rect(row.rect())));
        assert!(seen, "{menu} does not reach {last}: {areas:?}");
    }
}

#[test]
fn letters_grow_and_shrink_by_keys() {
    let mut window = debug();
    let zoom = |window: &Window| window.ctx.zoom_factor();
    press(&mut window, Modifiers::COMMAND, Key::Plus);
    assert!((zoom(&window) - 1.1).abs() < 1e-3, "{}", zoom(&window));
    press(&mut window, Modifiers::COMMAND, Key::Minus);
    press(&mut window, Modifiers::COMMAND, Key::Minus);
    assert!((zoom(&window) - 0.9).abs() < 1e-3, "{}", zoom(&window));
    command(&mut window, "Usual letters");
    assert_eq!(zoom(&window), 1.0);
}

#[test]
fn what_undo_said_goes_with_the_next_act() {
    let mut window = debug();
    drag(&mut window, "right wrist, Camera 1", vec2(0.0, 30.0));
    undo(&mut window);
    assert!(window.query_by_label_contains("Undone: ").is_some());
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert!(window.query_by_label_contains("Undone: ").is_none());
}

#[test]
fn a_dragged_wrist_leaves_the_other_arm_alone() {
    let mut window = built_in().sized(1600.0, 1000.0).open();
    let places = |window: &Window| {
        let document = window.document();
        let kinematics = Kinematics::new(&document.model, document.pose_at(0));
        ["right hand", "left hand", "left foot"].map(|name| {
            let limb = document.model.limbs().iter().position(|limb| limb.name.contains(name)).unwrap();
            kinematics.ends()[limb]
        })
    };
    let before = places(&window);
    drag(&mut window, "right wrist, Camera 1", vec2(20.0, -20.0));
    let moved: Vec<f64> = places(&window).iter().zip(before).map(|(a, b)| a.distance(b)).collect();
    assert!(moved[0] > 0.02, "{moved:?} m");
    assert!(moved[1] < 0.003 && moved[2] < 0.003, "{moved:?} m");
}

#[test]
fn stages_are_edited_and_the_next_run_obeys() {
    let mut window = debug();
    let stages = window.document().fit.stages.len();
    click(&mut window, "Edit stages");
    for stage in 1..=stages {
        let field = format!("Stage {stage}, steps value");
        window.get_by_label(&field).click();
        window.run_steps(2);
        window.key_press_modifiers(Modifiers::COMMAND, Key::A);
        window.run_steps(2);
        window.event(egui::Event::Text("1".to_owned()));
        window.run_steps(2);
        press(&mut window, Modifiers::NONE, Key::Enter);
    }
    let fit = &window.document().fit;
    assert!(fit.stages.iter().all(|stage| stage.iterations == 1), "{:?}", fit.stages);
    press(&mut window, Modifiers::NONE, Key::Enter);
    let run = window.runs().last().unwrap();
    // Rejected steps do not count.
    let accepted = run.accepted_until(run.last_step());
    assert!((1..=stages).contains(&accepted), "{accepted} steps");
}

#[test]
fn demonstrations_of_the_report_open_ready_to_compare() {
    for which in Demonstration::ALL[..7].iter().filter(|which| which.is_available()) {
        let window = demonstration(*which).sized(1366.0, 768.0).open();
        assert_eq!(window.settings().layout, Layout::Demonstrate, "{which:?}");
        let tries = ["Compare", "Fit with camera", "Track"];
        let offers = tries.iter().any(|text| window.query_all_by_label_contains(text).next().is_some());
        assert!(offers, "{which:?} offers nothing to try");
    }
}
