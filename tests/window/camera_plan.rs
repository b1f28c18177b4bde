//! The plan of cameras through the real window: made, looked at, made again, left.

use backlit::context::preferences::Layout;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::readable::{SIZES, assert_readable, look_over};
use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Setup, Window, WindowState, arm, built_in, choose, click, command, press, settle,
};

/// The card on the built-in take.
fn planned(theme: Theme, size: [f32; 2]) -> Window {
    of(built_in(), theme, size)
}

fn of(setup: Setup, theme: Theme, [width, height]: [f32; 2]) -> Window {
    let mut window = setup.theme(theme).sized(width, height).open();
    window.set_render_cursor(false);
    command(&mut window, "Where to put cameras…");
    window
}

#[test]
fn a_plan_shows_the_floor_and_where_one_more_camera_brings_most() {
    let mut window = planned(Theme::Dark, [1366.0, 768.0]);
    let document = window.document().clone();
    window.get_by_label_contains("The floor with cam1, cam2, cam3, cam4: ");
    let before = window.get_by_label_contains("cam4, 2.4 m high").accesskit_node().label().unwrap();
    let rows: Vec<String> = window
        .query_all_by_role(Role::ListItem)
        .filter_map(|node| node.accesskit_node().label())
        .filter(|label| label.starts_with("At ("))
        .collect();
    assert_eq!(rows.len(), 5, "{rows:?}");
    choose(&mut window, Role::ListItem, &rows[3]);
    let after = window.get_by_label_contains("The floor with cam1, cam2, cam3, cam4, ");
    assert_ne!(after.accesskit_node().label().unwrap(), before, "another place is looked at");
    click(&mut window, "Plan again");
    window.get_by_label_contains("is missed least");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label("Plan again").is_none(), "the card is closed");
    assert_eq!(*window.document(), document, "nothing was changed");
}

#[test]
fn every_word_of_the_card_can_be_read() {
    let mut wrong = Vec::new();
    for size in SIZES {
        let window = of(arm(), Theme::Dark, size.into());
        look_over(&window, &format!("planned at {size}"), &mut wrong);
    }
    assert_readable(&wrong);
}

#[test]
fn the_card_in_both_themes() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut window = planned(theme, [1024.0, 900.0]);
        let card = Rect::from_min_size(pos2(146.0, 134.0), vec2(732.0, 740.0));
        snapshots.part(&mut window, card, &format!("panel_camera_plan_{}", theme_name(theme)));
    }
}

/// After a plan the scene's floor has its colours, with what they mean.
#[test]
fn the_floor_of_the_scene_shows_the_plan_in_both_themes() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut window = of(built_in().layout(Layout::Debug), theme, [1366.0, 900.0]);
        press(&mut window, Modifiers::NONE, Key::Escape);
        settle(&mut window);
        let scene = window.get_by_role_and_label(Role::Image, "Scene").rect();
        snapshots.part(&mut window, scene, &format!("scene_floor_{}", theme_name(theme)));
    }
}
