//! Opening the inspector's window.

use std::path::PathBuf;

use anyhow::anyhow;
use backlit_ui::style::theme::size;
use egui::{Vec2, ViewportBuilder, ViewportCommand, vec2};

use crate::app::{App, AppOptions, Opening, Place, settings_file};
use crate::context::clock::Clock;

/// The name that the desktop knows the program by.
const APP_ID: &str = "backlit";

/// Under this name eframe keeps where the window was, and how large.
const KEPT_PLACE: &str = "window";
/// The size of the first window, where the screen has room for it.
const LARGEST_FIRST: Vec2 = vec2(1600.0, 1000.0);
/// What the desktop's bars and the window's own frame take of the screen: no system says so before the window is there.
const BARS: Vec2 = vec2(24.0, 112.0);

/// Lets the first window of all lie within the screen's work area, its status bar too. Later ones are as they were
/// left. Returns `false` as long as the screen is not known.
pub(crate) fn place_first(ctx: &egui::Context) -> bool {
    let Some(screen) = ctx.input(|input| input.viewport().monitor_size) else { return false };
    let size = first_size(screen);
    if size != LARGEST_FIRST {
        ctx.send_viewport_cmd(ViewportCommand::InnerSize(size));
        let place = (0.5 * (screen - size - BARS)).max(Vec2::ZERO);
        ctx.send_viewport_cmd(ViewportCommand::OuterPosition(place.to_pos2()));
    }
    true
}

/// The size of a window that a screen has room for.
fn first_size(screen: Vec2) -> Vec2 {
    LARGEST_FIRST.min(screen - BARS).max(size::WINDOW_MIN)
}

pub(crate) fn has_display() -> bool {
    if cfg!(any(target_os = "windows", target_os = "macos")) {
        return true;
    }
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    is_set("WAYLAND_DISPLAY") || is_set("DISPLAY")
}

/// Opens the window and returns when it is closed. With `state_file` it writes its state there: see
/// [`AppOptions::state_file`]. Errors: there is no display, or no window can be opened on it. The caller may go on
/// without one.
pub(crate) fn open_window(
    opening: Option<Opening>,
    place: Option<Place>,
    state_file: Option<PathBuf>,
) -> anyhow::Result<()> {
    if !has_display() {
        return Err(anyhow!("there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)"));
    }
    let viewport = ViewportBuilder::default()
        .with_app_id(APP_ID)
        .with_title("Backlit")
        .with_inner_size(LARGEST_FIRST)
        .with_min_inner_size(size::WINDOW_MIN)
        .with_drag_and_drop(true);
    let options = eframe::NativeOptions { viewport, ..eframe::NativeOptions::default() };
    let create = move |context: &eframe::CreationContext<'_>| {
        // Tests from outside begin where everybody else goes on.
        let offers_tour = state_file.is_none();
        let data_folder = eframe::storage_dir(APP_ID);
        let (settings, unread) = data_folder.as_deref().map(settings_file::read).unwrap_or_default();
        let options = AppOptions {
            settings,
            data_folder,
            opening,
            place,
            state_file,
            offers_tour,
            clock: Clock::default(),
            is_inline: false,
            is_first_window: context.storage.is_none_or(|kept| kept.get_string(KEPT_PLACE).is_none()),
        };
        let mut app = App::new(context.egui_ctx.clone(), options)?;
        if let Some(unread) = unread {
            app.inspector.state.notices.error(unread);
        }
        Ok(Box::new(app) as Box<dyn eframe::App>)
    };
    eframe::run_native(APP_ID, options, Box::new(create))
        .map_err(|error| anyhow!("no window can be opened: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_window_leaves_room_for_the_desktops_bars() {
        assert_eq!(first_size(vec2(2560.0, 1440.0)), LARGEST_FIRST);
        assert_eq!(first_size(vec2(1366.0, 768.0)), vec2(1342.0, 656.0));
        assert_eq!(first_size(vec2(1600.0, 1000.0)), vec2(1576.0, 888.0));
        assert_eq!(first_size(vec2(800.0, 600.0)), size::WINDOW_MIN);
    }
}
