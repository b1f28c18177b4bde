//! The Compare pane's work, without a picture.

use backlit_formats::motion::{Motion, MotionFormat, MotionOptions, write};
use backlit_runs::comparison::CameraOverlap;
use backlit_take::source::TakeSource;

use super::curves::{CurveChoice, ErrorKind};
use super::{Compare, Side};
use crate::app::testing::{TestWindow, open_source};
use crate::context::command::{Command, CompareCommand, FitCommand, HistoryCommand, WindowCommand};
use crate::context::pane::Pane;
use crate::context::preferences::Layout;

fn open() -> TestWindow {
    let mut app = open_source(TakeSource::BuiltIn, Layout::Pose);
    app.does(Command::Window(WindowCommand::TogglePane(Pane::Compare)));
    app.settle();
    app
}

fn compare(app: &TestWindow) -> &Compare {
    &app.features.compare
}

/// The take's own reference is there at once; a file that is added comes beside it, and both are compared again when a pose
/// changes.
#[test]
fn references_are_compared_and_drawn_beside_the_body() {
    let mut app = open();
    assert_eq!((compare(&app).references.len(), compare(&app).found.len()), (1, 1));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("late.trc");
    let document = app.document().clone();
    let shown = app.shown_pose().clone();
    let poses = (0..4).map(|frame| (frame, shown.clone())).collect();
    let motion = Motion::of_poses("a", (*document.model).clone(), 30.0, poses);
    write(&path, MotionFormat::Trc, &motion, &MotionOptions::default()).unwrap();
    for frame in 0..4 {
        let what = "Move".to_owned();
        let edit = backlit_document::edit::Edit::SetPose { frame, pose: shown.clone(), what };
        app.state.edit(edit, None);
    }
    app.features.compare.add(path.clone());
    // The file is read and goes into the document; then poses are compared with it.
    app.settle();
    app.settle();
    assert_eq!(compare(&app).references.len(), 2, "{:?}", app.errors());
    assert_eq!(*app.document().references, [path]);
    let found = compare(&app).found[1].clone();
    assert_eq!((found.frames.len(), compare(&app).selected), (4, 1));
    assert!(found.overall.as_ref().unwrap().raw.max < 1.0, "{:?}", found.overall);
    // The same poses cover the silhouettes alike.
    app.settle();
    let overlap = compare(&app).overlaps.measured().unwrap();
    assert_eq!((overlap.frames, overlap.cameras.len()), (4, app.document().cameras.len()));
    let differ = |camera: &CameraOverlap| (camera.track - camera.reference).abs();
    assert!(overlap.cameras.iter().all(|camera| differ(camera) < 0.1), "{overlap:?}");
    assert!(!app.state.published.references.is_empty());
    assert!(app.state.published.references.iter().all(|mark| mark.ours.distance(mark.place) < 1e-3));

    app.does(Command::Compare(CompareCommand::RemoveReferences));
    app.settle();
    assert_eq!((compare(&app).references.len(), compare(&app).found.len()), (1, 1));
    app.does(Command::History(HistoryCommand::Undo));
    app.settle();
    assert_eq!((compare(&app).references.len(), compare(&app).found.len()), (2, 2), "taken back");
    app.features.compare.side = Side::Runs;
    app.settle();
    assert!(app.state.published.references.is_empty(), "runs have no references");
    assert_eq!(compare(&app).curve, CurveChoice::Error(ErrorKind::Raw, None));
}

#[test]
fn a_file_that_is_no_recording_is_told() {
    let mut app = open();
    app.features.compare.add("nothing.trc".into());
    app.settle();
    assert!(app.errors().iter().any(|error| error.contains("nothing.trc")), "{:?}", app.errors());
    assert_eq!(compare(&app).references.len(), 1);
    assert!(app.document().references.is_empty());
}

/// One run with all cameras, and one without each.
#[test]
fn the_fit_is_run_again_without_each_camera() {
    let mut app = open();
    let cameras = app.document().used_cameras().count();
    app.does(Command::Fit(FitCommand::RunAgainWithCameras));
    app.settle();
    let runs = app.runs();
    assert_eq!(runs.len(), 1 + cameras);
    let used: Vec<usize> =
        runs.iter().map(|run| run.choices.cameras.iter().filter(|camera| camera.used).count()).collect();
    assert_eq!(used[0], cameras);
    assert!(used[1..].iter().all(|count| *count == cameras - 1), "{used:?}");
    app.does(Command::Fit(FitCommand::RunAgainWithCameras));
    app.settle();
    assert_eq!(app.runs().len(), 1 + cameras, "what has been run is not run again");
}
