//! Cameras that were started apart, in the window.

use backlit_take::source::TakeSource;

use crate::app::Opening;
use crate::app::testing::{TestWindow, open, small_take};
use crate::context::command::Command;
use crate::context::preferences::Layout;

fn refused(app: &TestWindow) -> Option<&'static str> {
    app.features.unavailable(Command::Offsets, &app.context())
}

#[test]
fn what_is_no_file_has_no_offsets_to_write() {
    let app = open(Layout::Pose);
    assert!(refused(&app).is_some_and(|why| why.contains("has no take.toml")));
}

#[test]
fn a_camera_that_is_shifted_shows_another_picture_and_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let take = small_take(folder.path(), "");
    let mut app = open(Layout::Pose);
    app.open(Opening::of(&take));
    let source = app.state.session.source.clone();
    assert_eq!(source, Some(TakeSource::Path(take.clone())));
    assert_eq!(refused(&app), None);

    app.does(Command::Offsets);
    let shown = |app: &TestWindow, side: usize| app.features.offsets.sides[side].picture.clone().unwrap().1;
    let before = [shown(&app, 0), shown(&app, 1)];
    app.features.offsets.shifts[1] = 3;
    app.settle();
    assert_eq!(shown(&app, 0).pixels, before[0].pixels, "the left camera stays");
    assert_ne!(shown(&app, 1).pixels, before[1].pixels, "the right one is three frames on");
    app.features.offsets.shifts[1] = -1;
    app.settle();
    assert!(app.features.offsets.sides[1].problem.as_ref().is_some_and(|why| why.contains("no picture")));

    app.features.offsets.shifts[1] = 3;
    let count = app.state.session.frame_count();
    app.ask(|features, context, _| features.offsets.write(context));
    app.settle();
    let text = std::fs::read_to_string(take.join("take.toml")).unwrap();
    assert!(text.contains("offset = 3"), "{text}");
    assert_eq!(
        app.state.session.frame_count(),
        count - 3,
        "the take was read again: so many frames have all cameras"
    );
}
