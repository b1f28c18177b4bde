//! What the cameras see, in the window.

use crate::app::testing::{Breaks, open};
use crate::context::command::{Command, ObservabilityCommand};
use crate::context::preferences::Layout;
use crate::session::prediction::PosedInputs;

#[test]
fn a_look_that_breaks_down_is_said_once_and_begins_again_with_another_pose() {
    let mut app = open(Layout::Pose);
    let inputs = app.context().fit_inputs().unwrap();
    let pose = app.context().shown_pose().clone();
    let posed = PosedInputs { inputs, pose: pose.clone() };
    let pool = app.state.pool.clone();
    app.features.observability.task.begin(&pool, posed, |_| Breaks);
    app.does(Command::Observability(ObservabilityCommand::Ellipses));
    let said = ["The look at what the cameras see broke down: thirteen. Your work is unharmed."];
    assert_eq!(app.errors(), said);
    assert!(app.features.observability.found().is_none());
    let moved = backlit_document::edit::Edit::SetPose {
        frame: 0,
        pose: backlit_tracking::body::Pose { root: pose.root + glam::DVec3::X * 0.01, ..pose },
        what: "Move".to_owned(),
    };
    app.state.edit(moved, None);
    app.settle();
    assert!(app.features.observability.found().is_some() && !app.features.observability.is_stale());
    assert_eq!(app.errors(), said);
}
