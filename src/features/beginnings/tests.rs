//! Ways to begin in the window.

use backlit_document::edit::Edit;
use backlit_take::demonstration::Demonstration;

use super::record::MOST_BODIES;
use super::{AttemptIndex, Beginnings, COMPARED, Method};
use crate::app::testing::{Breaks, TestWindow, open_take};
use crate::context::SessionRequest;
use crate::context::command::{BeginningCommand, Command, HistoryCommand};
use crate::context::pane::Pane;
use crate::context::preferences::Layout;

/// The demonstration with all ways tried.
fn tried() -> TestWindow {
    open_take(Demonstration::Begin, Layout::Pose)
}

fn run(app: &mut TestWindow, command: BeginningCommand) {
    app.does(Command::Beginning(command));
}

fn ways(app: &TestWindow) -> &Beginnings {
    &app.features.beginnings
}

fn outcome(app: &TestWindow, method: Method) -> &super::Outcome {
    ways(app).ended[&method].as_ref().unwrap()
}

fn look_at(app: &mut TestWindow, method: Method, step: usize) {
    app.features.beginnings.look_at(AttemptIndex { method, step });
    app.settle();
}

#[test]
fn the_demonstration_tries_all_ways_of_which_particles_and_search_are_home() {
    let app = tried();
    assert!(app.is_open(Pane::Beginnings) && app.errors().is_empty());
    let error = |method| outcome(&app, method).error_mm.unwrap();
    for method in [Method::Particles, Method::Search] {
        assert!(error(method) < 20.0, "{method:?}: {} mm", error(method));
    }
    for method in [Method::Ramp, Method::Report] {
        assert!(error(method) > 100.0, "{method:?}: {} mm", error(method));
    }
    assert!(outcome(&app, Method::Search).cost < 0.1 * outcome(&app, Method::Ramp).cost);
    assert!(outcome(&app, Method::Particles).evaluations > outcome(&app, Method::Search).evaluations);
    assert!(outcome(&app, Method::Search).iou.unwrap() > 0.95);
    // The first that was tried is looked at, in views and scene too.
    assert_eq!(ways(&app).at, Some(AttemptIndex { method: Method::Particles, step: 0 }));
    let ghosts = app.context().ghosts.unwrap();
    assert!(ghosts.placed.contains(&false), "only the trunk has a place");
}

#[test]
fn particles_are_drawn_by_their_weights_and_the_same_each_time() {
    let mut app = tried();
    let poses = |app: &TestWindow| -> Vec<_> {
        let steps = outcome(app, Method::Particles).steps.iter();
        steps.map(|step| (step.pose().clone(), step.words.clone())).collect()
    };
    let first = poses(&app);
    for step in &outcome(&app, Method::Particles).steps {
        let weights: Vec<f64> = step.bodies.iter().map(|body| body.1).collect();
        assert!(weights.is_sorted_by(|a, b| a >= b) && weights.len() <= MOST_BODIES, "{}", step.words);
        let all: f64 = weights.iter().sum();
        assert!(all > 0.5 && all < 1.0 + 1e-9, "{}: {all}", step.words);
    }
    run(&mut app, BeginningCommand::RunAll);
    assert_eq!(poses(&app), first);
}

#[test]
fn templates_have_their_limbs_one_after_the_other() {
    let mut app = tried();
    let steps = &outcome(&app, Method::Templates).steps;
    let placed: Vec<usize> = steps.iter().map(|step| step.ghosts().limbs().count()).collect();
    assert!(placed.is_sorted() && placed[0] < 3 && placed.last() == Some(&12), "{placed:?}");
    assert!(steps[0].words.starts_with("Head"), "{}", steps[0].words);
    let turning = steps.iter().position(|step| step.words.starts_with("Left upper arm turns")).unwrap();
    look_at(&mut app, Method::Templates, turning);
    let ghosts = app.context().ghosts.unwrap();
    let name = |limb: usize| ghosts.model.limbs()[limb].name.as_str();
    let marked: Vec<&str> = (0..12).filter(|&limb| ghosts.marked[limb]).map(name).collect();
    assert_eq!(marked, ["left upper arm"]);
    assert!(ghosts.template.is_some());
}

#[test]
fn steps_are_played_in_order_to_the_last() {
    let mut app = tried();
    look_at(&mut app, Method::Search, 0);
    let last = ways(&app).last_step().unwrap();
    let now = app.state.now;
    app.features.beginnings.toggle_play(now);
    let mut seen = vec![0];
    while ways(&app).plays.is_some() {
        app.frames(1);
        let step = ways(&app).at.unwrap().step;
        if seen.last() != Some(&step) {
            seen.push(step);
        }
        assert!(seen.len() <= last + 1, "{seen:?}");
    }
    assert_eq!(seen, (0..=last).collect::<Vec<_>>());
    // Again from the first.
    let now = app.state.now;
    app.features.beginnings.toggle_play(now);
    assert_eq!(ways(&app).at.unwrap().step, 0);
}

#[test]
fn a_pose_that_is_taken_is_the_frames_and_undone_as_one() {
    let mut app = tried();
    let before = app.document().clone();
    let last = outcome(&app, Method::Search).steps.len() - 1;
    look_at(&mut app, Method::Search, last);
    let pose = outcome(&app, Method::Search).steps[last].pose().clone();
    app.ask(|features, context, requests| features.beginnings.take(context, requests));
    app.settle();
    assert!(app.context().ghosts.is_none(), "the pose is seen");
    assert!(app.shown_pose().local(&pose).iter().all(|step| step.abs() < 1e-12));
    let mut expected = before.clone();
    expected.apply(Edit::SetPose { frame: 0, pose, what: String::new() }).unwrap();
    assert_eq!(*app.document(), expected, "nothing but the frame's pose");
    app.run(Command::History(HistoryCommand::Undo));
    assert_eq!(*app.document(), before);
    assert_eq!(ways(&app).ended.len(), COMPARED.len(), "the table stays");
}

#[test]
fn a_body_is_acquired_and_taken_as_one() {
    let mut app = tried();
    let before = app.document().clone();
    run(&mut app, BeginningCommand::AcquireBody);
    assert_eq!(ways(&app).ended.len(), 1 + COMPARED.len(), "the others stay");
    let found = outcome(&app, Method::Body);
    assert!(found.iou.unwrap() > 0.9 && found.steps.len() > 10, "{:?}", found.iou);
    let forearm =
        found.steps.iter().position(|step| step.words.starts_with("Right and left forearm")).unwrap();
    let (was, is) = (&found.steps[forearm - 1], &found.steps[forearm]);
    let limb = is.model.limb_index("left forearm").unwrap();
    assert!(is.marked[limb] && is.pose() == was.pose());
    for (index, (one, other)) in was.model.limbs().iter().zip(is.model.limbs()).enumerate() {
        let is_same = (one.length, one.radius) == (other.length, other.radius);
        assert!(is_same || is.marked[index], "{}", one.name);
    }
    let last = found.steps.len() - 1;
    let body = found.steps[last].model.clone();
    look_at(&mut app, Method::Body, last);
    app.ask(|features, context, requests| features.beginnings.take(context, requests));
    app.settle();
    assert_eq!(app.document().model.limbs(), body.limbs());
    assert!(ways(&app).ended.is_empty(), "they were of another body");
    app.run(Command::History(HistoryCommand::Undo));
    assert_eq!(*app.document(), before);
}

#[test]
fn without_a_start_the_start_plays_no_part_and_other_runs_are_gone() {
    let mut app = tried();
    app.features.beginnings.no_start = true;
    let begin = |app: &mut TestWindow| {
        app.ask(|features, context, requests| {
            features.beginnings.begin(&[Method::Search], context, requests);
        });
        app.settle();
        let steps = &outcome(app, Method::Search).steps;
        (steps.len(), steps.last().unwrap().pose().clone())
    };
    let first = begin(&mut app);
    assert_eq!(ways(&app).ended.len(), 1, "those from the start are gone");
    assert_eq!(first.0, 4, "the rounds");
    let mut pose = app.shown_pose().clone();
    pose.root.x += 1.0;
    app.state.edit(Edit::SetPose { frame: 0, pose, what: String::new() }, None);
    assert_eq!(begin(&mut app), first);
}

#[test]
fn another_frame_or_set_of_cameras_clears_it_and_esc_shows_the_pose() {
    let mut app = tried();
    assert!(app.context().ghosts.is_some());
    app.does(Command::Fit(crate::context::command::FitCommand::Stop));
    assert!(app.context().ghosts.is_none() && !ways(&app).ended.is_empty());
    app.state.edit(Edit::UseCamera { camera: 1, used: false }, None);
    app.settle();
    assert!(ways(&app).ended.is_empty() && ways(&app).about.is_none());

    let mut app = open_take(Demonstration::Sequence, Layout::Pose);
    run(&mut app, BeginningCommand::RunAll);
    assert_eq!(ways(&app).ended.len(), COMPARED.len());
    app.request(SessionRequest::Frame(3));
    app.settle();
    assert!(ways(&app).ended.is_empty() && app.context().ghosts.is_none());
}

#[test]
fn a_body_without_a_head_is_said_to_lead_nowhere() {
    let mut app = open_take(Demonstration::SingleLimb, Layout::Pose);
    run(&mut app, BeginningCommand::RunAll);
    let nowhere = ways(&app).ended[&Method::Templates].as_ref().unwrap_err();
    assert!(nowhere.contains("trunk with a head"), "{nowhere}");
    assert!(app.errors().is_empty(), "it stands in its row");

    app.break_down(|all, pool| all.features.beginnings.task.begin(pool, (), |()| Breaks));
    assert!(!ways(&app).is_running());
    assert_eq!(app.errors(), ["A way to begin broke down: thirteen. Your work is unharmed."]);
}
