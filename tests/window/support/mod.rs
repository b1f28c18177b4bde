//! Windows in tests: `egui_kittest` over the CPU painter, so snapshots need no GPU.

pub(crate) mod disturbed_take;
pub(crate) mod snapshots;
pub(crate) mod storage;
pub(crate) mod take;
pub(crate) mod window;
pub(crate) mod words;

use backlit_tracking::processor::use_narrow_vectors;
use backlit_ui::style::theme::{self, Theme};
use egui::Vec2;
use egui_kittest::HarnessBuilder;
use egui_painter::Painter;

/// A window of `size` points in `theme`.
pub(crate) fn harness_builder<State>(size: impl Into<Vec2>, theme: Theme) -> HarnessBuilder<State> {
    // Stored pictures are compared bit by bit, on processors of all kinds.
    use_narrow_vectors();
    HarnessBuilder::default()
        .with_size(size)
        .with_theme(theme::egui_theme(theme))
        .with_context_setup(move |ctx| theme::apply(ctx, theme))
        .renderer(Painter::default())
}
