//! `backlit [TAKE]`: the window; where there is no display, what it would have shown.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use backlit_cli::output;
use backlit_formats::images;
use backlit_take::source::TakeSource;
use image::DynamicImage;

use super::command::no_such_command;
use crate::app::window::open_window;
use crate::app::{Opening, PictureOptions, headless_picture};

/// The picture of the window, in the working folder.
const PICTURE: &str = "backlit-window.png";

/// Names the file that the window writes its state to, where no option does.
const STATE_VARIABLE: &str = "BACKLIT_STATE";

/// Opens the window, or tracks the take and writes the window's picture if there is none. The window writes its
/// state to `state_file`.
///
/// # Errors
/// What is not there or cannot be opened, or a picture that cannot be written.
pub(crate) fn run(path: Option<&Path>, state_file: Option<PathBuf>) -> anyhow::Result<()> {
    if let Some(path) = path.filter(|path| !path.exists()) {
        return Err(match no_such_command(path) {
            Some(error) => error.into(),
            None => anyhow!("{}: there is no such file or folder", path.display()),
        });
    }
    let opening = || path.map_or(Opening::Take(TakeSource::BuiltIn), Opening::of);
    let state_file = state_file
        .or_else(|| std::env::var_os(STATE_VARIABLE).filter(|path| !path.is_empty()).map(PathBuf::from));
    let Err(no_window) = open_window(Some(opening()), state_file) else { return Ok(()) };
    output::complain(&format!("No window: {no_window:#}. Going on without one."));
    backlit_cli::print_robust_track(path)?;
    let options = PictureOptions { track: true, ..PictureOptions::default() };
    let (picture, _) = headless_picture(opening(), &options)?;
    let file = PathBuf::from(PICTURE);
    images::write_png(&file, &DynamicImage::ImageRgba8(picture))?;
    output::print(&format!("\nPicture of the window: {}\n", std::path::absolute(&file)?.display()))
}
