//! Silhouettes steered through the real window: painted with the pointer, looked at step by step, the worst of them listed.

use backlit_tracking::silhouette::{Label, Region};
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::readable::{SIZES, assert_readable, look_over};
use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Setup, Window, WindowState, built_in, centre, choose, click, command, freeze, grab, point, press,
    release, undo,
};

fn open(setup: Setup) -> Window {
    let mut window = setup.open();
    window.set_render_cursor(false);
    command(&mut window, "Show or hide silhouettes");
    window
}

/// Draws over the picture of the first camera, from its middle.
fn draw(window: &mut Window) {
    let from = centre(window, "Camera 1 picture");
    grab(window, from, &[vec2(30.0, 0.0), vec2(0.0, 40.0)]);
    release(window, from + vec2(30.0, 40.0));
}

#[test]
fn the_pointer_paints_and_esc_gives_it_back_to_the_body() {
    let mut window = open(built_in());
    let before = window.document().clone();
    command(&mut window, "Paint subject");
    draw(&mut window);
    let brush = window.document().brush.clone();
    assert_eq!((brush.len(), brush[0].camera, brush[0].stroke.label), (1, 0, Label::Subject));
    assert!(brush[0].stroke.points.len() > 1);
    assert_eq!(window.document().keys, before.keys, "nothing was posed");
    click(&mut window, "Remove brush strokes");
    assert!(window.document().brush.is_empty());
    undo(&mut window);
    undo(&mut window);
    assert_eq!(*window.document(), before);

    command(&mut window, "Draw region of interest");
    draw(&mut window);
    let region = window.document().measurement[0].region;
    assert!(matches!(region, Some(Region { width, height, .. }) if width > 5 && height > 5), "{region:?}");
    press(&mut window, Modifiers::NONE, Key::Escape);
    let painted = window.document().clone();
    draw(&mut window);
    assert_eq!(window.document().brush, painted.brush, "the brush is put away");
}

/// Faint parts and chroma bring numbers of their own; a drag of one is one edit.
#[test]
fn faint_parts_and_chroma_have_their_own_numbers() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut window = built_in().sized(1366.0, 1500.0).theme(theme).open();
        window.set_render_cursor(false);
        click(&mut window, "Measurement");
        choose(&mut window, Role::CheckBox, "Follow faint parts");
        choose(&mut window, Role::CheckBox, "Chroma apart from luminance");
        let before = window.document().clone();
        let of = |window: &Window| window.document().measurement[0].clone();
        for name in ["Faint", "Chroma", "Its noise"] {
            let slider = window.get_by_role_and_label(Role::Slider, name).rect();
            grab(&mut window, slider.center(), &[vec2(0.2 * slider.width(), 0.0)]);
            release(&mut window, slider.center() + vec2(0.2 * slider.width(), 0.0));
        }
        let (was, is) = (&before.measurement[0], of(&window));
        let [chroma, other] = [was, &is].map(|options| options.chroma.unwrap());
        assert!(is.hysteresis_z > was.hysteresis_z && is.hysteresis_z < Some(is.z_threshold), "{is:?}");
        assert!(other.z_threshold > chroma.z_threshold && other.noise_floor > chroma.noise_floor, "{is:?}");
        assert_eq!(is.z_threshold, was.z_threshold);
        let away = centre(&window, "Camera 1 picture");
        point(&mut window, away);
        freeze(&mut window);
        let first = window.get_by_label("Shadows").rect();
        let last = window.get_by_label("Other cameras must see it too").rect();
        let rect = Rect::from_min_max(first.min, last.max).expand2(vec2(4.0, 2.0));
        let rect = rect.with_max_x(window.get_by_role_and_label(Role::Slider, "Faint").rect().right() + 82.0);
        snapshots.part(&mut window, rect, &format!("measurement_switches_{}", theme_name(theme)));
        (0..3).for_each(|_| undo(&mut window));
        assert_eq!(*window.document(), before);
    }
}

#[test]
fn steps_are_told_and_the_worst_are_gone_to() {
    let mut window = open(built_in());
    command(&mut window, "Find worst silhouettes");
    assert!(
        window.query_by_label_contains("Nothing speaks against").is_some()
            || window.query_all_by_label_contains("Frame ").next().is_some()
    );
    let steps: Vec<String> = window
        .query_all_by_role(Role::Button)
        .filter_map(|node| node.accesskit_node().label())
        .filter(|label| label.contains(" step"))
        .collect();
    assert!(steps.len() > 5 && steps[0].starts_with("Difference"), "{steps:?}");
    choose(&mut window, Role::Button, &steps[1]);
    let large = window.get_by_label_contains("step, large").rect();
    point(&mut window, large.center());
    let told = centre(&window, "Camera 1 picture");
    point(&mut window, told);
    window.get_by_label_contains("Decided by");
}

#[test]
fn every_word_of_the_pane_can_be_read() {
    let mut wrong = Vec::new();
    for size in SIZES {
        let mut window = open(built_in().sized(size.x, size.y));
        command(&mut window, "Paint subject");
        look_over(&window, &format!("silhouettes at {size:?}"), &mut wrong);
    }
    assert_readable(&wrong);
}

#[test]
fn the_pane_in_both_themes() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut window = open(built_in().sized(1366.0, 900.0).theme(theme));
        command(&mut window, "Paint subject");
        draw(&mut window);
        window.state_mut().inspector.state.notices.close_all();
        freeze(&mut window);
        let header = window.get_by_label("Silhouettes header").rect();
        let rect = Rect::from_min_size(header.min, vec2(header.width(), 640.0));
        snapshots.part(&mut window, rect, &format!("silhouettes_{}", theme_name(theme)));
    }
}
