//! The scene's tile: its picture is drawn beside the window, and keys turn it.

use std::sync::Arc;
use std::time::Duration;

use backlit::context::preferences::Layout;
use backlit::features::scene::{SceneDrawing, Upright, Viewpoint};
use backlit_tracking::body::Kinematics;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::window::{Window, WindowState, arm, grab, press, release, settle};

fn open() -> Window {
    arm().layout(Layout::Debug).open()
}

fn drawing(harness: &Window) -> Arc<SceneDrawing> {
    harness.state().inspector.features.scene.drawing.clone().expect("the scene was drawn")
}

fn middle(harness: &Window) -> Pos2 {
    harness.get_by_role_and_label(Role::Image, "Scene").rect().center()
}

/// Whether the picture shows the body as it is now, with smooth edges.
fn shows_pose(harness: &Window) -> bool {
    let app = harness.state();
    let pose = app.inspector.shown_pose();
    let kinematics = Kinematics::new(&app.inspector.document().model, pose);
    let order = &drawing(harness).order;
    let limbs = order.scene.limbs.iter().map(|limb| limb.ends[1]);
    !order.is_draft && limbs.eq(kinematics.ends().iter().copied())
}

#[test]
fn the_scene_is_whole_once_the_window_rests_and_the_same_every_time() {
    let harness = open();
    assert!(shows_pose(&harness));
    assert_eq!(drawing(&harness).image, drawing(&open()).image);
}

/// A frame of the window shows the picture that was there, and orders the next: what is seen changes only by what comes
/// from the worker.
#[test]
fn stepping_draws_nothing_in_the_windows_own_time() {
    let mut harness = open();
    settle(&mut harness);
    let mut pictures = 0;
    for _ in 0..6 {
        harness.key_press(Key::Space);
        // Several frames, so that orders are made while the worker is at it.
        for _ in 0..20 {
            let (before, is_idle) = (drawing(&harness), harness.state().inspector.is_idle());
            harness.step();
            let after = drawing(&harness);
            let is_new = !Arc::ptr_eq(&before, &after);
            assert!(!(is_new && is_idle), "nobody was at work, and yet there is another picture");
            pictures += usize::from(is_new);
        }
    }
    settle(&mut harness);
    assert!(shows_pose(&harness));
    assert!(pictures > 0, "the body moved, and its picture did not");
}

#[test]
fn a_view_that_is_dragged_ends_where_the_hand_let_go() {
    let mut harness = open();
    let from = middle(&harness);
    grab(&mut harness, from, &[]);
    let mut drafts = 0;
    for index in 1..60_u8 {
        harness.event(Event::PointerMoved(from + vec2(f32::from(index), 0.3 * f32::from(index))));
        harness.step();
        // As if the display took its time.
        std::thread::sleep(Duration::from_millis(2));
        drafts += usize::from(drawing(&harness).order.is_draft);
    }
    release(&mut harness, from + vec2(59.0, 18.0));
    let app = harness.state();
    let Some(Viewpoint::Orbit(orbit)) = app.inspector.settings().scene.viewpoint else {
        panic!("it was turned")
    };
    let upright = Upright::of(&app.inspector.state.session.take.as_ref().unwrap().cameras);
    let order = &drawing(&harness).order;
    assert_eq!(order.eye, orbit.camera(&upright));
    assert!(drafts > 0 && !order.is_draft, "{drafts}");
}

#[test]
fn over_the_scene_arrows_turn_it_and_elsewhere_they_change_the_frame() {
    let mut harness = open();
    let at = middle(&harness);
    harness.event(Event::PointerMoved(at));
    settle(&mut harness);
    let orbit = |harness: &Window| match harness.settings().scene.viewpoint {
        Some(Viewpoint::Orbit(orbit)) => orbit,
        other => panic!("{other:?}"),
    };
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    let turned = orbit(&harness);
    press(&mut harness, Modifiers::NONE, Key::ArrowUp);
    let above = orbit(&harness);
    assert!(above.elevation < turned.elevation && above.azimuth == turned.azimuth);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert!(orbit(&harness).azimuth < turned.azimuth);
    press(&mut harness, Modifiers::NONE, Key::Plus);
    assert!(orbit(&harness).distance < turned.distance);
    press(&mut harness, Modifiers::NONE, Key::Minus);
    press(&mut harness, Modifiers::NONE, Key::Minus);
    assert!(orbit(&harness).distance > turned.distance);
    assert_eq!(harness.selection().frame, 0);
    press(&mut harness, Modifiers::NONE, Key::Home);
    assert_eq!(harness.settings().scene.viewpoint, None);

    harness.event(Event::PointerGone);
    settle(&mut harness);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert_eq!((harness.selection().frame, harness.settings().scene.viewpoint), (1, None));

    harness.get_by_role_and_label(Role::Image, "Scene").focus();
    settle(&mut harness);
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    assert!(orbit(&harness).distance > 0.0 && harness.selection().frame == 1);
}

#[test]
fn keys_of_the_scene_are_listed() {
    let mut harness = open();
    press(&mut harness, Modifiers::NONE, Key::Questionmark);
    harness.get_by_label("Turn the scene");
}
