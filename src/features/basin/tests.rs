//! The basin in the window.

use crate::app::testing::{Breaks, errors, open, settle};
use crate::context::command::{BasinCommand, BasinView, Command};
use crate::context::preferences::Layout;

#[test]
fn a_basin_that_breaks_down_is_said_once_and_is_a_part_or_nothing() {
    let (mut window, mut app) = open(Layout::Pose);
    app.run(Command::Basin(BasinCommand::Run(BasinView::Angles)));
    let pool = app.inspector.state.pool.clone();
    assert!(app.inspector.features.basin.is_running());
    app.inspector.features.basin.task.begin(&pool, (), |()| Breaks);
    settle(&mut window, &mut app);
    assert!(
        !app.inspector.features.basin.is_running() && app.inspector.features.basin.results.angles.is_none()
    );
    assert_eq!(errors(&app), ["The basin broke down: thirteen. Your work is unharmed."]);
}
