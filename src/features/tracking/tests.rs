//! The tracker in the window.

use crate::app::testing::{Breaks, errors, open, settle};
use crate::context::command::{Command, FitCommand, TrackingCommand};
use crate::context::preferences::Layout;

#[test]
fn a_tracker_or_a_search_that_breaks_down_is_said_once_and_nothing_waits_for_it() {
    let (mut window, mut app) = open(Layout::Pose);
    let commands = [
        Command::Tracking(TrackingCommand::Forward),
        Command::Fit(FitCommand::SearchPoses),
        Command::Fit(FitCommand::FitBody),
    ];
    for (said, command) in commands.into_iter().enumerate() {
        app.run(command, &window.ctx.clone());
        let pool = app.state.pool.clone();
        assert!(app.features.tracking.sentence().is_some(), "{command:?}");
        app.features.tracking.task.begin(&pool, (), |()| Breaks);
        settle(&mut window, &mut app);
        assert!(!app.features.tracking.is_busy() && app.features.tracking.sentence().is_none());
        assert_eq!(errors(&app).len(), said + 1, "{command:?}");
        assert_eq!(errors(&app)[said], "The tracker broke down: thirteen. Your work is unharmed.");
    }
}
