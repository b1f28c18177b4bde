//! The timeline: playing, going to frames, key poses, tracking, what the lanes say.

use std::time::Instant;

use backlit_ui::style::theme::{Theme, size};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::take;
use crate::support::window;
use crate::support::window::{
    PATIENCE, Window, WindowState, centre, choose, click, close_notices, freeze, of_take, pointer, press,
    refuses, settle, undo, wait_until, wheel,
};

/// Frames of the take, and how many of them it shows a second.
const FRAMES: usize = 12;
const RATE: f64 = 10.0;
/// The frame in which the arm is out of the picture.
const EMPTY: usize = 7;

fn open() -> Window {
    of_take(take::take_of(FRAMES, &[])).open()
}

fn frame(window: &Window) -> usize {
    window.selection().frame
}

fn tracked(window: &Window) -> Vec<usize> {
    window.document().estimates.keys().copied().collect()
}

fn keys(window: &Window) -> Vec<usize> {
    window.document().keys.keys().copied().collect()
}

fn go_to(window: &mut Window, frame: usize) {
    window.state_mut().inspector.state.go_to_frame(frame);
    settle(window);
}

fn timeline(window: &Window) -> Rect {
    window.get_by_role_and_label(Role::Slider, "Timeline").rect()
}

/// What the timeline says of the frames that it shows.
fn shown(window: &Window) -> String {
    let node = window.get_by_role_and_label(Role::Slider, "Timeline");
    node.accesskit_node().data().description().unwrap().to_owned()
}

/// Where a frame is while all are shown.
fn place(window: &Window, frame: f32) -> Pos2 {
    let all = timeline(window);
    let (left, right) = (all.left() + 122.0, all.right() - 46.0);
    pos2(left + (right - left) * frame / (FRAMES - 1) as f32, all.bottom() - 12.0)
}

/// Drags from one place to another, in a few moves.
fn drag(window: &mut Window, which: PointerButton, modifiers: Modifiers, from: Pos2, to: Pos2) {
    window.event(Event::ModifiersChanged(modifiers));
    window.event(Event::PointerMoved(from));
    let button = |pos, pressed| Event::PointerButton { pos, button: which, pressed, modifiers };
    window.event(button(from, true));
    for share in [0.2, 0.6, 1.0] {
        window.event(Event::PointerMoved(from + share * (to - from)));
    }
    window.event(button(to, false));
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    settle(window);
}

fn click_at(window: &mut Window, at: Pos2) {
    drag(window, PointerButton::Primary, Modifiers::NONE, at, at);
}

fn turn_wheel(window: &mut Window, at: Pos2, by: Vec2) {
    window.event(Event::PointerMoved(at));
    window.event(wheel(by));
    window.run_steps(6);
}

/// A window whose clock is the test's, with all frames read. The clock stands at `from`.
struct Film {
    window: Window,
    from: f64,
}

impl Film {
    fn new() -> Self {
        let mut window = open();
        for frame in (0..FRAMES).rev() {
            go_to(&mut window, frame);
        }
        let from = window.ctx.input(|input| input.time) + 1.0;
        Self { window, from }
    }

    /// The frame on the screen some seconds later.
    fn at(&mut self, seconds: f64) -> usize {
        self.window.input_mut().time = Some(self.from + seconds);
        self.window.step();
        frame(&self.window)
    }

    fn key(&mut self, seconds: f64, key: Key) {
        self.keys(seconds, Modifiers::NONE, key);
    }

    fn keys(&mut self, seconds: f64, modifiers: Modifiers, key: Key) {
        self.window.key_press_modifiers(modifiers, key);
        self.at(seconds);
    }

    fn is_playing(&self) -> bool {
        self.window.state().inspector.state.playback.is_playing()
    }
}

#[test]
fn playing_follows_the_clock_however_late_the_window_is() {
    let mut film = Film::new();
    film.key(0.0, Key::P);
    assert!(film.is_playing());
    let frames = [0.05, 0.1, 0.19, 0.2, 0.55, 0.95, 1.15].map(|seconds| film.at(seconds));
    assert_eq!(frames, [0, 1, 1, 2, 5, 9, 11], "frames that are late are left out");
    assert!(film.is_playing(), "the last frame is shown as long as any other");
    assert_eq!(film.at(1.25), FRAMES - 1);
    assert!(!film.is_playing(), "and then the film is over");
    film.key(2.0, Key::P);
    assert_eq!([film.at(2.0), film.at(2.1)], [0, 1], "at the end it begins again");
    film.key(2.15, Key::P);
    assert_eq!(film.at(9.0), 1, "paused");
}

#[test]
fn playing_goes_slower_faster_and_round_and_round() {
    let mut film = Film::new();
    film.window.get_by_role_and_label(Role::ComboBox, "Speed").click();
    film.at(-0.8);
    film.at(-0.6);
    film.window.get_by_label("2×").click();
    film.at(-0.4);
    film.key(0.0, Key::P);
    assert_eq!([0.05, 0.1, 0.3].map(|seconds| film.at(seconds)), [1, 2, 6], "twice as fast");
    for _ in 0..3 {
        film.keys(0.3, Modifiers::SHIFT, Key::Comma);
    }
    assert_eq!([0.4, 0.5, 0.7].map(|seconds| film.at(seconds)), [6, 7, 8], "half as fast");
    film.keys(0.7, Modifiers::SHIFT, Key::Period);
    film.window.get_by_role_and_label(Role::CheckBox, "Loop").click();
    film.at(0.7);
    assert_eq!([1.0, 1.15].map(|seconds| film.at(seconds)), [11, 0], "round and round");
    assert_eq!(film.at(0.7 + 100.0 * FRAMES as f64 / RATE), 8, "a window that slept for rounds");
    assert!(film.is_playing());
}

#[test]
fn what_is_taken_into_the_hand_pauses_the_film() {
    let mut film = Film::new();
    let joint = centre(&film.window, "right wrist, Camera 1");
    film.key(0.0, Key::P);
    film.window.event(Event::PointerMoved(joint));
    film.window.event(pointer(joint, true));
    film.at(0.0);
    film.window.event(Event::PointerMoved(joint + vec2(0.0, 20.0)));
    film.window.event(Event::PointerMoved(joint + vec2(0.0, 40.0)));
    film.at(0.01);
    assert!(!film.is_playing(), "a dragged joint");
    assert_eq!(film.at(3.0), 0);
    film.window.event(pointer(joint + vec2(0.0, 40.0), false));
    film.at(3.1);
    assert_eq!(keys(&film.window), [0]);

    film.key(4.0, Key::P);
    let (from, to) = (place(&film.window, 4.0), place(&film.window, 8.0));
    film.window.event(Event::PointerMoved(from));
    film.window.event(pointer(from, true));
    film.window.event(pointer(from, false));
    assert_eq!(film.at(4.0), 4);
    film.at(4.0);
    assert_eq!(film.at(4.2), 6, "a click goes elsewhere, and the film goes on from there");
    film.window.event(Event::PointerMoved(from));
    film.window.event(pointer(from, true));
    film.window.event(Event::PointerMoved(to));
    film.at(4.3);
    assert_eq!(film.at(9.0), 8, "a drag through the frames");
    assert!(!film.is_playing());
    film.window.event(pointer(to, false));

    film.key(10.0, Key::P);
    film.key(10.0, Key::Space);
    assert!(!film.is_playing(), "a step of the fit");
}

#[test]
fn marked_frames_are_played_and_cleared() {
    let mut window = open();
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    assert_eq!(tracked(&window).len(), FRAMES);
    let (from, to) = (place(&window, 3.0), place(&window, 5.0));
    drag(&mut window, PointerButton::Primary, Modifiers::SHIFT, from, to);
    assert_eq!(frame(&window), FRAMES - 1, "marking goes nowhere");
    window.key_press(Key::P);
    window.step();
    let mut seen = Vec::new();
    let began = Instant::now();
    while seen.len() < 3 {
        window.step();
        assert!((3..=5).contains(&frame(&window)) && began.elapsed() < PATIENCE, "{seen:?}");
        if !seen.contains(&frame(&window)) {
            seen.push(frame(&window));
        }
    }
    press(&mut window, Modifiers::NONE, Key::P);
    window.get_by_role_and_label(Role::Slider, "Timeline").click_secondary();
    settle(&mut window);
    window.get_by_label_contains("Clear marked frames").click();
    settle(&mut window);
    assert_eq!(tracked(&window), [0, 1, 2, 6, 7, 8, 9, 10, 11]);
    undo(&mut window);
    assert_eq!(tracked(&window).len(), FRAMES);
}

#[test]
fn the_timeline_is_zoomed_moved_and_follows_the_frame() {
    let mut window = open();
    assert_eq!(shown(&window), "Frames 0 to 11 of 0 to 11");
    let at = place(&window, 6.0);
    turn_wheel(&mut window, at, vec2(0.0, 180.0));
    let zoomed = shown(&window);
    assert_eq!(zoomed, "Frames 3 to 9 of 0 to 11", "about the frame under the pointer");
    click_at(&mut window, at);
    assert_eq!(frame(&window), 6);
    let by = vec2(120.0, 0.0);
    drag(&mut window, PointerButton::Middle, Modifiers::NONE, at, at + by);
    let moved = shown(&window);
    assert_ne!(moved, zoomed, "the middle button moves it");
    assert_eq!(frame(&window), 6, "and nothing else");
    turn_wheel(&mut window, at, vec2(-300.0, 0.0));
    assert_ne!(shown(&window), moved, "and the wheel, sideways");
    press(&mut window, Modifiers::NONE, Key::End);
    assert!(shown(&window).contains("to 11 of"), "it follows the frame: {}", shown(&window));
    press(&mut window, Modifiers::NONE, Key::Home);
    assert!(shown(&window).starts_with("Frames 0 to"), "{}", shown(&window));
    // Both clicks at once: the test's clock stands.
    let now = window.ctx.input(|input| input.time) + 1.0;
    window.input_mut().time = Some(now);
    for _ in 0..2 {
        window.event(pointer(at, true));
        window.event(pointer(at, false));
    }
    window.step();
    window.input_mut().time = None;
    settle(&mut window);
    assert_eq!(shown(&window), "Frames 0 to 11 of 0 to 11", "a double click shows the whole take");
}

#[test]
fn key_poses_are_set_cleared_and_gone_to() {
    let mut window = open();
    refuses(&mut window, "Next key pose", "There is no key pose yet");
    go_to(&mut window, 2);
    click(&mut window, "Set key");
    refuses(&mut window, "Next key pose", "This frame has the only key pose");
    go_to(&mut window, 9);
    press(&mut window, Modifiers::NONE, Key::K);
    assert_eq!(keys(&window), [2, 9]);
    click(&mut window, "Key pose of frame 2");
    assert_eq!(frame(&window), 2);
    press(&mut window, Modifiers::NONE, Key::CloseBracket);
    assert_eq!(frame(&window), 9);
    click(&mut window, "Previous key pose");
    assert_eq!(frame(&window), 2);
    click(&mut window, "Clear key");
    assert_eq!(keys(&window), [9]);
    assert!(window.query_by_label("Key pose of frame 2").is_none());
    undo(&mut window);
    assert_eq!(keys(&window), [2, 9]);
    window.get_by_label("Key pose of frame 9").hover();
    window.run_steps(3);
    window.get_by_label_contains("The tracker starts again from it");
}

#[test]
fn tracking_goes_on_and_back_and_is_undone_as_one() {
    let mut window = open();
    refuses(&mut window, "Track back", "This is the first frame");
    go_to(&mut window, 5);
    click(&mut window, "Track back");
    assert_eq!(tracked(&window), [0, 1, 2, 3, 4, 5]);
    assert_eq!(frame(&window), 0, "the screen follows");
    go_to(&mut window, 5);
    click(&mut window, "Track forward");
    assert_eq!(tracked(&window), (0..FRAMES).collect::<Vec<_>>());
    window.get_by_label_contains("12 frames fitted, 0 to 11, mean IoU");
    refuses(&mut window, "Track forward", "This is the last frame");
    undo(&mut window);
    assert_eq!(tracked(&window), [0, 1, 2, 3, 4, 5]);
    undo(&mut window);
    assert!(tracked(&window).is_empty());
}

#[test]
fn a_key_pose_on_the_way_is_kept_refined_or_where_the_track_stops() {
    let mut window = open();
    go_to(&mut window, 5);
    press(&mut window, Modifiers::NONE, Key::Enter);
    window::drag(&mut window, "right wrist, Camera 1", vec2(0.0, 60.0));
    let wrong = window.document().keys[&5].clone();
    assert!(apart(&window, &wrong, &take::truth(&window.document().model, 5)) > 0.03);
    go_to(&mut window, 0);
    click(&mut window, "Solver");
    let choose = |window: &mut Window, from: &str, to: &str| {
        let chosen = window.get_by_role_and_label(Role::ComboBox, "Key poses");
        assert_eq!(chosen.accesskit_node().value().as_deref(), Some(from));
        chosen.scroll_to_me();
        window.run_steps(4);
        let chosen = window.get_by_role_and_label(Role::ComboBox, "Key poses");
        chosen.click();
        window.run_steps(2);
        click(window, to);
    };
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    assert_eq!(tracked(&window), (0..FRAMES).collect::<Vec<_>>());
    assert_eq!(window.document().estimates[&5].pose, wrong, "as it was set by hand");
    let off =
        apart(&window, &window.document().estimates[&8].pose, &take::truth(&window.document().model, 8));
    assert!(off < 0.03, "the track goes on from it: {off} m");
    undo(&mut window);

    go_to(&mut window, 0);
    choose(&mut window, "Keep", "Refine");
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    let found = window.document().estimates[&5].pose.clone();
    assert!(apart(&window, &found, &take::truth(&window.document().model, 5)) < 0.03);
    assert_eq!(keys(&window), [5], "it stays a key pose");
    undo(&mut window);

    go_to(&mut window, 0);
    choose(&mut window, "Refine", "Stop before");
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    assert_eq!(tracked(&window), [0, 1, 2, 3, 4]);
}

#[test]
fn what_was_found_with_another_body_says_so() {
    let mut window = open();
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    assert!(window.document().estimates.values().all(|found| !found.is_stale));
    press(&mut window, Modifiers::NONE, Key::E);
    choose(&mut window, Role::ListItem, "Right forearm");
    window::drag(&mut window, "right forearm length, Camera 1", vec2(30.0, 0.0));
    assert!(window.document().estimates.values().all(|found| found.is_stale));
    press(&mut window, Modifiers::NONE, Key::Enter);
    let here = frame(&window);
    assert!(!window.document().estimates[&here].is_stale, "fitted again");
    assert!(window.document().estimates[&0].is_stale);
}

/// How far apart the arms of two poses are: the ends of both limbs, metres.
fn apart(window: &Window, a: &backlit_tracking::body::Pose, b: &backlit_tracking::body::Pose) -> f64 {
    let model = &window.document().model;
    let ends = |pose| backlit_tracking::body::Kinematics::new(model, pose).ends().to_vec();
    ends(a).into_iter().zip(ends(b)).map(|(a, b)| a.distance(b)).fold(0.0, f64::max)
}

#[test]
fn between_two_key_poses_both_tracks_are_joined() {
    let mut window = open();
    refuses(&mut window, "Between keys", "Set a key pose before this frame and one after it");
    let model = window.document().model.clone();
    for at in [2, 9] {
        go_to(&mut window, at);
        press(&mut window, Modifiers::NONE, Key::Enter);
        press(&mut window, Modifiers::NONE, Key::K);
    }
    go_to(&mut window, 5);
    let before = window.document().clone();
    click(&mut window, "Between keys");
    assert_eq!(tracked(&window), (2..=9).collect::<Vec<_>>(), "nothing outside");
    for (at, found) in window.document().estimates.iter() {
        let off = apart(&window, &found.pose, &take::truth(&model, *at));
        assert!(off < 0.03, "frame {at} is {off} m off");
    }
    for at in [2, 9] {
        let off = apart(&window, &window.document().estimates[&at].pose, &before.keys[&at]);
        assert!(off < 0.01, "the track joins the key pose of frame {at}: {off} m");
    }
    assert_eq!(keys(&window), [2, 9]);
    window.get_by_label_contains("Tracked between the key poses of frames 2 and 9");
    undo(&mut window);
    assert_eq!(*window.document(), before, "one undo takes it all back");

    for at in [8, 10] {
        go_to(&mut window, at);
        press(&mut window, Modifiers::NONE, Key::K);
    }
    go_to(&mut window, 8);
    refuses(&mut window, "Between keys", "There is no frame between the key poses");
}

#[test]
fn a_track_between_keys_that_is_stopped_keeps_what_was_done() {
    let mut window = open();
    for at in [0, 11] {
        go_to(&mut window, at);
        press(&mut window, Modifiers::NONE, Key::K);
    }
    let before = window.document().clone();
    go_to(&mut window, 3);
    window.get_by_role_and_label(Role::Button, "Between keys").click();
    wait_until(&mut window, "four frames", |window| tracked(window).len() >= 4);
    press(&mut window, Modifiers::NONE, Key::Escape);
    let done = tracked(&window).len();
    assert!((4..=FRAMES).contains(&done), "{done}");
    if done < FRAMES {
        window.get_by_label_contains("the two tracks are not joined");
    }
    undo(&mut window);
    assert_eq!(*window.document(), before);
}

/// A take with a frame in which there is nobody, tracked.
fn open_tracked(theme: Theme, size: Vec2) -> Window {
    let setup = of_take(take::take_of(FRAMES, &[EMPTY]));
    let mut window = setup.theme(theme).sized(size.x, size.y).open();
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    close_notices(&mut window);
    window
}

#[test]
fn lost_and_worst_frames_are_marked_and_gone_to() {
    let mut window = open();
    refuses(&mut window, "Worst", "No frame is tracked yet");
    let mut window = open_tracked(Theme::Dark, vec2(1500.0, 900.0));
    let lost: Vec<usize> =
        window.document().estimates.iter().filter(|(_, found)| found.lost).map(|(at, _)| *at).collect();
    assert_eq!(lost, [EMPTY]);
    window.get_by_label("Lost frame 7");
    window.get_by_label_contains("1 lost");
    let overlaps = window.document().estimates.iter().filter(|(_, found)| !found.lost);
    let worst = overlaps.min_by(|a, b| a.1.iou.partial_cmp(&b.1.iou).unwrap()).map(|(at, _)| *at).unwrap();
    window.get_by_label(&format!("Worst frame {worst}"));
    press(&mut window, Modifiers::NONE, Key::Home);
    for expected in [EMPTY, worst, EMPTY] {
        press(&mut window, Modifiers::NONE, Key::N);
        assert_eq!(frame(&window), expected, "the worst of all, then the next, then round");
    }
    press(&mut window, Modifiers::NONE, Key::Home);
    let mut in_order = [worst, EMPTY];
    in_order.sort_unstable();
    for expected in in_order {
        press(&mut window, Modifiers::SHIFT, Key::N);
        assert_eq!(frame(&window), expected, "the worst tenth in their order: of twelve frames two");
    }
    click(&mut window, "Previous poor frame");
    assert_eq!(frame(&window), in_order[0]);
    let at = place(&window, EMPTY as f32);
    window.event(Event::PointerMoved(at));
    window.run_steps(3);
    window.get_by_label("Frame 7, 0.700 s");
    window.get_by_label_contains("Lost:");
}

#[test]
fn lanes_say_their_values_and_their_ends() {
    let mut window = open();
    window.get_by_label("RMS, grey: not known, lane from 0 to 1");
    window.get_by_label("IoU: not known, lane from 0.4 to 1");
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    let found = window.document().estimates[&(FRAMES - 1)].clone();
    let iou = backlit_ui::style::format::ratio(found.iou.unwrap());
    window.get_by_label(&format!("IoU: {iou}, lane from 0.9 to 1"));
    let steps = format!("Steps: {}, lane from 0 to", found.steps);
    window.get_by_label_contains(&steps).hover();
    window.run_steps(6);
    window.get_by_label_contains("how many steps the fit of each frame took");
    window.get_by_label_contains("RMS, grey: ").hover();
    window.run_steps(6);
    window.get_by_label_contains("one measure for tracked and for fitted frames");
}

#[test]
fn a_take_of_one_frame_neither_plays_nor_tracks() {
    let mut window = of_take(take::take_of(1, &[])).open();
    assert_eq!(shown(&window), "Frames 0 to 0 of 0 to 0");
    refuses(&mut window, "Play or pause", "The take has one frame");
    refuses(&mut window, "Track back", "This is the first frame");
    refuses(&mut window, "Next frame", "This is the last frame");
    let middle = timeline(&window).center();
    click_at(&mut window, middle);
    assert_eq!(frame(&window), 0);
    press(&mut window, Modifiers::NONE, Key::Enter);
    window.get_by_label_contains("Frame 0 fitted");
    refuses(&mut window, "Worst", "Only one frame is fitted");
}

#[test]
fn without_silhouettes_nothing_is_tracked_or_fitted_and_what_is_missing_is_said() {
    let mut window = of_take(take::take_without_backgrounds()).open();
    for command in ["Track forward", "Step", "Run"] {
        refuses(&mut window, command, "No camera that counts has a silhouette of this frame");
    }
    press(&mut window, Modifiers::COMMAND, Key::Enter);
    assert!(window.document().estimates.is_empty());
}

/// Compares the timeline, with its row of buttons.
fn part(snapshots: &mut Snapshots, window: &mut Window, name: &str) {
    window.remove_cursor();
    window.set_render_cursor(false);
    freeze(window);
    let lanes = timeline(window);
    let rect = Rect::from_min_max(lanes.min - vec2(8.0, 34.0), lanes.max + vec2(8.0, 4.0));
    snapshots.part(window, rect, name);
}

#[test]
fn pictures_of_its_states() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let name = theme_name(theme);
        let large = vec2(1276.0 + size::RIGHT_PANEL, 816.0);
        let mut window = of_take(take::take_of(FRAMES, &[])).theme(theme).sized(large.x, large.y).open();
        part(&mut snapshots, &mut window, &format!("timeline_empty_{name}"));
        let mut window = open_tracked(theme, large);
        for at in [0, 4, 11] {
            go_to(&mut window, at);
            press(&mut window, Modifiers::NONE, Key::K);
        }
        go_to(&mut window, 4);
        part(&mut snapshots, &mut window, &format!("timeline_tracked_{name}"));
        let at = place(&window, 6.0);
        turn_wheel(&mut window, at, vec2(0.0, 180.0));
        part(&mut snapshots, &mut window, &format!("timeline_zoomed_{name}"));
        let mut window = open_tracked(theme, vec2(1100.0, 700.0));
        part(&mut snapshots, &mut window, &format!("timeline_small_{name}"));
    }
}
