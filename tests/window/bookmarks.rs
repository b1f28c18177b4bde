//! Bookmarks through the real window: added, gone to, changed, removed, undone.

use backlit::app::settings::Settings;
use backlit_ui::style::theme::Theme;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Rect, vec2};
use egui_kittest::kittest::Queryable;

use crate::support::snapshots::{Snapshots, theme_name};
use crate::support::window::{
    Window, WindowState, arm, choose, click, command, freeze, press, type_over, undo,
};

fn texts(window: &Window) -> Vec<(usize, String)> {
    let marks = window.document().bookmarks.iter();
    marks.map(|mark| (mark.frame, mark.text.clone())).collect()
}

#[test]
fn a_frame_is_marked_and_gone_to() {
    let mut snapshots = Snapshots::default();
    for theme in Theme::ALL {
        let settings = Settings { theme, ..Settings::default() };
        let mut window = arm().settings(settings).sized(1200.0, 800.0).open();
        command(&mut window, "bookmarks");
        type_over(&mut window, "New bookmark", "the elbow bends");
        click(&mut window, "Add bookmark");
        press(&mut window, Modifiers::NONE, Key::Escape);
        window.state_mut().inspector.state.go_to_frame(1);
        window.run_steps(2);
        command(&mut window, "bookmarks");
        type_over(&mut window, "New bookmark", "and straightens");
        click(&mut window, "Add bookmark");
        let expected = [(0, "the elbow bends".to_owned()), (1, "and straightens".to_owned())];
        assert_eq!(texts(&window), expected);
        let title = window.get_by_label("Bookmarks").rect();
        let card = Rect::from_min_size(title.min - vec2(16.0, 16.0), vec2(500.0, 300.0));
        freeze(&mut window);
        snapshots.part(&mut window, card, &format!("panel_bookmarks_{}", theme_name(theme)));

        choose(&mut window, Role::Button, "Frame 0");
        assert_eq!(window.selection().frame, 0);
        undo(&mut window);
        assert_eq!(texts(&window), expected[..1]);
    }
}
