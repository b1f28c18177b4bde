//! The copy of unsaved work in the window.

use backlit_document::history::Version;

use crate::app::testing::{Breaks, errors, open, settle};
use crate::context::preferences::Layout;

#[test]
fn a_copy_that_breaks_down_is_said_once() {
    let (mut window, mut app) = open(Layout::Pose);
    let pool = app.inspector.state.pool.clone();
    app.inspector.features.recovery.task.begin(&pool, Version::NONE, |_| Breaks);
    settle(&mut window, &mut app);
    assert_eq!(errors(&app), ["Writing a file broke down: thirteen. Your work is unharmed."]);
}
