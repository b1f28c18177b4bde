//! The refinement of cameras, in the window.

use backlit_document::edit::Edit;
use backlit_take::source::TakeSource;

use crate::app::testing::{TestWindow, open_source};
use crate::context::command::Command;
use crate::context::preferences::Layout;

/// The built-in take.
fn open() -> TestWindow {
    open_source(TakeSource::BuiltIn, Layout::Pose)
}

fn refine(app: &mut TestWindow) {
    app.features.camera_refinement.work.want();
    app.settle();
}

#[test]
fn a_refinement_that_is_stopped_says_nothing_and_one_camera_is_refused() {
    let mut app = open();
    app.features.camera_refinement.work.want();
    app.frames(1);
    assert!(app.features.camera_refinement.work.is_busy());
    app.features.camera_refinement.work.stop();
    app.settle();
    assert!(app.features.camera_refinement.work.outcome().is_none());
    let why = |app: &TestWindow| app.features.unavailable(Command::CameraRefinement, &app.context());
    assert_eq!(why(&app), None);
    app.state.edit(Edit::UseOnly { cameras: vec![0] }, None);
    app.settle();
    assert!(why(&app).unwrap().contains("two or more"));
}

#[test]
fn what_cannot_be_refined_is_told() {
    let mut app = open();
    let last = app.state.session.frame_count() - 1;
    app.state.selection.frame = last;
    refine(&mut app);
    assert_eq!(app.features.camera_refinement.work.progress(), None);
    let why = app.features.camera_refinement.work.outcome().unwrap().as_ref().unwrap_err();
    assert!(why.contains("frames can be used, expected"), "{why}");
}
