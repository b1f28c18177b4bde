//! Exports in the window.

use backlit_document::edit::Edit;

use super::ExportProgress;
use super::job::Exported;
use crate::app::testing::{Breaks, errors, open, settle};
use crate::context::command::{Command, ExportCommand};
use crate::context::preferences::Layout;

#[test]
fn there_is_no_motion_before_a_frame_has_a_pose() {
    let (_window, mut app) = open(Layout::Pose);
    let command = Command::Export(ExportCommand::Motion);
    assert!(
        app.inspector
            .features
            .unavailable(command, &app.inspector.context())
            .is_some_and(|why| why.contains("No frame has a pose"))
    );
    app.inspector.state.edit(Edit::SetKey { frame: 0 }, None);
    assert_eq!(app.inspector.features.unavailable(command, &app.inspector.context()), None);
}

#[test]
fn an_export_that_breaks_down_is_said_once_and_is_over() {
    let (mut window, mut app) = open(Layout::Pose);
    let pool = app.inspector.state.pool.clone();
    let export = &mut app.inspector.features.export;
    export.running =
        Some(ExportProgress { path: "a.png".into(), done: 0, total: 1, outcome: Exported::Stopped });
    export.task.begin(&pool, (), |()| Breaks);
    settle(&mut window, &mut app);
    assert_eq!(app.inspector.features.export.progress(), None);
    assert_eq!(errors(&app), ["The export broke down: thirteen. Your work is unharmed."]);
}
