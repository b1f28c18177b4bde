//! What a camera's tile shows, and how.

use backlit_ui::drawing::{Comparison, ViewMode};
use backlit_ui::widgets::Framing;

/// What a tile shows and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileView {
    /// What the picture shows.
    pub mode: ViewMode,
    /// What it is compared with.
    pub other: ViewMode,
    /// How the two are compared; `None` shows [`mode`](Self::mode) alone.
    pub comparison: Option<Comparison>,
    /// Where the wipe's handle is: 0 at the left edge of the picture, 1 at the right.
    pub wipe_at: f32,
    /// Which part of the picture.
    pub framing: Framing,
}

impl Default for TileView {
    fn default() -> Self {
        Self {
            mode: ViewMode::Tinted,
            other: ViewMode::Footage,
            comparison: None,
            wipe_at: 0.5,
            framing: Framing::default(),
        }
    }
}

impl TileView {
    /// Whether a mode is seen, alone or in a comparison.
    pub(crate) fn shows(&self, mode: ViewMode) -> bool {
        self.mode == mode || (self.comparison.is_some() && self.other == mode)
    }

    /// Shows a mode. In a comparison the modes trade places rather than be the same.
    pub(crate) fn set_mode(&mut self, mode: ViewMode) {
        if self.comparison.is_some() && mode == self.other {
            self.other = self.mode;
        }
        self.mode = mode;
    }

    /// Compares with a mode, in the way of now or else by a wipe.
    pub(crate) fn compare_with(&mut self, other: ViewMode) {
        if other == self.mode {
            self.mode = self.other;
        }
        self.other = other;
        self.comparison = self.comparison.or(Some(Comparison::Wipe));
        self.keep_apart();
    }

    /// Begins or ends a comparison.
    pub(crate) fn toggle(&mut self, comparison: Comparison) {
        self.comparison = (self.comparison != Some(comparison)).then_some(comparison);
        self.keep_apart();
    }

    /// Two modes that are the same compare nothing.
    fn keep_apart(&mut self) {
        if self.other == self.mode {
            self.other = if self.mode == ViewMode::Footage { ViewMode::Tinted } else { ViewMode::Footage };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_is_of_two_different_modes() {
        let mut tile = TileView { mode: ViewMode::Footage, ..TileView::default() };
        tile.toggle(Comparison::Blink);
        assert_eq!((tile.mode, tile.other), (ViewMode::Footage, ViewMode::Tinted));
        tile.set_mode(ViewMode::Tinted);
        assert_eq!((tile.mode, tile.other), (ViewMode::Tinted, ViewMode::Footage));
        tile.compare_with(ViewMode::Tinted);
        assert_eq!((tile.mode, tile.other), (ViewMode::Footage, ViewMode::Tinted));
        tile.toggle(Comparison::Wipe);
        assert_eq!(tile.comparison, Some(Comparison::Wipe));
        tile.toggle(Comparison::Wipe);
        assert!(tile.comparison.is_none() && !tile.shows(ViewMode::Tinted));
        tile.compare_with(ViewMode::Residual);
        assert!(tile.comparison == Some(Comparison::Wipe) && tile.shows(ViewMode::Residual));
    }
}
