//! The fit in the window.

use crate::app::testing::{Breaks, errors, open, settle};
use crate::context::command::{Command, FitCommand};
use crate::context::preferences::Layout;

#[test]
fn a_fit_that_breaks_down_leaves_what_it_has_done_and_the_next_run_is_a_new_one() {
    let (mut window, mut app) = open(Layout::Pose);
    let context = window.ctx.clone();
    app.run(Command::Fit(FitCommand::Step), &context);
    settle(&mut window, &mut app);
    let steps = app.runs()[0].steps.len();
    assert!(steps > 1);
    app.run(Command::Fit(FitCommand::Run), &context);
    let pool = app.state.pool.clone();
    app.features.fit.task.begin(&pool, (), |()| Breaks);
    settle(&mut window, &mut app);
    assert_eq!(errors(&app), ["The fit broke down: thirteen. Your work is unharmed."]);
    let run = &app.runs()[0];
    assert_eq!((run.steps.len(), run.ending_text().as_str()), (steps, "Stopped: a step broke down"));
    assert!(app.features.fit.live.is_none() && !app.features.fit.is_running());
    app.run(Command::Fit(FitCommand::Step), &context);
    settle(&mut window, &mut app);
    assert_eq!(app.runs().len(), 2);
    assert!(app.runs()[1].steps.len() > 1);
}
