//! The tracker in the window.

use backlit_document::Document;
use backlit_document::edit::Edit;
use backlit_document::tracking_choices::{CueChoice, TrackedBody, TrackingChoices};
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Kinematics, Pose, Sides, builtin};
use backlit_tracking::cues::Cue;
use backlit_tracking::render::RendererKind;
use backlit_tracking::segment::SegmentOptions;

use super::keys_around;
use crate::app::testing::{Breaks, do_command, errors, open_source, open_take, settle, small_take};
use crate::context::command::{Command, FitCommand, HistoryCommand, TimelineCommand, TrackingCommand};
use crate::context::feature::Feature;
use crate::context::preferences::Layout;

#[test]
fn a_tracker_or_a_search_that_breaks_down_is_said_once_and_nothing_waits_for_it() {
    let (mut window, mut app) = open_take(Demonstration::TinySequence, Layout::Pose);
    let commands = [
        Command::Tracking(TrackingCommand::Forward),
        Command::Fit(FitCommand::SearchPoses),
        Command::Fit(FitCommand::FitBody),
    ];
    for (said, command) in commands.into_iter().enumerate() {
        app.run(command);
        let pool = app.inspector.state.pool.clone();
        assert!(app.inspector.features.tracking.sentence(&app.inspector.context()).is_some(), "{command:?}");
        app.inspector.features.tracking.task.begin(&pool, (), |()| Breaks);
        settle(&mut window, &mut app);
        assert!(
            !app.inspector.features.tracking.is_busy()
                && app.inspector.features.tracking.sentence(&app.inspector.context()).is_none()
        );
        assert_eq!(errors(&app).len(), said + 1, "{command:?}");
        assert_eq!(errors(&app)[said], "The tracker broke down: thirteen. Your work is unharmed.");
    }
}

#[test]
fn silhouettes_that_show_nobody_are_told_before_they_are_tracked() {
    let (mut window, mut app) = open_source(TakeSource::BuiltIn, Layout::Pose);
    let blind =
        SegmentOptions { z_threshold: 1e4, shadow: None, dont_know: None, ..SegmentOptions::default() };
    app.inspector.state.edit(Edit::SetMeasurement(Box::new(blind)), None);
    do_command(&mut window, &mut app, Command::Tracking(TrackingCommand::Forward));
    assert!(app.inspector.document().estimates.is_empty());
    let said = errors(&app);
    assert!(
        said.len() == 1 && said[0].starts_with("Not tracked: the silhouettes cannot be right"),
        "{said:?}"
    );
}

#[test]
fn the_persons_own_sizes_are_found_first_where_the_take_asks_for_them() {
    let folder = tempfile::tempdir().unwrap();
    let take = small_take(folder.path(), "sizes = \"fit\"");
    let (mut window, mut app) = open_source(TakeSource::Path(take), Layout::Pose);
    let mut said = |app: &mut crate::app::App| {
        app.run(Command::Tracking(TrackingCommand::Forward));
        let said = app.inspector.features.tracking.sentence(&app.inspector.context()).unwrap();
        app.inspector.features.tracking.stop();
        settle(&mut window, app);
        said
    };
    // The start is the take's.
    assert!(said(&mut app).starts_with("Finding the person’s sizes"));
    let mut tracking = app.inspector.document().tracking;
    tracking.body = TrackedBody::AsItIs;
    app.inspector.state.edit(Edit::SetTracking(tracking), None);
    let at_once = said(&mut app);
    assert!(at_once.starts_with("Tracking, "), "{at_once}");
}

#[test]
fn a_track_is_turned_round_frame_by_frame_and_taken_back_at_once() {
    let (mut window, mut app) = open_take(Demonstration::TinySequence, Layout::Pose);
    do_command(&mut window, &mut app, Command::Tracking(TrackingCommand::Forward));
    let before = app.inspector.document().clone();
    do_command(&mut window, &mut app, Command::Tracking(TrackingCommand::TurnRound));
    let after = app.inspector.document().clone();
    assert_eq!(after.estimates.len(), before.estimates.len());
    let model = &before.model;
    let ahead = |pose: &Pose| Sides::of(model, &Kinematics::new(model, pose)).unwrap().ahead;
    for (frame, found) in before.estimates.iter() {
        let turned = &after.estimates[frame].pose;
        assert!(ahead(turned).dot(ahead(&found.pose)) < -0.5, "frame {frame} still faces the same way");
    }
    do_command(&mut window, &mut app, Command::History(HistoryCommand::Undo));
    assert_eq!(app.inspector.document().estimates, before.estimates);
}

#[test]
fn keys_lie_around_a_frame() {
    let mut document = Document::new(builtin::single_limb());
    assert_eq!(keys_around(&document, 3), None);
    for frame in [2, 8, 20] {
        document.apply(Edit::SetKey { frame }).unwrap();
    }
    let around = |frame| keys_around(&document, frame);
    assert_eq!(around(1), None, "none before");
    assert_eq!((around(2), around(7)), (Some((2, 8)), Some((2, 8))));
    assert_eq!((around(8), around(20)), (Some((8, 20)), Some((8, 20))));
    assert_eq!(around(21), None, "none after");
}

/// Silhouettes lose an arm, keypoints hold it, and which held which limb is known of every frame.
#[test]
fn keypoints_hold_what_silhouettes_lose_and_that_is_said() {
    let which = Demonstration::Cues;
    let (mut window, mut app) = open_take(which, Layout::Pose);
    let mean_mm = |app: &crate::app::App| {
        let model = &app.inspector.document().model;
        let limb = |name: &str| model.limb_index(name).unwrap();
        let arms = ["left forearm", "right forearm"].map(limb);
        let off = app.inspector.document().estimates.iter().flat_map(|(frame, found)| {
            let [found, truth] =
                [&found.pose, &which.truth(*frame).unwrap()].map(|pose| Kinematics::new(model, pose));
            arms.map(|limb| 1000.0 * found.ends()[limb].distance(truth.ends()[limb]))
        });
        let off: Vec<f64> = off.collect();
        off.iter().sum::<f64>() / off.len() as f64
    };
    let frames = app.inspector.state.session.frame_count();
    assert_eq!(app.inspector.document().estimates.len(), frames, "it is tracked as it opens");
    let with_keypoints = mean_mm(&app);
    let by_keypoints = app.inspector.document().estimates.iter().filter(|(frame, found)| {
        let held = app.inspector.state.session.held(**frame, &found.pose);
        held.iter().any(|hold| !hold.by_silhouettes && hold.cues == [Cue::Keypoints])
    });
    assert!(by_keypoints.count() > frames / 4);

    let alone = TrackingChoices { cues: CueChoice::None, ..app.inspector.document().tracking };
    app.inspector.state.edit(Edit::SetTracking(alone), None);
    for command in [Command::Tracking(TrackingCommand::Clear), Command::Tracking(TrackingCommand::Forward)] {
        app.run(Command::Timeline(TimelineCommand::FirstFrame));
        do_command(&mut window, &mut app, command);
    }
    let by_silhouettes = mean_mm(&app);
    assert!(
        with_keypoints < 80.0 && by_silhouettes > 2.0 * with_keypoints,
        "{with_keypoints:.0}, {by_silhouettes:.0} mm"
    );
    let found = app.inspector.document().estimates.values().filter_map(|found| found.iou);
    assert!(found.fold(1.0, f64::min) > 0.7, "the overlap says nothing of it");
}

#[test]
fn keypoints_that_are_not_there_are_asked_for_in_words() {
    let (mut window, mut app) = open_take(Demonstration::TinySequence, Layout::Pose);
    let keypoints = TrackingChoices { cues: CueChoice::Keypoints, ..app.inspector.document().tracking };
    app.inspector.state.edit(Edit::SetTracking(keypoints), None);
    do_command(&mut window, &mut app, Command::Tracking(TrackingCommand::Forward));
    let said = errors(&app);
    assert!(said.len() == 1 && said[0].starts_with("Not tracked: the take has no keypoints"), "{said:?}");
    assert!(app.inspector.document().estimates.is_empty());
}

#[test]
fn a_body_of_spheres_fits_better_than_capsules_and_is_taken_back_at_once() {
    let (mut window, mut app) = open_take(Demonstration::Spheres, Layout::Pose);
    let iou = |app: &crate::app::App| app.inspector.state.session.iou().unwrap();
    let levels = app.inspector.document().model.spheres_by_level();
    assert!(levels.len() == 2 && levels[0] < levels[1], "{levels:?}: it is made as it opens");
    assert!(app.inspector.features.camera_views.preferences.settings.spheres, "the spheres are outlined");
    let spheres = iou(&app);
    do_command(&mut window, &mut app, Command::Fit(FitCommand::Renderer(RendererKind::Capsule)));
    let capsules = iou(&app);
    assert!(spheres > capsules + 0.02, "{spheres:.3}, {capsules:.3}");
    for _ in 0..2 {
        app.run(Command::History(HistoryCommand::Undo));
    }
    assert!(app.inspector.document().model.spheres_by_level().is_empty());
    assert_eq!(app.inspector.document().fit.renderer, RendererKind::Capsule);
}
