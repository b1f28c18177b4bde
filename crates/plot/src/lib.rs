//! Plots as pictures, drawn without a window: what experiments and results write beside their numbers.
//!
//! | file | holds |
//! |---|---|
//! | [`figure`] | [`Figure`]: a title, axes with their units, and curves between them |
//! | [`floor_map`] | [`FloorMap`]: a floor seen from above, with cameras |
//! | [`heat_map`] | [`HeatMap`]: a grid of coloured cells |
//! | [`sheet`] | [`Sheet`]: pictures in rows and columns |
//! | [`marks`] | where an axis has its marks |
//! | [`colours`] | [`Theme`], and the colours of curves and maps, which the window shares |
//! | `page` | lines, dots and text on pixels |

pub mod colours;
pub mod figure;
pub mod floor_map;
pub mod heat_map;
pub mod marks;
mod page;
pub mod sheet;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ImageResult, RgbaImage};

pub use colours::Theme;
pub use figure::{Axis, Figure, Line};
pub use floor_map::{FloorMap, MapCamera};
pub use heat_map::HeatMap;
pub use sheet::Sheet;

/// What an experiment shows in a file.
pub trait AsPicture {
    /// The picture. The same contents give the same bytes.
    fn picture(&self, theme: Theme) -> RgbaImage;
}

/// Curves or pictures, where an experiment has both.
#[derive(Debug)]
pub enum FigureOrSheet {
    /// Curves.
    Figure(Figure),
    /// Pictures.
    Sheet(Sheet),
}

impl AsPicture for FigureOrSheet {
    fn picture(&self, theme: Theme) -> RgbaImage {
        match self {
            Self::Figure(figure) => figure.picture(theme),
            Self::Sheet(sheet) => sheet.picture(theme),
        }
    }
}

/// A flat picture as a small PNG file: without filters and with all the time that compression takes.
///
/// # Errors
/// Returns an error if the picture is larger than a PNG may be.
pub fn png(picture: RgbaImage) -> ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter);
    DynamicImage::ImageRgba8(picture).into_rgb8().write_with_encoder(encoder)?;
    Ok(bytes)
}
