//! The plan of cameras, in the window.

use backlit_take::source::TakeSource;

use crate::app::testing::{Breaks, open, open_source};
use crate::context::command::Command;
use crate::context::preferences::Layout;

#[test]
fn a_plan_that_breaks_down_is_said_once() {
    let mut app = open(Layout::Pose);
    app.break_down(|inspector, pool| inspector.features.camera_plan.work.begin(pool, Breaks));
    assert_eq!(app.errors(), ["The plan of cameras broke down: thirteen. Your work is unharmed."]);
    assert!(app.features.camera_plan.work.outcome().is_none());
}

#[test]
fn a_plan_is_made_once_and_stopping_it_leaves_none() {
    let mut app = open_source(TakeSource::BuiltIn, Layout::Pose);
    app.run(Command::CameraPlan);
    app.frames(2);
    app.features.camera_plan.work.stop();
    app.settle();
    assert!(app.features.camera_plan.work.outcome().is_none(), "stopped");

    app.does(Command::CameraPlan);
    let found = app.features.camera_plan.work.result().unwrap();
    assert_eq!((found.sets.len(), found.additions.len()), (15, 24));
    assert!(found.additions[0].mean_m() < found.whole().unwrap().mean_m());
    // The cells lie on the scene's floor, where the person stands.
    let cells = found.subject.area.cells.map(|count| count as u32);
    let floor = app.state.published.floor_picture.clone().unwrap();
    assert_eq!([floor.image.width(), floor.image.height()], cells);
    let middle = floor.corner + 0.5 * (floor.across + floor.down);
    assert!(middle.truncate().distance(app.document().start.root.truncate()) < 1.5, "{middle}");
    app.features.camera_plan.is_off_floor = true;
    app.frames(1);
    assert!(app.state.published.floor_picture.is_none());
    app.run(Command::CameraPlan);
    app.frames(1);
    assert!(!app.features.camera_plan.work.is_busy(), "what is there is shown again");
}
