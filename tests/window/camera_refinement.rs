//! The refinement of cameras through the real window: what is free is chosen, what was found is told, used and taken back.

use egui::accesskit::Role;
use egui::{Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::readable::{assert_readable, look_over};
use crate::support::snapshots::Snapshots;
use crate::support::window::{WindowState, built_in, choose, click, command};

#[test]
fn cameras_are_refined_used_and_taken_back() {
    let mut window = built_in().sized(1024.0, 640.0).open();
    window.set_render_cursor(false);
    command(&mut window, "Check cameras…");
    click(&mut window, "Refine cameras…");
    assert!(window.query_by_label("Use refined cameras").is_none(), "first the user says what is free");
    choose(&mut window, Role::CheckBox, "Focal length");
    click(&mut window, "Refine");
    let (mut snapshots, mut wrong) = (Snapshots::default(), Vec::new());
    let card = Rect::from_min_size(pos2(186.0, 40.0), vec2(652.0, 580.0));
    snapshots.part(&mut window, card, "panel_camera_refinement_dark");
    look_over(&window, "refined", &mut wrong);

    let truth = window.session().take.as_ref().unwrap().take().full_rig().clone();
    click(&mut window, "Use refined cameras");
    let refined = window.document().calibration.clone().unwrap();
    for (found, camera) in refined.rig.cameras().iter().zip(truth.cameras()) {
        let (found, truth) = (found.camera_from_world(), camera.camera_from_world());
        let turn = found.rotation * truth.rotation.transpose();
        let trace: f64 = (0..3).map(|axis| turn.col(axis)[axis]).sum();
        assert!(trace > 1.0 + 2.0 * 1_f64.to_radians().cos(), "turned by more than a degree: {turn}");
        assert!((found.translation - truth.translation).length() < 0.1, "{found:?} {truth:?}");
    }
    window.get_by_label_contains("In use now: the cameras below");
    look_over(&window, "in use", &mut wrong);
    click(&mut window, "Undo refinement");
    assert_eq!(window.document().calibration, None);

    click(&mut window, "Close");
    command(&mut window, "Dark or light");
    command(&mut window, "Refine cameras…");
    snapshots.part(&mut window, card, "panel_camera_refinement_light");
    window.set_size(vec2(1366.0, 768.0));
    window.run();
    look_over(&window, "in a larger window", &mut wrong);
    assert_readable(&wrong);
}
