//! Names of motions in the window.

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_recognition::Method;
use backlit_take::demonstration::Demonstration;
use egui::pos2;

use super::Plane;
use super::job::Missing;
use super::panel::plane::{Sheet, places};
use crate::app::testing::{Breaks, TestWindow, open_take};
use crate::context::command::{Command, HistoryCommand, TrackingCommand};
use crate::context::marks::{MotionMarks, NamedStretch};
use crate::context::pane::Pane;
use crate::context::preferences::Layout;

/// The demonstration, whose frames are tracked as it opens.
fn open() -> TestWindow {
    open_take(Demonstration::Motions, Layout::Pose)
}

fn marks(app: &TestWindow) -> &MotionMarks {
    &app.state.published.motions
}

fn names(app: &TestWindow) -> Vec<&str> {
    marks(app).stretches.iter().map(|stretch| &*stretch.name).collect()
}

#[test]
fn the_demonstration_opens_with_its_motions_named_and_each_frame_has_its_place() {
    let mut app = open();
    assert!(app.is_open(Pane::Motions) && !app.document().estimates.is_empty());
    assert!(app.document().estimates.values().all(|estimate| !estimate.lost));
    // What is done, and when it begins, is known of the simulation.
    let all = Arc::clone(&marks(&app).stretches);
    for (frame, name) in [(30, "walking"), (95, "sitting or bending"), (165, "gesturing"), (225, "boxing")] {
        let found = marks(&app).at(frame).unwrap();
        assert_eq!(found.name, name, "frame {frame} of {all:?}");
    }
    assert!(!marks(&app).is_stale);
    let said = marks(&app).at(30).unwrap().said();
    assert!(said.starts_with("Walking, frames 0 to ") && said.ends_with("% sure"), "{said}");

    // A click on the curve is a click on a frame.
    let found = app.features.motions.found.clone().unwrap();
    let area = egui::Rect::from_min_size(pos2(10.0, 20.0), egui::vec2(300.0, 200.0));
    for plane in [Plane::Apart, Plane::Principal] {
        let places = places(&found, plane);
        assert_eq!(places.len(), app.document().estimates.len());
        let sheet = Sheet::new(area, &places, &found.recognizer.clouds_apart());
        for place in places.iter().step_by(40) {
            let at = sheet.place(place.at);
            assert!(area.contains(at));
            let clicked = sheet.frame_at(&places, at).unwrap();
            let other = places.iter().find(|other| other.frame == clicked).unwrap();
            assert!(sheet.place(other.at).distance(at) < 1e-3, "{place:?} {clicked}");
        }
        assert_eq!(sheet.frame_at(&places, area.max + egui::vec2(100.0, 0.0)), None);
    }

    // Nothing changed: nothing is asked again. Another way to name is another question.
    let before = Arc::as_ptr(&found);
    app.settle();
    assert_eq!(Arc::as_ptr(app.features.motions.found.as_ref().unwrap()), before);
    app.features.motions.preferences.method = Method::Hmm;
    app.settle();
    assert_ne!(Arc::as_ptr(app.features.motions.found.as_ref().unwrap()), before);
    let between = marks(&app).at(135).unwrap();
    assert_eq!(between.name, "jumping", "the demonstration says so of what lies between squats and signals");
}

#[test]
fn another_track_is_named_anew_and_what_is_missing_is_said() {
    let mut app = open();
    assert!(names(&app).len() >= 2, "{:?}", names(&app));
    let whole = app.document().estimates.clone();
    let keep = |app: &mut TestWindow, frames: &dyn Fn(usize) -> bool| {
        let kept = whole.iter().filter(|(frame, _)| frames(**frame));
        let kept = kept.map(|(frame, found)| (*frame, Arc::clone(found), None)).collect();
        app.run(Command::Tracking(TrackingCommand::Clear));
        app.state.edit(Edit::AddTrack(kept), None);
    };
    keep(&mut app, &|frame| !(50..180).contains(&frame));
    app.settle();
    let found = &marks(&app).stretches;
    assert!(marks(&app).at(100).is_none(), "nobody knows what happened in a gap: {found:?}");
    assert_eq!(marks(&app).at(49).unwrap().name, "walking");
    assert!(found.iter().all(|stretch| *stretch.frames.end() < 50 || *stretch.frames.start() >= 180));

    keep(&mut app, &|frame| frame < 5);
    app.settle();
    assert!(names(&app).is_empty());
    let missing = app.features.motions.missing.as_ref().unwrap();
    assert!(matches!(missing, Missing::Short { .. }), "{missing:?}");
    assert!(super::words::missing(missing).contains("It takes 0.4 s"));

    app.does(Command::Tracking(TrackingCommand::Clear));
    assert_eq!(app.features.motions.missing, Some(Missing::Track));
    app.run(Command::History(HistoryCommand::Undo));
    app.run(Command::History(HistoryCommand::Undo));
    app.does(Command::History(HistoryCommand::Undo));
    assert!(!names(&app).is_empty(), "the track before is there again");
}

#[test]
fn a_recognition_that_breaks_down_is_said_once() {
    let mut app = open_take(Demonstration::SingleLimb, Layout::Pose);
    let document = app.document();
    let inputs = super::job::Inputs {
        body: Arc::clone(&document.model),
        estimates: Arc::clone(&document.estimates),
        frame_rate: 25.0,
        up: glam::DVec3::Z,
        model: None,
        method: Method::Combined,
    };
    assert_eq!(inputs.recognise(&Default::default()).unwrap_err(), Missing::Track);
    let lacking = super::job::Inputs { model: Some("/no such file".into()), ..inputs.clone() };
    let why = super::words::missing(&lacking.recognise(&Default::default()).unwrap_err());
    assert!(why.starts_with("The file is no model of motions: /no such file"), "{why}");
    app.break_down(|all, pool| all.features.motions.task.begin(pool, inputs, |_| Breaks));
    assert!(app.errors().len() <= 1);
}

#[test]
fn a_body_without_joints_of_the_legs_is_said_to_lack_them() {
    let mut app = open_take(Demonstration::TinySequence, Layout::Pose);
    app.does(Command::Tracking(TrackingCommand::Forward));
    assert_eq!(app.document().estimates.len(), 50);
    let missing = app.features.motions.missing.as_ref().unwrap();
    assert!(super::words::missing(missing).starts_with("This body has no “"), "{missing:?}");
}

#[test]
fn unknown_motion_is_said_to_be_unknown() {
    let stretch = NamedStretch { name: "unknown".to_owned(), class: None, frames: 3..=1200, confidence: 0.4 };
    let said = stretch.said();
    assert!(said.starts_with("Unknown, frames 3 to 1") && said.ends_with("like no motion that was learnt"));
}
