//! Tiles of the centre in the real window: splits, headers, closing, one alone, layouts; and the scene's tile.

use backlit::app::settings::Settings;
use backlit::context::pane::Pane;
use backlit::context::preferences::Layout;
use backlit::features::scene::{ScenePreferences, ShownHull, Viewpoint};
use backlit_ui::style::theme::{Theme, size};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::take;
use crate::support::window::{
    Window, WindowState, arm, button, click, command, freeze, press, settle, wheel,
};

const DEBUG_PANES: [&str; 4] = ["Camera 1", "Camera 2", "Scene", "Convergence"];
/// Between tiles.
const GAP: f32 = 2.0;

fn debug() -> Window {
    arm().layout(Layout::Debug).open()
}

fn header(harness: &Window, pane: &str) -> Rect {
    harness.get_by_role_and_label(Role::TitleBar, &format!("{pane} header")).rect()
}

fn has(harness: &Window, pane: &str) -> bool {
    harness.query_by_role_and_label(Role::TitleBar, &format!("{pane} header")).is_some()
}

fn drag_by(harness: &mut Window, with: PointerButton, from: Pos2, by: Vec2) {
    harness.event(Event::PointerMoved(from));
    harness.step();
    harness.event(button(from, with, true));
    harness.step();
    for share in [0.1, 0.3, 0.6, 0.9, 1.0, 1.0] {
        harness.event(Event::PointerMoved(from + share * by));
        harness.step();
    }
    harness.event(button(from + by, with, false));
    settle(harness);
    harness.event(Event::PointerGone);
    settle(harness);
}

fn drag(harness: &mut Window, from: Pos2, by: Vec2) {
    drag_by(harness, PointerButton::Primary, from, by);
}

fn double_click(harness: &mut Window, at: Pos2) {
    for _ in 0..2 {
        // Both in one frame: frames are far apart in time here.
        let events = [Event::PointerMoved(at), button(at, PointerButton::Primary, true)];
        harness.input_mut().events.extend(events);
        harness.input_mut().events.push(button(at, PointerButton::Primary, false));
        harness.step();
    }
    settle(harness);
}

/// On the split at the right of a pane, well below its header.
fn split_right_of(harness: &Window, pane: &str) -> Pos2 {
    header(harness, pane).right_top() + vec2(0.5 * GAP, 120.0)
}

/// The button of the newest notice; the toolbar has one of the same name.
fn undo_in_notice(harness: &mut Window) {
    let undo: Vec<_> = harness.get_all_by_role_and_label(Role::Button, "Undo").collect();
    undo.iter().max_by(|a, b| a.rect().top().total_cmp(&b.rect().top())).unwrap().click();
    drop(undo);
    settle(harness);
}

/// Tiles stand beside each other with one gap, from the left edge to the right panel.
fn assert_fills(harness: &Window) {
    let mut row: Vec<Rect> = ["Camera 1", "Camera 2", "Scene"].map(|pane| header(harness, pane)).to_vec();
    row.sort_by(|a, b| a.left().total_cmp(&b.left()));
    for pair in row.windows(2) {
        let gap = pair[1].left() - pair[0].right();
        assert!((gap - GAP).abs() < 1.01, "{gap} between {pair:?}");
    }
    let plot = header(harness, "Convergence");
    assert!((row[0].left() - plot.left()).abs() < 1.01 && (row[2].right() - plot.right()).abs() < 1.01);
}

#[test]
fn a_split_is_dragged_and_the_automatic_arrangement_comes_back() {
    let mut harness = debug();
    assert_fills(&harness);
    let first = header(&harness, "Camera 1").width();
    let split = split_right_of(&harness, "Camera 1");
    drag(&mut harness, split, vec2(70.0, 0.0));
    let wider = header(&harness, "Camera 1").width();
    assert!((wider - first - 70.0).abs() < 2.0, "{first} {wider}");
    assert_fills(&harness);
    assert!(harness.settings().kept.get(Layout::Debug, 2).is_some());

    command(&mut harness, "Arrange tiles");
    assert!((header(&harness, "Camera 1").width() - first).abs() < 0.5);
    undo_in_notice(&mut harness);
    assert!((header(&harness, "Camera 1").width() - wider).abs() < 0.5);

    press(&mut harness, Modifiers::COMMAND, Key::B);
    let before = harness.settings();
    command(&mut harness, "Reset layout");
    assert!(harness.settings().panel && harness.settings().kept.get(Layout::Debug, 2).is_none());
    undo_in_notice(&mut harness);
    let look = harness.settings();
    assert_eq!((&look.kept, look.panel), (&before.kept, false));
}

#[test]
fn splits_snap_at_thirds_and_halves() {
    let mut harness = debug();
    let row = header(&harness, "Convergence");
    let third = row.left() + row.width() / 3.0;
    let split = split_right_of(&harness, "Camera 1");
    drag(&mut harness, split, vec2(third - split.x + 6.0, 0.0));
    let at = header(&harness, "Camera 1").right() + 0.5 * GAP;
    assert!((at - third).abs() < 2.0, "{at} {third}");
    let away = split_right_of(&harness, "Camera 1");
    drag(&mut harness, away, vec2(30.0, 0.0));
    let at = header(&harness, "Camera 1").right();
    assert!((at - third - 30.0).abs() < 3.0, "it can be left again: {at} {third}");
}

#[test]
fn the_arrangement_is_there_at_the_next_start() {
    let mut harness = debug();
    let split = split_right_of(&harness, "Camera 1");
    drag(&mut harness, split, vec2(-60.0, 0.0));
    let widths = DEBUG_PANES.map(|pane| header(&harness, pane).width());
    let text = serde_json::to_string(&harness.settings()).unwrap();
    let again = arm().settings(serde_json::from_str(&text).unwrap()).open();
    assert_eq!(DEBUG_PANES.map(|pane| header(&again, pane).width()), widths);
    // The other layout has its own.
    let pose = arm().settings(serde_json::from_str(&text).unwrap()).layout(Layout::Pose).open();
    assert!(has(&pose, "Camera 2") && !has(&pose, "Scene"));
}

#[test]
fn a_tile_is_dragged_by_its_header_to_the_other_side() {
    let mut harness = debug();
    let (scene, first) = (header(&harness, "Scene"), header(&harness, "Camera 1"));
    assert!(scene.left() > first.left());
    let from = scene.left_center() + vec2(190.0, 0.0);
    let to = first.left_center() + vec2(4.0, 150.0);
    drag(&mut harness, from, to - from);
    assert!(header(&harness, "Scene").left() < header(&harness, "Camera 1").left());
    assert_fills(&harness);
}

#[test]
fn tiles_are_closed_and_opened_again() {
    let mut harness = debug();
    let before = header(&harness, "Scene");
    click(&mut harness, "More for Scene");
    click(&mut harness, "Close tile");
    assert!(!has(&harness, "Scene") && has(&harness, "Camera 2"));
    assert!(!harness.state().inspector.is_open(Pane::Scene));
    command(&mut harness, "Show or hide scene");
    assert_eq!(header(&harness, "Scene"), before, "it comes back to its place");
    for pane in DEBUG_PANES {
        click(&mut harness, &format!("More for {pane}"));
        click(&mut harness, "Close tile");
    }
    harness.get_by_label("All tiles are closed.");
    click(&mut harness, "Arrange tiles");
    assert_fills(&harness);
}

#[test]
fn any_tile_fills_the_window_and_esc_brings_the_others_back() {
    let mut harness = debug();
    for pane in DEBUG_PANES {
        let place = header(&harness, pane).left_center() + vec2(4.0, 0.0);
        double_click(&mut harness, place);
        assert!(DEBUG_PANES.iter().all(|other| has(&harness, other) == (*other == pane)), "{pane}");
        press(&mut harness, Modifiers::NONE, Key::Escape);
        assert!(DEBUG_PANES.iter().all(|other| has(&harness, other)), "{pane}");
    }
    press(&mut harness, Modifiers::NONE, Key::Num2);
    assert!(has(&harness, "Camera 2") && !has(&harness, "Scene"));
}

#[test]
fn the_scene_is_orbited_panned_and_zoomed_and_a_double_click_resets_it() {
    let mut harness = debug();
    let orbit = |harness: &Window| match harness.settings().scene.viewpoint {
        Some(Viewpoint::Orbit(orbit)) => orbit,
        other => panic!("{other:?}"),
    };
    let at = header(&harness, "Scene").center_bottom() + vec2(0.0, 250.0);
    assert_eq!(harness.settings().scene.viewpoint, None);
    drag(&mut harness, at, vec2(60.0, 10.0));
    let turned = orbit(&harness);
    drag_by(&mut harness, PointerButton::Middle, at, vec2(0.0, 40.0));
    let panned = orbit(&harness);
    assert!(panned.target != turned.target && panned.azimuth == turned.azimuth);
    harness.event(Event::PointerMoved(at));
    harness.event(wheel(vec2(0.0, 80.0)));
    harness.run_steps(20);
    assert!(orbit(&harness).distance < panned.distance);
    double_click(&mut harness, at);
    assert_eq!(harness.settings().scene.viewpoint, None);
}

#[test]
fn a_click_on_a_camera_in_the_scene_makes_its_tile_the_active_one() {
    let mut harness = debug();
    assert_eq!(harness.selection().camera, 0);
    click(&mut harness, "Scene camera 2");
    assert_eq!(harness.selection().camera, 1);
    command(&mut harness, "Scene from the active camera");
    assert_eq!(harness.settings().scene.viewpoint, Some(Viewpoint::Camera(1)));
    assert!(harness.query_by_role_and_label(Role::Button, "Scene camera 2").is_none());
}

#[test]
fn the_hull_is_carved_for_the_scene() {
    let harness = debug();
    let session = harness.session();
    let frame = session.shown_frame(0).unwrap();
    let hull = harness.state().inspector.features.scene.hulls.get(frame).unwrap().unwrap();
    let model = &harness.document().model;
    let truth = backlit_tracking::body::Kinematics::new(model, &take::truth(model, 0));
    for (start, end) in truth.starts().iter().zip(truth.ends()) {
        for joint in [start, end] {
            let inside = (*joint - hull.bounds[0]).min(hull.bounds[1] - *joint).min_element();
            assert!(inside > -hull.voxel, "{joint} is outside {:?}", hull.bounds);
        }
    }
    // The arm is 0.58 m long and 0.12 m thick.
    assert!(hull.size().max_element() < 0.95, "{}", hull.size());
    harness.get_by_label_contains("Visual hull ");
    let hidden = ScenePreferences { hull: ShownHull::Hidden, ..ScenePreferences::default() };
    let settings = Settings { scene: hidden, ..Settings::default() };
    let harness = arm().settings(settings).layout(Layout::Debug).open();
    let session = harness.session();
    let hulls = &harness.state().inspector.features.scene.hulls;
    assert!(hulls.get(session.shown_frame(0).unwrap()).is_none(), "what is not shown is not made");
}

#[test]
fn the_scene_in_both_themes() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let scene = ScenePreferences { hull: ShownHull::Shell, ..ScenePreferences::default() };
        let settings = Settings { scene, ..Settings::default() };
        let mut harness = arm().settings(settings).layout(Layout::Debug).theme(theme).open();
        freeze(&mut harness);
        let (top, below) = (header(&harness, "Scene"), header(&harness, "Convergence"));
        let tile = Rect::from_min_max(top.min, pos2(top.right(), below.top() - GAP));
        assert!(tile.height() > 5.0 * size::TILE_HEADER);
        snapshots.part(&mut harness, tile, &format!("scene_{}", theme_name(theme)));
    }
}
