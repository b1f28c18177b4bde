//! The fit in the window.

use backlit_document::run::RunEnding;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;

use crate::app::Opening;
use crate::app::testing::{Breaks, open};
use crate::context::command::{Command, FitCommand, HistoryCommand};
use crate::context::preferences::Layout;

#[test]
fn a_fit_that_breaks_down_leaves_what_it_has_done_and_the_next_run_is_a_new_one() {
    let mut app = open(Layout::Pose);
    app.does(Command::Fit(FitCommand::Step));
    let steps = app.runs()[0].steps.len();
    assert!(steps > 1);
    app.run(Command::Fit(FitCommand::Run));
    app.break_down(|all, pool| all.features.fit.task.begin(pool, (), |()| Breaks));
    assert_eq!(app.errors(), ["The fit broke down: thirteen. Your work is unharmed."]);
    let run = &app.runs()[0];
    assert_eq!((run.steps.len(), run.ending_text().as_str()), (steps, "Stopped: a step broke down"));
    assert!(app.features.fit.live.is_none() && !app.features.fit.is_running());
    app.does(Command::Fit(FitCommand::Step));
    assert_eq!(app.runs().len(), 2);
    assert!(app.runs()[1].steps.len() > 1);
}

#[test]
fn a_run_that_has_ended_stays_as_it_ended() {
    let mut app = open(Layout::Pose);
    app.does(Command::Fit(FitCommand::Run));
    let ended = app.runs()[0].clone();
    assert!(matches!(ended.ending, Some(RunEnding::Solver(_))), "{:?}", ended.ending);
    for again in [FitCommand::Step, FitCommand::Run] {
        app.does(Command::Fit(again));
        assert_eq!(app.runs(), std::slice::from_ref(&ended));
        assert!(app.state.status.as_ref().unwrap().starts_with("This run has ended"));
    }
}

#[test]
fn words_about_a_command_go_with_the_next_one_and_with_the_take() {
    let mut app = open(Layout::Pose);
    app.does(Command::Fit(FitCommand::Step));
    let undo = Command::History(HistoryCommand::Undo);
    app.run(undo);
    assert!(app.state.status.as_ref().unwrap().starts_with("Undone"));
    app.does(Command::Fit(FitCommand::Step));
    assert_eq!(app.state.status, None);
    app.run(undo);
    app.open(Opening::Take(TakeSource::Demonstration(Demonstration::SingleLimb)));
    assert_eq!(app.state.status, None);
}
