//! The tour on the built-in take: every step is done as a user does it.

use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Pos2, Rect, Vec2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Window, WindowState, around, built_in, centre, click, command, grab, press, release, wait_until,
};

fn open(size: Vec2, theme: Theme, offers_tour: bool) -> Window {
    let setup = built_in().theme(theme).sized(size.x, size.y);
    setup.with(|options| options.offers_tour = offers_tour).open()
}

fn at(harness: &Window, step: usize) -> Rect {
    harness.get_by_label(&format!("Tour, step {step} of 7")).rect()
}

/// The card stands in the window, and not over what it is about.
fn is_beside(harness: &Window, step: usize, target: Rect) {
    let card = at(harness, step);
    assert!(!card.intersects(target), "step {step}: {card} lies on {target}");
    assert!(harness.ctx.content_rect().contains_rect(card), "step {step}: {card}");
}

fn drag(harness: &mut Window, handle: &str, by: Vec2) {
    drag_from(harness, centre(harness, handle), by);
}

fn drag_from(harness: &mut Window, from: Pos2, by: Vec2) {
    grab(harness, from, &[0.3, 0.7, 1.0].map(|share| share * by));
    release(harness, from + by);
    harness.event(Event::PointerGone);
    harness.run_steps(2);
}

/// The joint's label in the camera that the card names.
fn joint_in_named_camera(harness: &Window) -> String {
    let text = harness.get_by_label_contains("along the ray in camera").value().unwrap();
    let camera = text.split("camera ").nth(1).unwrap().split(':').next().unwrap();
    format!("right wrist, Camera {camera}")
}

fn walk(harness: &mut Window) {
    command(harness, "tour");
    harness.run_steps(3);
    let card = at(harness, 1);
    let back = harness.query_by_role_and_label(Role::Button, "Back");
    assert!(back.is_none_or(|back| back.accesskit_node().is_disabled()));
    click(harness, "Next");

    harness.run_steps(3);
    assert_ne!(at(harness, 2), card, "the card goes where the next thing is");
    is_beside(harness, 2, harness.get_by_label("right wrist, Camera 1").rect().expand(40.0));
    // Looking is not dragging.
    harness.run_steps(5);
    at(harness, 2);
    drag(harness, "right wrist, Camera 1", vec2(30.0, 40.0));
    harness.run_steps(3);

    let joint = joint_in_named_camera(harness);
    is_beside(harness, 3, harness.get_by_label(&joint).rect().expand(40.0));
    // The same view again tells nothing of the depth.
    drag(harness, "right wrist, Camera 1", vec2(-20.0, -30.0));
    at(harness, 3);
    drag(harness, &joint, vec2(25.0, -30.0));
    harness.run_steps(3);

    is_beside(harness, 4, harness.get_by_role_and_label(Role::Button, "Step").rect());
    press(harness, Modifiers::NONE, Key::Space);
    harness.run_steps(3);

    is_beside(harness, 5, harness.get_by_role_and_label(Role::Button, "Run").rect());
    press(harness, Modifiers::NONE, Key::Enter);
    harness.run_steps(3);
    let slider = harness.get_by_role_and_label(Role::Slider, "Step").rect();
    is_beside(harness, 5, slider);
    drag_from(harness, slider.right_center() - vec2(10.0, 0.0), vec2(-60.0, 0.0));
    harness.run_steps(3);

    at(harness, 6);
    for key in [Key::C, Key::Y, Key::S] {
        press(harness, Modifiers::NONE, key);
    }
    harness.run_steps(3);

    is_beside(harness, 7, harness.get_by_role_and_label(Role::Button, "Track forward").rect());
    // Back is there at any time, and forward again without doing it all.
    click(harness, "Back");
    harness.run_steps(2);
    at(harness, 6);
    click(harness, "Next");
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    wait_until(harness, "three frames", |window| window.document().estimates.len() >= 3);
    press(harness, Modifiers::NONE, Key::Escape);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Tour, step").is_none());
    assert!(harness.said().iter().any(|text| text.contains("That was the tour")));
}

#[test]
fn every_step_waits_until_it_was_done_in_a_large_window() {
    walk(&mut open(vec2(1600.0, 1000.0), Theme::Dark, false));
}

#[test]
fn every_step_waits_until_it_was_done_in_the_smallest_window() {
    walk(&mut open(vec2(1116.0, 716.0), Theme::Light, false));
}

#[test]
fn the_tour_is_offered_once() {
    let mut harness = open(vec2(1200.0, 800.0), Theme::Dark, true);
    harness.get_by_label("Offer of the tour");
    click(&mut harness, "Not now");
    assert!(harness.query_by_label("Offer of the tour").is_none());
    let look = harness.settings();
    assert!(look.tour_offered);
    let again =
        built_in().settings(look).sized(1200.0, 800.0).with(|options| options.offers_tour = true).open();
    assert!(again.query_by_label("Offer of the tour").is_none());
}

#[test]
fn who_takes_the_offer_is_guided_and_may_skip() {
    let mut harness = open(vec2(1200.0, 800.0), Theme::Dark, true);
    click(&mut harness, "Take the tour");
    harness.run_steps(3);
    at(&harness, 1);
    click(&mut harness, "Skip");
    assert!(harness.query_by_label_contains("Tour, step").is_none());
    // Without being asked, it is never there.
    let plain = open(vec2(1200.0, 800.0), Theme::Dark, false);
    assert!(plain.query_by_label("Offer of the tour").is_none());
}

#[test]
fn cards_look_as_they_should() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(vec2(1200.0, 800.0), theme, true);
        part(
            &mut snapshots,
            &mut harness,
            "Offer of the tour",
            &format!("panel_tour_offer_{}", theme_name(theme)),
        );
        click(&mut harness, "Take the tour");
        harness.run_steps(3);
        click(&mut harness, "Next");
        harness.run_steps(3);
        let name = format!("panel_tour_card_{}", theme_name(theme));
        part(&mut snapshots, &mut harness, "Tour, step 2 of 7", &name);
    }
}

fn part(snapshots: &mut Snapshots, harness: &mut Window, label: &str, name: &str) {
    harness.state_mut().inspector.freeze_times();
    harness.step();
    snapshots.part(harness, around(harness, label, vec2(60.0, 16.0)), name);
}
