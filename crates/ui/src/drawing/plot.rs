//! Plots as pictures, drawn by the window's own painter without a display: what `backlit experiment` writes.
//!
//! | file | holds |
//! |---|---|
//! | [`figure`] | [`Figure`]: a title, axes with their units, and what is drawn between them |
//! | [`heat_map`] | [`HeatMap`]: a grid of coloured cells |
//! | [`sheet`] | [`Sheet`]: pictures in rows and columns |
//! | [`marks`] | where an axis has its marks |
//! | [`png`](mod@png) | figures as PNG files |

use image::RgbaImage;

use crate::style::theme::Theme;

pub mod figure;
pub mod heat_map;
pub mod marks;
pub mod png;
pub mod sheet;

pub use figure::{Axis, Figure, Line};
pub use heat_map::HeatMap;
pub use png::png;
pub use sheet::Sheet;

/// What an experiment shows in a file.
pub trait AsPicture {
    /// The picture. The same contents give the same bytes.
    fn picture(&self, theme: Theme) -> RgbaImage;
}

impl AsPicture for Figure {
    fn picture(&self, theme: Theme) -> RgbaImage {
        self.picture(theme)
    }
}

impl AsPicture for Sheet {
    fn picture(&self, theme: Theme) -> RgbaImage {
        self.picture(theme)
    }
}

/// Curves or pictures, where an experiment has both.
#[derive(Debug)]
pub enum Drawn {
    /// Curves.
    Figure(Figure),
    /// Pictures.
    Sheet(Sheet),
}

impl AsPicture for Drawn {
    fn picture(&self, theme: Theme) -> RgbaImage {
        match self {
            Self::Figure(figure) => figure.picture(theme),
            Self::Sheet(sheet) => sheet.picture(theme),
        }
    }
}
