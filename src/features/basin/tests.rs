//! The basin in the window.

use crate::app::testing::{Breaks, open};
use crate::context::command::{BasinCommand, BasinView, Command};
use crate::context::preferences::Layout;

#[test]
fn a_basin_that_breaks_down_is_said_once_and_is_a_part_or_nothing() {
    let mut app = open(Layout::Pose);
    app.run(Command::Basin(BasinCommand::Run(BasinView::Angles)));
    assert!(app.features.basin.is_running());
    app.break_down(|all, pool| all.features.basin.task.begin(pool, (), |()| Breaks));
    assert!(!app.features.basin.is_running() && app.features.basin.results.angles.is_none());
    assert_eq!(app.errors(), ["The basin broke down: thirteen. Your work is unharmed."]);
}
