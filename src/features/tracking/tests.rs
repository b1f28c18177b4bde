//! The tracker in the window.

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_document::frame_trust::FrameTrust;
use backlit_document::tracking_choices::{CueChoice, TrackPrior, TrackedBody, TrackingChoices};
use backlit_document::{Document, likely_poses};
use backlit_formats::export::TrackExport;
use backlit_formats::motion::Motion;
use backlit_runs::track::{TakeReader, TrackEnding, TrackMessage, TrackPlan, TrackRun};
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_tracking::body::{Kinematics, Pose, Sides, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::cues::Cue;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::render::RendererKind;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::{Mode, Track};

use super::keys_around;
use crate::app::testing::{Breaks, TestWindow, open_source, open_take, small_take};
use crate::context::command::{
    Command, FitCommand, HistoryCommand, TimelineCommand, TrackingCommand, ViewCommand,
};
use crate::context::feature::Feature;
use crate::context::preferences::Layout;

#[test]
fn a_tracker_or_a_search_that_breaks_down_is_said_once_and_nothing_waits_for_it() {
    let mut app = open_take(Demonstration::TinySequence, Layout::Pose);
    let commands = [
        Command::Tracking(TrackingCommand::Forward),
        Command::Fit(FitCommand::SearchPoses),
        Command::Fit(FitCommand::FitBody),
    ];
    for (said, command) in commands.into_iter().enumerate() {
        app.run(command);
        assert!(app.features.tracking.sentence(&app.context()).is_some(), "{command:?}");
        app.break_down(|all, pool| all.features.tracking.task.begin(pool, (), |()| Breaks));
        assert!(!app.features.tracking.is_busy() && app.features.tracking.sentence(&app.context()).is_none());
        assert_eq!(app.errors().len(), said + 1, "{command:?}");
        assert_eq!(app.errors()[said], "The tracker broke down: thirteen. Your work is unharmed.");
    }
}

#[test]
fn silhouettes_that_show_nobody_are_told_before_they_are_tracked() {
    let mut app = open_source(TakeSource::BuiltIn, Layout::Pose);
    let blind =
        SegmentOptions { z_threshold: 1e4, shadow: None, dont_know: None, ..SegmentOptions::default() };
    app.state.edit(Edit::SetMeasurement(Box::new(blind)), None);
    app.does(Command::Tracking(TrackingCommand::Forward));
    assert!(app.document().estimates.is_empty());
    let said = app.errors();
    assert!(
        said.len() == 1 && said[0].starts_with("Not tracked: the silhouettes cannot be right"),
        "{said:?}"
    );
}

#[test]
fn the_persons_own_sizes_are_found_first_where_the_take_asks_for_them() {
    let folder = tempfile::tempdir().unwrap();
    let take = small_take(folder.path(), "sizes = \"fit\"");
    let mut app = open_source(TakeSource::Path(take), Layout::Pose);
    let said = |app: &mut TestWindow| {
        app.run(Command::Tracking(TrackingCommand::Forward));
        let said = app.features.tracking.sentence(&app.context()).unwrap();
        app.features.tracking.stop();
        app.settle();
        said
    };
    // The start is the take's.
    assert!(said(&mut app).starts_with("Finding the person’s sizes"));
    let mut tracking = app.document().tracking;
    tracking.body = TrackedBody::AsItIs;
    app.state.edit(Edit::SetTracking(tracking), None);
    let at_once = said(&mut app);
    assert!(at_once.starts_with("Tracking, "), "{at_once}");
}

#[test]
fn a_track_is_turned_round_frame_by_frame_and_taken_back_at_once() {
    let mut app = open_take(Demonstration::TinySequence, Layout::Pose);
    app.does(Command::Tracking(TrackingCommand::Forward));
    let before = app.document().clone();
    app.does(Command::Tracking(TrackingCommand::TurnRound));
    let after = app.document().clone();
    assert_eq!(after.estimates.len(), before.estimates.len());
    let model = &before.model;
    let ahead = |pose: &Pose| Sides::of(model, &Kinematics::new(model, pose)).unwrap().ahead;
    for (frame, found) in before.estimates.iter() {
        let turned = &after.estimates[frame].pose;
        assert!(ahead(turned).dot(ahead(&found.pose)) < -0.5, "frame {frame} still faces the same way");
    }
    app.does(Command::History(HistoryCommand::Undo));
    assert_eq!(app.document().estimates, before.estimates);
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
    let mut app = open_take(which, Layout::Pose);
    let mean_mm = |app: &TestWindow| {
        let model = &app.document().model;
        let limb = |name: &str| model.limb_index(name).unwrap();
        let arms = ["left forearm", "right forearm"].map(limb);
        let off = app.document().estimates.iter().flat_map(|(frame, found)| {
            let [found, truth] =
                [&found.pose, &which.truth(*frame).unwrap()].map(|pose| Kinematics::new(model, pose));
            arms.map(|limb| 1000.0 * found.ends()[limb].distance(truth.ends()[limb]))
        });
        let off: Vec<f64> = off.collect();
        off.iter().sum::<f64>() / off.len() as f64
    };
    let frames = app.state.session.frame_count();
    assert_eq!(app.document().estimates.len(), frames, "it is tracked as it opens");
    let with_keypoints = mean_mm(&app);
    let by_keypoints = app.document().estimates.iter().filter(|(frame, found)| {
        let held = &app.document().trust_of(**frame, &found.pose).unwrap().holds;
        held.iter().any(|hold| !hold.by_silhouettes && hold.cues == [Cue::Keypoints])
    });
    assert!(by_keypoints.count() > frames / 4);

    let alone = TrackingChoices { cues: CueChoice::None, ..app.document().tracking };
    app.state.edit(Edit::SetTracking(alone), None);
    for command in [Command::Tracking(TrackingCommand::Clear), Command::Tracking(TrackingCommand::Forward)] {
        app.run(Command::Timeline(TimelineCommand::FirstFrame));
        app.does(command);
    }
    let by_silhouettes = mean_mm(&app);
    assert!(
        with_keypoints < 80.0 && by_silhouettes > 2.0 * with_keypoints,
        "{with_keypoints:.0}, {by_silhouettes:.0} mm"
    );
    let doubted = app.document().estimates.iter().filter(|(frame, found)| {
        let trust = app.document().trust_of(**frame, &found.pose).unwrap();
        trust.holds.is_empty() && !trust.doubts().is_empty()
    });
    assert!(doubted.count() > frames / 4, "the arms are lost, and that is told without cues too");
    let found = app.document().estimates.values().filter_map(|found| found.iou);
    assert!(found.fold(1.0, f64::min) > 0.7, "the overlap says nothing of it");
}

/// As `backlit track` has it: Robust has the prior of likely poses, the report has none.
#[test]
fn the_robust_preset_tracks_with_likely_poses() {
    let mut app = open_source(TakeSource::BuiltIn, Layout::Pose);
    assert_eq!(app.document().tracking.prior, TrackPrior::People);
    let last = |app: &mut TestWindow, prior: TrackPrior| {
        let choices = TrackingChoices { prior, ..app.document().tracking };
        app.state.edit(Edit::SetTracking(choices), None);
        app.does(Command::Tracking(TrackingCommand::Clear));
        let frames = app.state.session.frame_count();
        app.state.go_to_frame(frames - 2);
        app.does(Command::Tracking(TrackingCommand::Forward));
        app.document().estimates.last_key_value().map(|(_, found)| found.pose.clone())
    };
    assert_ne!(last(&mut app, TrackPrior::People), last(&mut app, TrackPrior::None));
    app.does(Command::Fit(FitCommand::Preset(Preset::Report)));
    assert_eq!(app.document().tracking.prior, TrackPrior::None);
}

/// A pose that the tracker carried beside its own is seen, taken as a key pose, and taken back with one key; what was carried stays to
/// be chosen from.
#[test]
fn a_rival_pose_is_taken_and_taken_back() {
    let mut app = open_take(Demonstration::TinySequence, Layout::Pose);
    app.does(Command::Tracking(TrackingCommand::Forward));
    let frame = app.state.selection.frame;
    let tracked = app.document().pose_at(frame).clone();
    let (mut pose, model) = (tracked.clone(), app.document().model.clone());
    let rotation = model.limbs()[model.limb_index("right upper arm").unwrap()].rotation;
    // A pose that is set is normalised.
    pose.rotations[rotation] = glam::DQuat::from_rotation_x(1.0) * pose.rotations[rotation] * (1.0 + 1e-9);
    let rivals = vec![Mode { pose: pose.clone(), weight: 0.3, covariances: Vec::new() }];
    let found = app.document().estimates[&frame].clone();
    let trust = FrameTrust::new(&model, tracked.clone(), Vec::new(), Vec::new(), rivals);
    app.state.edit(Edit::AddTrack(vec![(frame, found, Some(Arc::new(trust)))]), None);
    app.settle();
    assert_eq!(app.context().rivals(), [(&pose, 0.3)]);
    let edit = Edit::SetPose { frame, pose: pose.clone(), what: "Take rival pose".to_owned() };
    app.state.edit(edit, None);
    app.settle();
    assert!(app.document().keys.contains_key(&frame));
    assert_eq!(app.context().rivals(), [(&tracked, 0.7)]);
    app.does(Command::History(HistoryCommand::Undo));
    assert_eq!(*app.document().pose_at(frame), tracked);
    app.does(Command::View(ViewCommand::Rivals));
    assert!(app.context().rivals().is_empty());
}

/// The command line's export of a track and the window's are the same to the bit. Nobody tells how far a pose that was set by hand
/// is off.
#[test]
fn a_track_is_exported_with_what_was_told_of_it() {
    let mut app = open_source(TakeSource::BuiltIn, Layout::Pose);
    let first = app.state.session.frame_count() - 4;
    app.state.go_to_frame(first);
    let start = app.document().pose_at(first).clone();
    app.does(Command::Tracking(TrackingCommand::Forward));
    let (footage, fit) = (app.state.session.take.clone().unwrap(), (*app.document().fit).clone());
    let take = footage.take();
    let fit = Arc::new(FitOptions { prior: Some(likely_poses::people()), ..fit });
    let frames = (first..first + 4).collect();
    let search = app.document().tracking.search;
    let plan = TrackPlan { fit, search, ..TrackPlan::of_frames(take, start, frames) };
    let reader = TakeReader::of_silhouettes(footage.clone(), app.document().used_cameras().collect());
    let (mut run, mut track, mut is_done) = (TrackRun::new(Arc::new(reader), plan), Track::default(), false);
    while !is_done {
        run.step(&CancelToken::new(), &mut |message| match message {
            TrackMessage::Frame { estimate, .. } => drop(track.frames.insert(estimate.frame, *estimate)),
            TrackMessage::Rewound(mended) => {
                track.frames.extend(mended.into_iter().map(|one| (one.frame, one)));
            }
            TrackMessage::Done(how) => {
                assert!(matches!(how, TrackEnding::Whole), "{how:?}");
                is_done = true;
            }
            _ => {}
        });
    }
    let (name, frame_rate, model) = (take.name(), take.frame_rate(), &**take.model());
    let of_run = Motion::of_track(&TrackExport { name, frame_rate, model, cameras: &[], track: &track });
    let in_window = |app: &TestWindow| app.document().motion(name, frame_rate);
    assert_eq!(of_run.trust.len(), 4);
    assert_eq!(in_window(&app), of_run);

    let moved = of_run.poses[&(first + 1)].clone();
    app.state.edit(Edit::SetPose { frame: first, pose: moved, what: "Move".to_owned() }, None);
    app.state.edit(Edit::SetKey { frame: first + 1 }, None);
    let by_hand = in_window(&app);
    assert_eq!(by_hand.poses.len(), of_run.poses.len());
    let mut others = of_run.trust;
    others.retain(|frame, _| *frame > first + 1);
    assert_eq!(by_hand.trust, others);
}

/// In tiny pictures a ramp is half dark elsewhere than at a limb's edge; the overlap is the limb's all the same.
#[test]
fn a_frame_has_one_overlap() {
    let mut app = open_take(Demonstration::TinySequence, Layout::Pose);
    app.does(Command::Fit(FitCommand::Preset(Preset::Robust)));
    app.does(Command::Tracking(TrackingCommand::Forward));
    let tracked = app.document().estimates[&app.state.selection.frame].iou.unwrap();
    let shown = app.state.session.iou().unwrap();
    assert!((tracked - shown).abs() < 1e-12, "{tracked} in the timeline, {shown} in the status bar");
}

#[test]
fn keypoints_that_are_not_there_are_asked_for_in_words() {
    let mut app = open_take(Demonstration::TinySequence, Layout::Pose);
    let keypoints = TrackingChoices { cues: CueChoice::Keypoints, ..app.document().tracking };
    app.state.edit(Edit::SetTracking(keypoints), None);
    app.does(Command::Tracking(TrackingCommand::Forward));
    let said = app.errors();
    assert!(said.len() == 1 && said[0].starts_with("Not tracked: the take has no keypoints"), "{said:?}");
    assert!(app.document().estimates.is_empty());
}

#[test]
fn a_body_of_spheres_fits_better_than_capsules_and_is_taken_back_at_once() {
    let mut app = open_take(Demonstration::Spheres, Layout::Pose);
    let iou = |app: &TestWindow| app.state.session.iou().unwrap();
    let levels = app.document().model.spheres_by_level();
    assert!(levels.len() == 2 && levels[0] < levels[1], "{levels:?}: it is made as it opens");
    assert!(app.features.camera_views.preferences.settings.spheres, "the spheres are outlined");
    let spheres = iou(&app);
    app.does(Command::Fit(FitCommand::Renderer(RendererKind::Capsule)));
    let capsules = iou(&app);
    assert!(spheres > capsules + 0.02, "{spheres:.3}, {capsules:.3}");
    for _ in 0..2 {
        app.run(Command::History(HistoryCommand::Undo));
    }
    assert!(app.document().model.spheres_by_level().is_empty());
    assert_eq!(app.document().fit.renderer, RendererKind::Capsule);
}
