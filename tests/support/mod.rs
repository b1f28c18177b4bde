//! Windows in tests: `egui_kittest` over the CPU painter, so snapshots need no GPU.

use backlit::raster::{Canvas, TextureStore};
use backlit::theme::{self, Theme};
use egui::{Context, FullOutput, TexturesDelta, Vec2};
use egui_kittest::{HarnessBuilder, SnapshotOptions, TestRenderer};
use image::RgbaImage;

#[derive(Default)]
struct CpuRenderer {
    textures: TextureStore,
}

impl TestRenderer for CpuRenderer {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        self.textures.update(delta);
    }

    fn render(&mut self, ctx: &Context, output: &FullOutput) -> Result<RgbaImage, String> {
        let primitives = ctx.tessellate(output.shapes.clone(), output.pixels_per_point);
        let size = (ctx.viewport_rect().size() * output.pixels_per_point).round();
        let background = ctx.global_style().visuals.panel_fill;
        let mut canvas = Canvas::new(size.x as u32, size.y as u32, background);
        canvas.paint(output.pixels_per_point, &primitives, &self.textures);
        Ok(canvas.image())
    }
}

/// A window of `size` points in `theme`. Its `snapshot(name)` compares with `tests/snapshots/NAME.png` and
/// allows no pixel to differ, except where the difference looks like antialiasing, which the comparison
/// forgives by itself. `UPDATE_SNAPSHOTS=1` writes pictures that fail anew, `UPDATE_SNAPSHOTS=force` all.
pub(crate) fn harness_builder<State>(size: impl Into<Vec2>, theme: Theme) -> HarnessBuilder<State> {
    let snapshots = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/snapshots");
    HarnessBuilder::default()
        .with_size(size)
        .with_theme(theme.to_egui())
        .with_context_setup(move |ctx| theme::apply(ctx, theme))
        .with_options(SnapshotOptions::new().threshold(0.0).max_failed_pixels(0).output_path(snapshots))
        .renderer(CpuRenderer::default())
}
