//! The check of cameras, in the window.

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_formats::footage::replacement::Calibration;
use backlit_runs::camera_check::{FindingWords, repaired};
use backlit_take::source::TakeSource;
use backlit_tracking::camera::{Camera, Intrinsics, Rig};
use backlit_tracking::diagnosis::{FaultKind, Finding};

use super::look_at;
use crate::app::testing::{TestWindow, open_source};
use crate::context::command::{Command, HistoryCommand};
use crate::context::preferences::Layout;

/// The camera that is made wrong.
const WRONG: usize = 2;

fn focal_length(rig: &Rig) -> f64 {
    rig.cameras()[WRONG].intrinsics().fx
}

/// The built-in take.
fn open() -> TestWindow {
    open_source(TakeSource::BuiltIn, Layout::Pose)
}

/// The same with a focal length that is wrong by a twentieth.
fn disturbed() -> TestWindow {
    let mut app = open();
    let mut cameras = app.state.session.take.as_ref().unwrap().original().full_rig().cameras().to_vec();
    let camera = &cameras[WRONG];
    let [width, height] = [camera.width() as u64, camera.height() as u64];
    let right = *camera.intrinsics();
    let wrong = Intrinsics { fx: 1.05 * right.fx, fy: 1.05 * right.fy, ..right };
    let (lens, place) = (*camera.distortion(), *camera.camera_from_world());
    cameras[WRONG] = Camera::new(camera.name(), [width, height], wrong, lens, place).unwrap();
    let calibration = Calibration { path: "wrong.json".into(), rig: Rig::new(cameras).unwrap() };
    app.state.edit(Edit::SetCalibration(Some(Arc::new(calibration))), None);
    app.settle();
    app
}

fn findings(app: &TestWindow) -> Vec<Finding> {
    app.features.camera_check.work.result().unwrap().diagnosis.findings.clone()
}

#[test]
fn nothing_is_wrong_with_the_cameras_of_the_built_in_take() {
    let mut app = open();
    app.does(Command::CameraCheck);
    assert_eq!(findings(&app), []);
}

#[test]
fn the_cameras_in_use_are_checked_and_their_repair_is_one_change() {
    let mut app = disturbed();
    app.does(Command::CameraCheck);
    let found = findings(&app);
    let kinds: Vec<_> = found.iter().map(|finding| (finding.camera, finding.kind)).collect();
    assert_eq!(kinds, [(Some(WRONG), FaultKind::Focal)]);
    let before = app.document().calibration.clone();

    app.ask(|features, context, requests| features.camera_check.use_repaired(&found, context, requests));
    app.settle();
    let right = focal_length(app.state.session.take.as_ref().unwrap().original().full_rig());
    let repaired = app.document().calibration.clone().unwrap();
    assert!((focal_length(&repaired.rig) / right - 1.0).abs() < 0.01);
    let check = &app.features.camera_check;
    assert!(!check.work.is_current(&app.context()), "what was found is about other cameras");
    let what = check.repaired_now(&app.context());
    assert_eq!(what, Some("cam3 has a wrong focal length"));

    app.does(Command::CameraCheck);
    assert_eq!(findings(&app), [], "opened again, it checks the cameras that are in use now");
    app.does(Command::History(HistoryCommand::Undo));
    assert_eq!(app.document().calibration, before, "one step back");
    assert_eq!(app.features.camera_check.repaired_now(&app.context()), None);
}

#[test]
fn a_check_that_is_stopped_says_nothing_and_can_be_done_again() {
    let mut app = open();
    app.run(Command::CameraCheck);
    app.frames(1);
    assert!(app.features.camera_check.work.is_busy());
    app.features.camera_check.work.stop();
    app.settle();
    assert!(app.features.camera_check.work.outcome().is_none());
    app.does(Command::CameraCheck);
    assert!(app.features.camera_check.work.outcome().is_some());
}

#[test]
fn a_camera_that_was_moved_is_looked_at_from_then_on_and_no_other_cameras_repair_it() {
    let mut app = disturbed();
    app.does(Command::CameraCheck);
    let found = findings(&app).remove(0);
    let moved = Finding { kind: FaultKind::Bumped, since_s: Some(0.5), ..found };
    app.ask(|_, context, requests| look_at(&moved, context, requests));
    app.settle();
    let selection = app.state.selection;
    assert_eq!((selection.camera, selection.frame), (WRONG, 15), "half a second at 30 frames a second");
    let take = app.state.session.take.clone().unwrap();
    assert_eq!(repaired(take.take(), &moved), None);
    let words = FindingWords::of(&moved, take.take().rig().cameras());
    assert_eq!(words.what, "cam3 was moved while it filmed");
    assert!(words.sizes.ends_with("since 0.50 s"), "{words:?}");
    assert_eq!(words.advice, Some("leave it out from then on, or calibrate it again"));
}
