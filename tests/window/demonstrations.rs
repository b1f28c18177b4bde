//! Every demonstration through the real window, from the menu to what is to be seen.

use std::sync::Arc;

use backlit::context::preferences::Layout;
use backlit::features::laboratory::Contestant;
use backlit_lab::experiment::{Simulation, scene};
use backlit_lab::synthetic::{single_limb, upper_body};
use backlit_take::demonstration::Demonstration;
use backlit_tracking::body::{Kinematics, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, Preset};
use backlit_tracking::render::RendererKind;
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::support::window::{
    Window, WindowState, arm, at, click, command, demonstration, empty, press, save, settle,
};

/// Two clicks: the menu, and the demonstration in it.
fn show(harness: &mut Window, label: &str) {
    harness.get_by_role_and_label(Role::Button, "Demonstrate").click();
    harness.run_steps(2);
    let row = harness.get_all_by_label_contains(label).next().unwrap();
    row.click();
    settle(harness);
}

/// Mean distance of the limbs' ends from the true ones, millimetres.
fn error_mm(found: &Pose) -> f64 {
    let model = builtin::upper_body();
    let truth = Kinematics::new(&model, &upper_body::motion(&model, 0));
    let found = Kinematics::new(&model, found);
    let sum: f64 = found.ends().iter().zip(truth.ends()).map(|(a, b)| a.distance(*b)).sum();
    1000.0 * sum / model.limbs().len() as f64
}

/// The laboratory's fits, each with the last mismatch in percent of the first.
fn fits(harness: &Window) -> Vec<(&'static str, f64)> {
    let comparison = harness.state().inspector.features.laboratory.comparison.as_ref().unwrap();
    let percent = |fit: &Contestant| (fit.entrant.name, fit.percent(fit.last()).unwrap());
    comparison.contestants.iter().map(percent).collect()
}

/// How far each of the laboratory's fits ended from the truth, millimetres.
fn errors_mm(harness: &Window) -> Vec<(&'static str, f64)> {
    let comparison = harness.state().inspector.features.laboratory.comparison.as_ref().unwrap();
    let error = |fit: &Contestant| (fit.entrant.name, error_mm(&fit.steps.last().unwrap().iteration.point));
    comparison.contestants.iter().map(error).collect()
}

/// The last cost of the report's fit with one renderer, in percent of the first.
fn measured_percent(renderer: RendererKind) -> f64 {
    let model = Arc::new(builtin::single_limb());
    let camera = single_limb::camera(10.0, [192, 144]).unwrap();
    let options = FitOptions { run_all: true, renderer, ..FitOptions::preset(Preset::Report) };
    let (truth, ramp) = (single_limb::truth(), options.final_ramp());
    let capsule = RendererKind::Capsule;
    let view = scene::view(&model, &truth, &camera, Simulation::Prediction, capsule, ramp).unwrap();
    let mut fit = Fit::new(model, vec![view], single_limb::start(single_limb::OFFSET_M), options).unwrap();
    let summary = fit.run(&CancelToken::new(), |_| {});
    100.0 * summary.iterations.last().unwrap().cost / summary.initial_cost
}

#[test]
fn two_clicks_show_the_single_limb_with_all_three_renderers() {
    let mut harness = empty().open();
    show(&mut harness, "Fig. 5.1");
    // The same fits as the command's, but for the rounding of the pictures to whole grey levels.
    for ((name, percent), renderer) in fits(&harness).into_iter().zip(RendererKind::in_report_order()) {
        assert_eq!(name.to_lowercase().replace(' ', "-"), renderer.name());
        assert!((percent - measured_percent(renderer)).abs() < 0.1, "{name}: {percent} %");
    }
    assert!(fits(&harness)[0].1 > 99.0);
    harness.get_by_label("At their ends");
    assert!(!harness.document().has_pose(1));
    assert!(harness.runs().is_empty(), "the laboratory leaves the other layouts alone");
    let comparison = harness.state().inspector.features.laboratory.comparison.as_ref().unwrap();
    assert_eq!((comparison.last(), comparison.cursor), (25, 25));
}

#[test]
fn one_camera_is_fooled_and_two_are_not() {
    let mut harness = empty().open();
    show(&mut harness, "Fig. 5.2");
    assert!(fits(&harness)[1..].iter().all(|(_, percent)| *percent < 2.0), "{:?}", fits(&harness));
    let fooled = errors_mm(&harness);
    assert!(fooled.iter().all(|(_, error)| *error > 25.0), "{fooled:?} mm");
    harness.get_by_label("Joints, mm");
    assert_eq!(harness.document().used_cameras().count(), 1);
    assert_eq!(harness.state().inspector.features.laboratory.choices.camera, 1, "the camera that shows it");

    click(&mut harness, "Fit with camera 2 too");
    assert_eq!(harness.document().used_cameras().count(), 2);
    let found = errors_mm(&harness);
    assert!(found.iter().zip(&fooled).all(|(two, one)| two.1 < 0.5 * one.1), "{found:?} of {fooled:?} mm");

    show(&mut harness, "Fig. 5.3");
    click(&mut harness, "Compare presets");
    let two = errors_mm(&harness);
    assert_eq!(two.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["Report 2004", "Robust"]);
    assert!(two.iter().all(|(_, error)| *error < 6.0), "{two:?} mm");
}

#[test]
fn the_thesis_ramp_leaves_the_truth() {
    let mut harness = empty().open();
    show(&mut harness, "Bias of a ramp");
    let found = errors_mm(&harness);
    let of = |name: &str| found.iter().find(|(ramp, _)| ramp.starts_with(name)).unwrap().1;
    assert!(of("Thesis") > 100.0 && of("Half") < 0.3 * of("Thesis"), "{found:?} mm");
}

#[test]
fn a_sequence_is_tracked_and_a_project_of_it_opens_again() {
    let mut harness = empty().open();
    show(&mut harness, "Fig. 5.6");
    assert_eq!(harness.session().frame_count(), 50);
    assert!(harness.runs().is_empty());
    click(&mut harness, "Track with Robust");
    let document = harness.document();
    assert_eq!(document.estimates.len(), 50);
    assert!(document.estimates.values().all(|found| !found.lost));

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tiny.backlit");
    save(&mut harness, &path);
    let saved = harness.document().clone();
    assert_eq!(*at(&path).open().document(), saved, "a project keeps its poses: nothing runs by itself");
}

#[test]
fn a_demonstration_is_no_unsaved_work_and_its_sentences_go() {
    let mut harness = demonstration(Demonstration::SingleLimb).open();
    assert!(harness.query_by_label_contains("Fig. 5.1: one limb •").is_none(), "nothing is unsaved");
    harness.get_by_label("Fig. 5.1: one limb");
    press(&mut harness, Modifiers::NONE, Key::Y);
    assert!(harness.query_by_label_contains("Fig. 5.1: one limb •").is_none(), "a click makes it again");
    show(&mut harness, "Fig. 5.2");
    harness.get_by_label_contains("Only camera 1 counts");
    click(&mut harness, "Close explanation");
    assert!(harness.query_by_label_contains("Only camera 1 counts").is_none());
    show(&mut harness, "Fig. 5.3");
    // Another take: the sentences go.
    show(&mut harness, "Fig. 5.1");
    assert!(harness.query_by_label_contains("The same start as with one camera").is_none());
}

/// Tiles and layout of a demonstration are its own: the user's come back with the user's take.
#[test]
fn tiles_of_a_demonstration_stay_with_it() {
    let mut window = arm().layout(Layout::Debug).open();
    show(&mut window, "Fig. 5.1");
    assert_eq!(window.settings().layout, Layout::Demonstrate);
    assert_eq!(window.state().inspector.kept_settings().layout, Layout::Debug, "so begins the next start");
    command(&mut window, "Open built-in take");
    settle(&mut window);
    window.get_by_label("Press Space to step");
    assert_eq!(window.settings().layout, Layout::Debug);
}
