//! Opening the inspector's window.

use std::path::PathBuf;

use anyhow::anyhow;
use backlit_ui::style::theme::size;
use egui::ViewportBuilder;

use crate::app::settings_file;
use crate::app::{App, AppOptions, Opening};
use crate::context::clock::Clock;

/// The name that the desktop knows the program by.
const APP_ID: &str = "backlit";

/// Whether there is a display to open a window on.
pub(crate) fn has_display() -> bool {
    if cfg!(any(target_os = "windows", target_os = "macos")) {
        return true;
    }
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    is_set("WAYLAND_DISPLAY") || is_set("DISPLAY")
}

/// Opens the window and returns when it is closed. With `state_file` it writes its state there: see
/// [`AppOptions::state_file`].
///
/// # Errors
/// There is no display, or no window can be opened on it. The caller may go on without one.
pub(crate) fn open_window(opening: Option<Opening>, state_file: Option<PathBuf>) -> anyhow::Result<()> {
    if !has_display() {
        return Err(anyhow!("there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)"));
    }
    let viewport = ViewportBuilder::default()
        .with_app_id(APP_ID)
        .with_title("Backlit")
        .with_inner_size([1600.0, 1000.0])
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
            state_file,
            offers_tour,
            clock: Clock::default(),
            is_inline: false,
        };
        let mut app = App::new(context.egui_ctx.clone(), options)?;
        app.complain(unread);
        Ok(Box::new(app) as Box<dyn eframe::App>)
    };
    eframe::run_native(APP_ID, options, Box::new(create))
        .map_err(|error| anyhow!("no window can be opened: {error}"))
}
