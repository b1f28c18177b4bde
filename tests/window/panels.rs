//! One small picture a panel, cut from the real window on a tiny take.

use std::path::PathBuf;

use backlit::app::settings::Settings;
use backlit::context::preferences::Layout;
use backlit_ui::style::theme::{Theme, size};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{Window, WindowState, arm, at, choose, click, freeze, press, settle};

/// Wide enough for the unfolded toolbar.
const WIDTH: f32 = 1496.0;
/// Enough for the plot with its list.
const DEBUG_WIDTH: f32 = 1200.0;
/// High enough for three lanes, and for the sections that are shut at first.
const HEIGHT: f32 = 976.0;
/// The harness leaves so much free around the window.
const MARGIN: f32 = 8.0;
/// What the window fills.
const WINDOW: Rect = Rect { min: pos2(MARGIN, MARGIN), max: pos2(WIDTH - MARGIN, HEIGHT - MARGIN) };

fn open(theme: Theme, layout: Layout) -> Window {
    let width = if layout == Layout::Debug { DEBUG_WIDTH } else { WIDTH };
    arm().layout(layout).theme(theme).sized(width, HEIGHT).open()
}

/// Compares a part of the window. Carets do not blink and times are not shown.
fn part(snapshots: &mut Snapshots, harness: &mut Window, rect: Rect, name: &str) {
    harness.set_render_cursor(false);
    harness.ctx.all_styles_mut(|style| style.visuals.text_cursor.blink = false);
    freeze(harness);
    snapshots.part(harness, rect, name);
}

/// A part of the right panel, between the heads of two sections.
fn sections(harness: &Window, from: &str, to: Option<&str>, width: f32) -> Rect {
    let top = |title: &str| harness.get_by_role_and_label(Role::Button, title).rect().top();
    let bottom = to.map_or(WINDOW.bottom() - size::STATUS_BAR, top);
    Rect::from_x_y_ranges(WINDOW.right() - width..=WINDOW.right(), top(from)..=bottom)
}

/// What lies left of the right panel, between two heights over the lower edge of the window.
fn lower_left(from: f32, to: f32, panel: f32) -> Rect {
    let (left, right) = (WINDOW.left(), WINDOW.right() - panel);
    Rect::from_x_y_ranges(left..=right, WINDOW.bottom() - from..=WINDOW.bottom() - to)
}

#[test]
fn toolbar_pose_and_status_bar() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(theme, Layout::Pose);
        let theme = theme_name(theme);
        choose(&mut harness, Role::ListItem, "Right forearm");
        click(&mut harness, "Pin");
        let pose = sections(&harness, "Pose", Some("Size"), size::RIGHT_PANEL);
        part(&mut snapshots, &mut harness, pose, &format!("panel_pose_{theme}"));
        let toolbar = Rect::from_min_size(WINDOW.min, vec2(WINDOW.width(), size::TOOLBAR));
        part(&mut snapshots, &mut harness, toolbar, &format!("panel_toolbar_{theme}"));
        let status = lower_left(size::STATUS_BAR, 0.0, 0.0);
        part(&mut snapshots, &mut harness, status, &format!("panel_status_bar_{theme}"));
    }
}

#[test]
fn sections_that_are_shut_at_first() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(theme, Layout::Pose);
        for title in ["Pose", "Right upper arm", "Size", "Measurement", "Renderer", "Solver"] {
            click(&mut harness, title);
        }
        press(&mut harness, Modifiers::NONE, Key::S);
        let theme = theme_name(theme);
        let rect = sections(&harness, "Refit", Some("Measurement"), size::RIGHT_PANEL);
        part(&mut snapshots, &mut harness, rect, &format!("panel_refit_and_size_{theme}"));
        let rect = sections(&harness, "Measurement", None, size::RIGHT_PANEL);
        part(&mut snapshots, &mut harness, rect, &format!("panel_measurement_to_solver_{theme}"));
    }
}

#[test]
fn convergence_of_a_finished_run() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(theme, Layout::Debug);
        let timeline = harness.get_by_role_and_label(Role::Button, "Track back").rect().top();
        let above = harness.get_by_label("Convergence").rect().top() - 8.0;
        let right = DEBUG_WIDTH - MARGIN - size::RIGHT_PANEL_DEBUG;
        let rect = Rect::from_x_y_ranges(MARGIN..=right, above..=timeline - 6.0);
        if theme == Theme::Dark {
            part(&mut snapshots, &mut harness, rect, "panel_convergence_empty");
        }
        click(&mut harness, "Run");
        click(&mut harness, "Step back");
        press(&mut harness, Modifiers::NONE, Key::Y);
        click(&mut harness, "Run");
        let steps = &harness.runs()[1].steps;
        assert!(
            steps.iter().skip(1).any(|step| !step.iteration.accepted),
            "the run has rejected steps to show"
        );
        part(&mut snapshots, &mut harness, rect, &format!("panel_convergence_{}", theme_name(theme)));
    }
}

#[test]
fn timeline_and_notice_of_a_tracked_take() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let mut harness = open(theme, Layout::Pose);
        let timeline = lower_left(size::TIMELINE + size::STATUS_BAR, size::STATUS_BAR, size::RIGHT_PANEL);
        click(&mut harness, "Track forward");
        let theme = theme_name(theme);
        part(&mut snapshots, &mut harness, timeline, &format!("panel_timeline_{theme}"));
        let from = pos2(timeline.right() - size::NOTICE - 24.0, timeline.top() - 72.0);
        let notice = Rect::from_min_max(from, timeline.right_top());
        part(&mut snapshots, &mut harness, notice, &format!("panel_notice_{theme}"));
    }
}

#[test]
fn empty_state_with_an_error() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let recent = vec![PathBuf::from("takes/balancing"), PathBuf::from("takes/walking")];
        let settings = Settings { theme, recent, ..Settings::default() };
        let mut harness = at("/no/such/take".as_ref()).settings(settings).sized(900.0, 500.0).open();
        let rect = Rect::from_min_max(pos2(200.0, 100.0), pos2(900.0 - MARGIN, 500.0 - MARGIN));
        part(&mut snapshots, &mut harness, rect, &format!("panel_empty_{}", theme_name(theme)));
    }
}

#[test]
fn palette_and_shortcuts() {
    let mut snapshots = Snapshots::default();
    let mut harness = open(Theme::Dark, Layout::Pose);
    // Around the field: it stays where it is, however much is found.
    let card = |harness: &Window| {
        let field = harness.get_by_role(Role::TextInput).rect();
        Rect::from_center_size(field.center() + vec2(0.0, 160.0), vec2(640.0, 460.0))
    };
    press(&mut harness, Modifiers::COMMAND, Key::K);
    let everything = card(&harness);
    harness.get_by_role(Role::TextInput).type_text("step");
    settle(&mut harness);
    assert_eq!(card(&harness), everything);
    part(&mut snapshots, &mut harness, everything, "panel_palette");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    press(&mut harness, Modifiers::NONE, Key::Questionmark);
    let keys = card(&harness).expand2(vec2(80.0, 0.0));
    part(&mut snapshots, &mut harness, keys, "panel_shortcuts");
}
