//! What the cameras see, in the window.

use crate::app::testing::{Breaks, errors, open, settle};
use crate::context::command::{Command, ObservabilityCommand};
use crate::context::preferences::Layout;
use crate::session::prediction::PosedInputs;

#[test]
fn a_look_that_breaks_down_is_said_once_and_begins_again_with_another_pose() {
    let (mut window, mut app) = open(Layout::Pose);
    let inputs = app.inspector.context().fit_inputs().unwrap();
    let pose = app.inspector.context().shown_pose().clone();
    let pool = app.inspector.state.pool.clone();
    app.inspector.features.observability.task.begin(
        &pool,
        PosedInputs { inputs, pose: pose.clone() },
        |_| Breaks,
    );
    app.run(Command::Observability(ObservabilityCommand::Ellipses));
    settle(&mut window, &mut app);
    let said = ["The look at what the cameras see broke down: thirteen. Your work is unharmed."];
    assert_eq!(errors(&app), said);
    assert!(app.inspector.features.observability.found().is_none());
    let moved = backlit_document::edit::Edit::SetPose {
        frame: 0,
        pose: backlit_tracking::body::Pose { root: pose.root + glam::DVec3::X * 0.01, ..pose },
        what: "Move".to_owned(),
    };
    app.inspector.state.edit(moved, None);
    settle(&mut window, &mut app);
    assert!(
        app.inspector.features.observability.found().is_some()
            && !app.inspector.features.observability.is_stale()
    );
    assert_eq!(errors(&app), said);
}
