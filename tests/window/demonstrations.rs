//! Every demonstration through the real window, from the menu to what is to be seen.

use backlit::app::{App, AppOptions, Opening, opening_of};
use backlit::features::laboratory::Contestant;
use backlit::take::source::TakeSource;
use backlit_lab::experiment::fig51;
use backlit_lab::synthetic::upper_body;
use backlit_tracking::body::{Kinematics, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::support::app_window::{click, open_sized, press, settle};

fn open() -> Harness<'static, App> {
    open_sized(AppOptions::default(), vec2(1500.0, 900.0))
}

/// Two clicks: the menu, and the demonstration in it.
fn show(harness: &mut Harness<'_, App>, label: &str) {
    harness.get_by_role_and_label(Role::Button, "Demonstrate").click();
    harness.run_steps(2);
    let row = harness.get_all_by_label_contains(label).next().unwrap();
    row.click();
    settle(harness);
}

/// Names of the runs, each with the last mismatch in percent of the first.
fn runs(harness: &Harness<'_, App>) -> Vec<(String, f64)> {
    let runs = harness.state().runs();
    assert!(runs.iter().all(|run| run.ending.is_some()));
    runs.iter().map(|run| (run.name.clone(), 100.0 * run.fraction(run.steps.len() - 1).unwrap())).collect()
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
fn fits(harness: &Harness<'_, App>) -> Vec<(&'static str, f64)> {
    let comparison = harness.state().laboratory().comparison.as_ref().unwrap();
    let percent = |fit: &Contestant| (fit.entrant.name, fit.percent(fit.last()).unwrap());
    comparison.contestants.iter().map(percent).collect()
}

#[test]
fn two_clicks_show_the_single_limb_with_all_three_renderers() {
    let mut harness = open();
    show(&mut harness, "Fig. 5.1");
    let measured = fig51::run(&fig51::Options::default(), &CancelToken::new(), |_| {}).unwrap();
    // The same curves as the command's, but for the rounding of the pictures to whole grey levels.
    for ((name, percent), curve) in fits(&harness).into_iter().zip(&measured.parts[0].curves) {
        assert_eq!(name.to_lowercase().replace(' ', "-"), curve.name);
        assert!((percent - curve.final_percent()).abs() < 0.1, "{name}: {percent} %");
    }
    assert!(fits(&harness)[0].1 > 99.0);
    harness.get_by_label("Why the flat ends lose");
    assert!(!harness.state().document().has_pose(1));
    assert!(harness.state().runs().is_empty(), "the laboratory leaves the other layouts alone");
    let comparison = harness.state().laboratory().comparison.as_ref().unwrap();
    assert_eq!((comparison.last(), comparison.cursor), (25, 25));
}

#[test]
fn one_camera_is_fooled_and_two_are_not() {
    let mut harness = open();
    show(&mut harness, "Fig. 5.2");
    let one = runs(&harness);
    assert!(one.len() == 1 && one[0].1 < 1.0, "{one:?}");
    let fooled = error_mm(harness.state().document().pose_at(0));
    assert!(fooled > 25.0, "{fooled} mm");
    assert_eq!(harness.state().document().used_cameras().count(), 1);

    show(&mut harness, "Fig. 5.3");
    let two = runs(&harness);
    assert_eq!(two.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["Report 2004", "Tangent LM"]);
    let found = error_mm(harness.state().document().pose_at(0));
    assert!(found < 0.2, "{found} mm");
}

#[test]
fn what_to_try_next_is_a_button_away() {
    let mut harness = open();
    show(&mut harness, "Fig. 5.2");
    let fooled = error_mm(harness.state().document().pose_at(0));
    click(&mut harness, "Fit with camera 2 too");
    assert_eq!(harness.state().document().used_cameras().count(), 2);
    let found = error_mm(harness.state().document().pose_at(0));
    assert!(found < 0.5 * fooled, "{found} of {fooled} mm");

    show(&mut harness, "Fig. 5.3");
    let before = harness.state().document().clone();
    click(&mut harness, "Run with each renderer");
    let names: Vec<String> = runs(&harness).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names.len(), 4, "the capsule has run already: {names:?}");
    assert_eq!(harness.state().document().estimates, before.estimates, "the body stays as it was");
}

#[test]
fn the_thesis_ramp_leaves_the_truth() {
    let mut harness = open();
    show(&mut harness, "Bias of a ramp");
    let steps = |name: &str| {
        let run = harness.state().runs().iter().find(|run| run.name == name).unwrap();
        [run.steps.first().unwrap().pose.clone(), run.steps.last().unwrap().pose.clone()]
            .map(|p| error_mm(&p))
    };
    let ([start, thesis], [_, half]) = (steps("Thesis"), steps("Half"));
    assert!(start < 1e-6 && thesis > 100.0 && half < 0.3 * thesis, "{start}, {thesis}, {half} mm");
}

#[test]
fn a_sequence_is_tracked_and_a_project_of_it_opens_again() {
    let mut harness = open();
    show(&mut harness, "Fig. 5.6");
    assert_eq!(harness.state().session().frame_count(), 50);
    assert!(harness.state().runs().is_empty());
    click(&mut harness, "Track forward");
    let document = harness.state().document();
    assert_eq!(document.estimates.len(), 50);
    assert!(document.estimates.values().all(|found| !found.lost));

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tiny.backlit");
    harness.state_mut().save_to(&path);
    settle(&mut harness);
    let saved = harness.state().document().clone();
    let again = open_sized(
        AppOptions { opening: Some(opening_of(&path)), ..AppOptions::default() },
        vec2(1500.0, 900.0),
    );
    assert_eq!(*again.state().document(), saved, "a project keeps its poses: nothing runs by itself");
}

#[test]
fn what_ran_by_itself_is_no_unsaved_work_and_stops_when_asked() {
    let demonstration = backlit::take::demonstration::Demonstration::SingleLimb;
    let opening = Some(Opening::Take(TakeSource::Demonstration(demonstration)));
    let mut harness = open_sized(AppOptions { opening, ..AppOptions::default() }, vec2(1500.0, 900.0));
    assert!(harness.query_by_label_contains("Fig. 5.1: one limb •").is_none(), "nothing is unsaved");
    harness.get_by_label("Fig. 5.1: one limb");
    press(&mut harness, Modifiers::NONE, Key::C);
    harness.get_by_label_contains("Fig. 5.1: one limb •");
    show(&mut harness, "Fig. 5.2");
    harness.get_by_label_contains("Only camera 1 counts");
    click(&mut harness, "Close explanation");
    assert!(harness.query_by_label_contains("Only camera 1 counts").is_none());
    show(&mut harness, "Fig. 5.3");
    // Another take: the sentences go.
    show(&mut harness, "Fig. 5.1");
    assert!(harness.query_by_label_contains("The same start as with one camera").is_none());
}
