//! Pictures that are compared with stored ones, bit by bit.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use backlit_ui::style::theme::Theme;
use egui::Rect;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::imageops::crop_imm;
use image::{DynamicImage, RgbaImage};

use super::window::Window;

/// Compares pictures with `tests/snapshots/NAME.png`, and fails once, at the end, with all that differ.
///
/// No pixel may differ by any amount: the CPU painter gives the same bits everywhere. What was painted
/// instead is left beside the stored picture as `NAME.new.png`. With `UPDATE_SNAPSHOTS` set, pictures that
/// differ are stored again.
#[derive(Debug, Default)]
pub(crate) struct Snapshots {
    wrong: Vec<String>,
}

impl Snapshots {
    /// Compares a part of a window.
    pub(crate) fn part(&mut self, window: &mut Window, rect: Rect, name: &str) {
        let (min, size) = (rect.min.round(), rect.size().round());
        let picture = window.render().unwrap();
        let part = crop_imm(&picture, min.x as u32, min.y as u32, size.x as u32, size.y as u32);
        self.picture(&part.to_image(), name);
    }

    /// Compares a picture.
    pub(crate) fn picture(&mut self, picture: &RgbaImage, name: &str) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots");
        let (stored_at, new_at) =
            (folder.join(format!("{name}.png")), folder.join(format!("{name}.new.png")));
        let wrong = match image::open(&stored_at) {
            Ok(stored) => difference(&stored.to_rgba8(), picture),
            Err(error) => Some(error.to_string()),
        };
        let updates = std::env::var_os("UPDATE_SNAPSHOTS").is_some();
        match wrong {
            None => drop(std::fs::remove_file(new_at)),
            Some(_) if updates => store(picture, &stored_at),
            Some(wrong) => {
                store(picture, &new_at);
                self.wrong.push(format!("{name}: {wrong}"));
            }
        }
    }
}

/// Writes a picture as small as it can be: the window is opaque.
fn store(picture: &RgbaImage, path: &Path) {
    let file = File::create(path).expect("the folder of snapshots can be written");
    let encoder =
        PngEncoder::new_with_quality(BufWriter::new(file), CompressionType::Best, FilterType::NoFilter);
    let opaque = DynamicImage::ImageRgb8(DynamicImage::ImageRgba8(picture.clone()).to_rgb8());
    opaque.write_with_encoder(encoder).expect("the folder of snapshots can be written");
}

/// How two pictures differ, if they do.
fn difference(stored: &RgbaImage, painted: &RgbaImage) -> Option<String> {
    if stored.dimensions() != painted.dimensions() {
        return Some(format!("{:?} stored, {:?} painted", stored.dimensions(), painted.dimensions()));
    }
    let differing: Vec<(u32, u32)> = stored
        .enumerate_pixels()
        .filter(|(x, y, pixel)| *pixel != painted.get_pixel(*x, *y))
        .map(|(x, y, _)| (x, y))
        .collect();
    let (x, y) = differing.first()?;
    Some(format!("{} pixels differ, the first at {x}, {y}", differing.len()))
}

impl Drop for Snapshots {
    fn drop(&mut self) {
        if !self.wrong.is_empty() && !std::thread::panicking() {
            panic!("UPDATE_SNAPSHOTS=1 stores them again:\n{}", self.wrong.join("\n"));
        }
    }
}

/// A theme in the name of a snapshot.
pub(crate) const fn theme_name(theme: Theme) -> &'static str {
    match theme {
        Theme::Dark => "dark",
        Theme::Light => "light",
    }
}
