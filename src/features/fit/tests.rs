//! The fit in the window.

use backlit_document::run::RunEnding;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;

use crate::app::Opening;
use crate::app::testing::{Breaks, do_command, errors, open, settle};
use crate::context::command::{Command, FitCommand, HistoryCommand};
use crate::context::preferences::Layout;

#[test]
fn a_fit_that_breaks_down_leaves_what_it_has_done_and_the_next_run_is_a_new_one() {
    let (mut window, mut app) = open(Layout::Pose);
    do_command(&mut window, &mut app, Command::Fit(FitCommand::Step));
    let steps = app.inspector.runs()[0].steps.len();
    assert!(steps > 1);
    app.run(Command::Fit(FitCommand::Run));
    let pool = app.inspector.state.pool.clone();
    app.inspector.features.fit.task.begin(&pool, (), |()| Breaks);
    settle(&mut window, &mut app);
    assert_eq!(errors(&app), ["The fit broke down: thirteen. Your work is unharmed."]);
    let run = &app.inspector.runs()[0];
    assert_eq!((run.steps.len(), run.ending_text().as_str()), (steps, "Stopped: a step broke down"));
    assert!(app.inspector.features.fit.live.is_none() && !app.inspector.features.fit.is_running());
    do_command(&mut window, &mut app, Command::Fit(FitCommand::Step));
    assert_eq!(app.inspector.runs().len(), 2);
    assert!(app.inspector.runs()[1].steps.len() > 1);
}

#[test]
fn a_run_that_has_ended_stays_as_it_ended() {
    let (mut window, mut app) = open(Layout::Pose);
    do_command(&mut window, &mut app, Command::Fit(FitCommand::Run));
    let ended = app.inspector.runs()[0].clone();
    assert!(matches!(ended.ending, Some(RunEnding::Solver(_))), "{:?}", ended.ending);
    for again in [FitCommand::Step, FitCommand::Run] {
        do_command(&mut window, &mut app, Command::Fit(again));
        assert_eq!(app.inspector.runs(), std::slice::from_ref(&ended));
        assert!(app.inspector.state.status.as_ref().unwrap().starts_with("This run has ended"));
    }
}

#[test]
fn words_about_a_command_go_with_the_next_one_and_with_the_take() {
    let (mut window, mut app) = open(Layout::Pose);
    do_command(&mut window, &mut app, Command::Fit(FitCommand::Step));
    let undo = Command::History(HistoryCommand::Undo);
    app.run(undo);
    assert!(app.inspector.state.status.as_ref().unwrap().starts_with("Undone"));
    do_command(&mut window, &mut app, Command::Fit(FitCommand::Step));
    assert_eq!(app.inspector.state.status, None);
    app.run(undo);
    app.open(Opening::Take(TakeSource::Demonstration(Demonstration::SingleLimb)));
    settle(&mut window, &mut app);
    assert_eq!(app.inspector.state.status, None);
}
