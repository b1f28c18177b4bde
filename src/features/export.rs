//! Pictures for other people: what of the window is painted, how large, and the files it goes to. No window here.
//!
//! | file | holds |
//! |---|---|
//! | [`choices`] | [`ExportChoices`]: what the dialog and the command line choose, kept from start to start |
//! | [`series`] | numbered PNGs, an animated PNG or a GIF from one picture after another |

pub mod choices;
pub(crate) mod dialog;
pub(crate) mod exporting;
pub(crate) mod off_screen;
pub mod series;

pub use choices::{ExportChoices, Part, SeriesFormat};
pub use series::{ExportError, SeriesOptions, write_series};

use std::path::PathBuf;

/// What is being exported.
#[derive(Debug, Default)]
pub(crate) struct ExportState {
    pub(crate) exporting: Option<exporting::Exporting>,
    /// Folder of the last export.
    pub(crate) exported_to: Option<PathBuf>,
}
