//! Every word of the window can be read, in every layout, at the sizes that people have: nothing is cut off, shortened,
//! or painted over.

use backlit::context::preferences::Layout;
use backlit_take::demonstration::Demonstration;
use egui::{Key, Modifiers, Vec2, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::window::{
    Setup, Window, arm, built_in, click, close_notices, command, demonstration, open_menu, press,
};
use crate::support::words::unreadable;

/// Panes that a layout does not have at first, as the palette finds them.
const PANES: [&str; 5] = ["scene", "convergence", "basin", "motions", "ways to begin"];
/// The sections of the panel.
const SECTIONS: [&str; 9] = [
    "Pose",
    "Refit",
    "Size",
    "Measurement",
    "Renderer",
    "Solver",
    "Observability",
    "Camera subsets",
    "Basin",
];
const MENUS: [&str; 6] = ["File", "Edit", "View", "Fit", "Demonstrate", "Help"];

/// The smallest window, the commonest laptop, a large one, and that at one and a half times.
pub(crate) const SIZES: [Vec2; 4] =
    [vec2(1024.0, 640.0), vec2(1366.0, 768.0), vec2(1600.0, 1000.0), vec2(1600.0 / 1.5, 1000.0 / 1.5)];

fn open(setup: Setup, layout: Layout, size: Vec2) -> Window {
    let mut window = setup.layout(layout).sized(size.x, size.y).open();
    close_notices(&mut window);
    window
}

/// What cannot be read in the window as it is, with the place.
pub(crate) fn look(window: &Window, place: &str, wrong: &mut Vec<String>) {
    let rect = window.ctx.content_rect();
    // The panel on the right scrolls, and what is longer than a card in it.
    let scrolls = |clip: egui::Rect| clip.height() > 60.0 && clip.height() < rect.height() - 20.0;
    let found = unreadable(&window.output().shapes, rect, scrolls);
    wrong.extend(found.into_iter().map(|found| format!("{place}: {found}")));
}

/// The same while a menu lies over the window, or the panel is scrolled: both may cover what is beneath or cut what has
/// scrolled away.
pub(crate) fn look_over(window: &Window, place: &str, wrong: &mut Vec<String>) {
    let found = unreadable(&window.output().shapes, window.ctx.content_rect(), |_| true);
    let is_cut = |found: &String| !found.contains("is covered by");
    wrong.extend(found.into_iter().filter(is_cut).map(|found| format!("{place}: {found}")));
}

#[track_caller]
pub(crate) fn assert_readable(wrong: &[String]) {
    assert!(wrong.is_empty(), "{} words cannot be read:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn every_word_can_be_read_in_every_layout_at_every_size() {
    let mut wrong = Vec::new();
    for size in SIZES {
        for layout in Layout::ALL.map(|(layout, _)| layout) {
            let place = format!("{layout:?} at {} × {}", size.x.round(), size.y.round());
            let mut window = open(arm(), layout, size);
            look(&window, &place, &mut wrong);
            press(&mut window, Modifiers::NONE, Key::Enter);
            close_notices(&mut window);
            look(&window, &format!("{place}, fitted"), &mut wrong);
        }
    }
    assert_readable(&wrong);
}

#[test]
fn every_word_of_every_pane_can_be_read() {
    let mut wrong = Vec::new();
    for size in SIZES {
        // Four cameras leave a pane the least room.
        for layout in [Layout::Pose, Layout::Debug] {
            let setup = if layout == Layout::Pose { built_in() } else { arm() };
            let mut window = open(setup, layout, size);
            press(&mut window, Modifiers::NONE, Key::Enter);
            command(&mut window, "Run again with each preset");
            window.state_mut().inspector.state.notices.close_all();
            for pane in PANES {
                let place = format!("{pane} in {layout:?} at {} × {}", size.x.round(), size.y.round());
                let is_open = |window: &Window| {
                    let title = format!("{}{}", pane[..1].to_uppercase(), &pane[1..]);
                    window.query_all_by_label(&title).next().is_some()
                };
                let toggle = (!is_open(&window)).then(|| format!("Show or hide {pane}"));
                toggle.iter().for_each(|toggle| command(&mut window, toggle));
                look(&window, &place, &mut wrong);
                toggle.iter().for_each(|toggle| command(&mut window, toggle));
            }
        }
    }
    assert_readable(&wrong);
}

#[test]
fn every_word_of_every_section_and_menu_can_be_read() {
    let mut wrong = Vec::new();
    for size in SIZES {
        let mut window = open(arm(), Layout::Pose, size);
        let place = |what: &str| format!("{what} at {} × {}", size.x.round(), size.y.round());
        for menu in MENUS {
            open_menu(&mut window, menu);
            look_over(&window, &place(menu), &mut wrong);
            press(&mut window, Modifiers::NONE, Key::Escape);
        }
        // Sections are open one at a time.
        for open_at_first in ["Pose", "Refit"] {
            click(&mut window, open_at_first);
        }
        for section in SECTIONS {
            click(&mut window, section);
            if section == "Solver" {
                click(&mut window, "Edit stages");
            }
            look_over(&window, &place(section), &mut wrong);
            click(&mut window, section);
        }
    }
    assert_readable(&wrong);
}

fn demonstrations_can_be_read(size: Vec2) {
    let mut wrong = Vec::new();
    for which in Demonstration::ALL.into_iter().filter(|which| which.is_available()) {
        let mut window = open(demonstration(which), Layout::Debug, size);
        let place = format!("{which:?} at {} × {}", size.x.round(), size.y.round());
        look(&window, &place, &mut wrong);
        press(&mut window, Modifiers::NONE, Key::Space);
        close_notices(&mut window);
        look(&window, &format!("{place}, a step on"), &mut wrong);
    }
    assert_readable(&wrong);
}

// A test for each size: they run side by side.
#[test]
fn demonstrations_can_be_read_in_the_smallest_window() {
    demonstrations_can_be_read(SIZES[0]);
}

#[test]
fn demonstrations_can_be_read_on_a_laptop() {
    demonstrations_can_be_read(SIZES[1]);
}

#[test]
fn demonstrations_can_be_read_in_a_large_window() {
    demonstrations_can_be_read(SIZES[2]);
}

#[test]
fn demonstrations_can_be_read_at_one_and_a_half_times() {
    demonstrations_can_be_read(SIZES[3]);
}
