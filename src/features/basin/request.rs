//! What the basin's panels ask for.

use super::{BasinSettings, BasinView, MapColour};

/// What a result is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A table.
    Csv,
    /// A picture.
    Png,
    /// All numbers and options.
    Json,
}

impl FileKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Png, Self::Json];

    /// The ending of its files.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Png => "png",
            Self::Json => "json",
        }
    }

    /// What is in it, on the menu.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Csv => "Table as CSV…",
            Self::Png => "Picture as PNG…",
            Self::Json => "Numbers as JSON…",
        }
    }
}

/// A wish of the basin's panels.
#[derive(Debug, Clone, PartialEq)]
pub enum BasinRequest {
    /// Other settings.
    Settings(Box<BasinSettings>),
    /// Show the other view.
    View(BasinView),
    /// Colour the map's cells otherwise.
    Colour(MapColour),
    /// Show the map of one choice alone, or of all of them.
    ShowChoice(Option<usize>),
    /// Give the frame the start of a cell of the map.
    TakeStart([usize; 2]),
    /// Write what is shown to a file.
    Export(FileKind),
}
