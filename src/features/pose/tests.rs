//! Posing in the window.

use backlit_ui::drawing::{Drag, DragEvent, JointId};
use glam::DVec2;

use crate::app::testing::{TestWindow, open};
use crate::context::FeatureRequest;
use crate::context::command::{Command, HistoryCommand, Nudge, PoseCommand};
use crate::context::preferences::Layout;

/// A drag of the tip of the limb by some pixels of the first camera's picture.
fn drag(app: &TestWindow, by_px: DVec2) -> Drag {
    let (joint, camera) = (JointId::End(0), &app.state.session.take.as_ref().unwrap().cameras[0]);
    let tip = super::dragged::joint_position(&app.document().model, app.shown_pose(), joint);
    Drag::Joint { joint, target_px: camera.project(tip).unwrap() + by_px }
}

#[test]
fn a_drag_that_is_cancelled_leaves_nothing() {
    let mut app = open(Layout::Pose);
    let (before, undo) = (app.shown_pose().clone(), app.state.history.undo_text().map(str::to_owned));
    let drag = drag(&app, DVec2::new(12.0, 5.0));
    app.request(FeatureRequest::Drag(0, DragEvent::Begin(drag)));
    let marks = app.context().drag;
    assert_eq!((marks.dragged_joint(), marks.from.as_deref()), (Some((0, JointId::End(0))), Some(&before)));
    assert_ne!(*app.shown_pose(), before);
    app.request(FeatureRequest::Drag(0, DragEvent::Cancel));
    assert_eq!(*app.shown_pose(), before);
    assert_eq!(app.state.history.undo_text(), undo.as_deref());
    assert!(!app.context().drag.is_dragging());
    assert_eq!(app.state.status.as_deref(), Some("Put back."));
}

#[test]
fn a_modifier_on_the_way_is_still_the_same_gesture() {
    let mut app = open(Layout::Pose);
    let before = app.shown_pose().clone();
    for by in [4.0, 9.0] {
        let drag = drag(&app, DVec2::new(by, 0.0));
        app.request(FeatureRequest::Drag(0, DragEvent::Begin(drag)));
    }
    app.request(FeatureRequest::Drag(0, DragEvent::End));
    app.run(Command::History(HistoryCommand::Undo));
    assert_eq!(*app.shown_pose(), before);
}

#[test]
fn nudges_that_follow_each_other_are_undone_as_one() {
    let mut app = open(Layout::Pose);
    let before = app.shown_pose().clone();
    for _ in 0..3 {
        app.run(Command::Pose(PoseCommand::Nudge(Nudge::FarLeft)));
    }
    let said = app.state.status.clone().unwrap_or_default();
    assert!(said.contains("-15, 0 pixels in camera 1"), "{said}");
    app.run(Command::History(HistoryCommand::Undo));
    assert_eq!(*app.shown_pose(), before);
}

#[test]
fn a_reset_of_what_is_at_its_start_is_not_announced() {
    let mut app = open(Layout::Pose);
    let mut announced = || {
        app.run(Command::Pose(PoseCommand::ResetBody));
        app.state.notices.all().len()
    };
    let first = announced();
    assert_eq!(announced(), first);
}
