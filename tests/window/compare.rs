//! The poses beside a reference, and runs beside each other, in the real window.

use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Rect, Vec2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::readable::{assert_readable, look_over};
use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Setup, Window, WindowState, built_in, choose, close_notices, command, freeze, settle, wait_until,
};

/// The built-in take, tracked, beside its own reference.
fn open(setup: Setup) -> Window {
    let mut window = setup.open();
    window.set_render_cursor(false);
    command(&mut window, "Track forward");
    wait_until(&mut window, "a tracked take", |window| window.document().estimates.len() >= 60);
    settle(&mut window);
    close_notices(&mut window);
    command(&mut window, "Show or hide comparison");
    settle(&mut window);
    window
}

fn pane(window: &Window) -> Rect {
    let header = window.get_by_label("Compare header").rect();
    Rect::from_min_size(header.min, vec2(header.width(), 186.0))
}

const SIZES: [Vec2; 2] = [vec2(1600.0, 1000.0), vec2(1280.0, 800.0)];

#[test]
fn a_click_on_a_row_chooses_the_curve_and_words_can_be_read() {
    let mut snapshots = Snapshots::default();
    let mut wrong = Vec::new();
    for (theme, size) in Theme::ALL.into_iter().zip(SIZES) {
        let mut window = open(built_in().sized(size.x, size.y).theme(theme));
        let rows = window.query_all_by_role(Role::ListItem).count();
        assert!(rows > 10, "a reference, its joints and its angles: {rows}");
        look_over(&window, &format!("compare at {size:?}"), &mut wrong);
        freeze(&mut window);
        let rect = pane(&window);
        snapshots.part(&mut window, rect, &format!("compare_{}", theme_name(theme)));
        let overlap =
            window.query_all_by_role(Role::ListItem).filter_map(|node| node.accesskit_node().label());
        let of_cameras: Vec<String> = overlap.filter(|label| label.starts_with("cam")).collect();
        assert_eq!(of_cameras.len(), 4, "an overlap a camera: {of_cameras:?}");
        choose(&mut window, Role::ListItem, &of_cameras[2]);
        assert_eq!(window.selection().camera, 2, "a click on an overlap selects the camera");
        choose(&mut window, Role::RadioButton, "Runs");
        command(&mut window, "Run again with each camera left out");
        settle(&mut window);
        close_notices(&mut window);
        choose(&mut window, Role::Button, "Sort by IoU");
        window.get_by_label("Sort by IoU, ascending");
        choose(&mut window, Role::Button, "Sort by IoU, ascending");
        window.get_by_label("Sort by IoU, descending");
        freeze(&mut window);
        let rect = pane(&window);
        snapshots.part(&mut window, rect, &format!("compare_runs_{}", theme_name(theme)));
    }
    assert_readable(&wrong);
}
