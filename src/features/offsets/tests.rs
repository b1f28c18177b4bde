//! Cameras that were started apart, in the window.

use backlit_take::source::TakeSource;

use crate::app::App;
use crate::app::testing::{open, settle, small_take};
use crate::context::command::Command;
use crate::context::preferences::Layout;

fn refused(app: &App) -> Option<&'static str> {
    app.unavailable(Command::Offsets)
}

#[test]
fn what_is_no_file_has_no_offsets_to_write() {
    let (_window, app) = open(Layout::Pose);
    assert!(refused(&app).is_some_and(|why| why.contains("comes with the program")));
}

#[test]
fn a_camera_that_is_shifted_shows_another_picture_and_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let take = small_take(folder.path(), "");
    let (mut window, mut app) = open(Layout::Pose);
    app.open_path(&take);
    settle(&mut window, &mut app);
    let source = app.session().take.as_ref().and_then(|take| take.source.clone());
    assert_eq!(source, Some(TakeSource::Path(take.clone())));
    assert_eq!(refused(&app), None);

    let ctx = window.ctx.clone();
    app.run(Command::Offsets, &ctx);
    settle(&mut window, &mut app);
    let shown = |app: &App, side: usize| app.features.offsets.sides[side].picture.clone().unwrap().1;
    let before = [shown(&app, 0), shown(&app, 1)];
    app.features.offsets.shifts[1] = 3;
    settle(&mut window, &mut app);
    assert_eq!(shown(&app, 0).pixels, before[0].pixels, "the left camera stays");
    assert_ne!(shown(&app, 1).pixels, before[1].pixels, "the right one is three frames on");
    app.features.offsets.shifts[1] = -1;
    settle(&mut window, &mut app);
    assert!(app.features.offsets.sides[1].problem.as_ref().is_some_and(|why| why.contains("no picture")));

    app.features.offsets.shifts[1] = 3;
    let count = app.session().frame_count();
    app.with(|all| &mut all.offsets, |offsets, context, _| offsets.write(context));
    settle(&mut window, &mut app);
    let text = std::fs::read_to_string(take.join("take.toml")).unwrap();
    assert!(text.contains("offset = 3"), "{text}");
    assert_eq!(
        app.session().frame_count(),
        count - 3,
        "the take was read again: so many frames have all cameras"
    );
}
